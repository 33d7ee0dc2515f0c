"""Meshes of a scene: looked through once, counted each time they are placed."""

from __future__ import annotations

from pathlib import Path

import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.read.glb_container import GlbFile
from moseg_core.io.read.glb_meshes import PlacedMeshes
from moseg_core.io.read.limits import LIMITS, ReadLimits
from tests.io.read.glb_files import CORNERS, FACES, glb, pack

BALL = {"POSITION": CORNERS, "indices": FACES.reshape(-1)}


def placed(primitives, limits=LIMITS):
    parsed = GlbFile.parse(Path("a.glb"), pack(*glb([primitives], [{"mesh": 0}])))
    return PlacedMeshes(parsed, limits)


def test_arrays_are_made_once_however_often_a_mesh_is_placed():
    meshes = placed([BALL])
    first, again = meshes.mesh(0), meshes.mesh(0)
    assert first is again
    assert meshes.arrays(first.primitives[0])[0] is meshes.arrays(again.primitives[0])[0]


def test_points_and_lines_are_counted_and_targets_noticed():
    mesh = placed([BALL, {**BALL, "mode": 1}, {**BALL, "targets": []}]).mesh(0)
    assert (len(mesh.primitives), mesh.n_lines, mesh.morphs) == (2, 1, True)


def test_every_placement_counts_also_of_few_triangles(monkeypatch):
    monkeypatch.setattr("moseg_core.io.read.limits.FEW_TRIANGLES", 160)
    meshes = placed([BALL], ReadLimits(triangles_per_byte=1e-9))
    for _ in range(10):
        meshes.mesh(0)
    with pytest.raises(ShapeError, match="become 176 triangles and more"):
        meshes.mesh(0)
