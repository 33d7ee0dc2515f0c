"""The bundle ``medical``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import ReaderSpec, WriterSpec, hookimpl

_PACKAGE = "moseg_medical"
_NIFTI, _NRRD = (".nii", ".nii.gz"), (".nrrd",)

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_readers() -> list[ReaderSpec]:
    """Masks and label maps as solid voxel grids."""
    return [
        ReaderSpec(
            name="nifti",
            target=f"{_PACKAGE}.nifti:read_nifti",
            labels=f"{_PACKAGE}.nifti:nifti_labels",
            suffixes=_NIFTI,
            example=f"{_PACKAGE}.examples:example",
            summary="masks in NIfTI, in millimetres as the scanner placed them",
        ),
        ReaderSpec(
            name="nrrd",
            target=f"{_PACKAGE}.nrrd_files:read_nrrd",
            labels=f"{_PACKAGE}.nrrd_files:nrrd_labels",
            suffixes=_NRRD,
            example=f"{_PACKAGE}.examples:example",
            summary="masks in NRRD, in millimetres as the scanner placed them",
        ),
    ]


@hookimpl
def moseg_writers() -> list[WriterSpec]:
    """Label maps of the grid that was read."""
    return [
        WriterSpec(
            name="nifti",
            target=f"{_PACKAGE}.nifti:write_nifti",
            suffixes=_NIFTI,
            summary="a label map, and label descriptions for ITK-SNAP beside it",
        ),
        WriterSpec(
            name="nrrd",
            target=f"{_PACKAGE}.nrrd_files:write_nrrd",
            suffixes=_NRRD,
            summary="a label map with names and colours for 3D Slicer",
        ),
    ]
