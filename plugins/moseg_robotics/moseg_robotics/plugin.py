"""The bundle ``robotics``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import WriterSpec, hookimpl

_PACKAGE = "moseg_robotics"

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_writers() -> list[WriterSpec]:
    """What robot simulators read."""
    return [
        WriterSpec(
            name="urdf",
            target=f"{_PACKAGE}.urdf:write_urdf",
            suffixes=(".urdf",),
            summary="a link with mesh and convex hull for each part; meshes beside it",
        ),
        WriterSpec(
            name="mjcf",
            target=f"{_PACKAGE}.mjcf:write_mjcf",
            suffixes=(".mjcf",),
            summary="a MuJoCo body with mesh and convex hull for each part; meshes beside it",
        ),
    ]
