"""Small files of both formats, for the checks: an L of flat cells in a tilted scan."""

from __future__ import annotations

import gzip
import io

import numpy as np
import numpy.typing as npt

AFFINE = np.array(
    [[-0.8, 0.0, 0.9, 12.5], [0.0, 0.8, -1.2, -40.0], [0.3, 0.4, 2.0, 7.25], [0.0, 0.0, 0.0, 1.0]]
)
"""From indices to millimetres: cells of 0.85 x 0.89 x 2.5, x to the left."""


def ell() -> npt.NDArray[np.uint8]:
    """(5, 4, 3) uint8: an L, one of its arms 1 and the other 2."""
    cells = np.zeros((5, 4, 3), np.uint8)
    cells[1:4, 1, 1:] = 1
    cells[3, 2:, 1:] = 2
    return cells


def example(suffix: str) -> bytes | None:
    """A file of a suffix.

    Parameters
    ----------
    suffix : str

    Examples
    --------
    >>> example(".nrrd").splitlines()[0]
    b'NRRD0005'
    """
    if suffix == ".nrrd":
        import nrrd

        stream = io.BytesIO()
        signs = np.array([-1.0, -1.0, 1.0])
        header = {
            "space": "left-posterior-superior",
            "space directions": AFFINE[:3, :3].T * signs,
            "space origin": AFFINE[:3, 3] * signs,
            "kinds": ["domain"] * 3,
            "encoding": "gzip",
        }
        nrrd.write(stream, ell(), header, index_order="F")
        return stream.getvalue()
    import nibabel

    data: bytes = nibabel.Nifti1Image(ell(), AFFINE).to_bytes()
    return gzip.compress(data, mtime=0) if suffix.endswith(".gz") else data
