from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
from moseg_symmetry.planes import read_plane

from moseg_core.cli import main


@pytest.fixture
def run(capsys, tmp_path):
    """The output of ``moseg symmetry`` on a mesh, as lines or as a document."""

    def called(mesh, *options):
        path = tmp_path / "thing.ply"
        mesh.export(path)
        with pytest.raises(SystemExit) as end:
            main(["symmetry", str(path), *options])
        printed = capsys.readouterr()
        assert end.value.code == 0
        assert printed.err == ""
        return printed.out

    return called


def test_table(run):
    lines = run(trimesh.creation.box(extents=(4, 2, 1))).splitlines()
    assert lines[0] == "thing: 12 faces, size 4.58258"
    assert lines[2].split() == ["plane", "(for", "--plane)", "residual", "share"]
    assert len(lines) == 2 + 4 + 1 + 4
    plane, *rest = lines[3].split()
    assert rest == ["0.000", "%", "100.0", "%", "auto"]
    np.testing.assert_allclose(read_plane(plane, center=np.zeros(3)).normal, [1, 0, 0], atol=1e-6)
    assert all(line.endswith("100.0 %") for line in lines[4:6])
    assert all(line.endswith("2 times in a full turn") for line in lines[8:])


def test_document(run, make):
    found = json.loads(run(make.moved(make.prism(6)), "--json"))
    assert found["shape"] == "thing"
    assert found["size"] == pytest.approx(2 * np.hypot(1, 1.5), rel=1e-6)
    assert len(found["planes"]) == 7
    for plane in found["planes"]:
        assert plane["holds"]
        again = read_plane(plane["plane"], center=np.zeros(3))
        np.testing.assert_allclose(again.normal, plane["normal"], atol=1e-8)
        np.testing.assert_allclose(again.point, plane["point"], atol=1e-7)
    assert [axis["fold"] for axis in found["axes"]] == [6] + [2] * 6


def test_round_things(run, make):
    can = run(make.prism(64))
    assert "after any turn" in can
    assert "ball" not in can
    assert "it is a ball" in run(make.ellipsoid(1, 1, 1))
    axes = json.loads(run(make.prism(64), "--json"))["axes"]
    assert axes[0]["fold"] is None


@pytest.mark.slow
def test_nothing_found(run, make):
    out = run(make.blob())
    assert "no plane of symmetry; the best one maps" in out
    assert "no axis of symmetry" in out
    assert "auto" not in out
    found = json.loads(run(make.blob(), "--json"))
    assert [plane["holds"] for plane in found["planes"]] == [False]
    assert found["axes"] == []


def test_missing_file(capsys, tmp_path):
    with pytest.raises(SystemExit) as end:
        main(["symmetry", str(tmp_path / "none.ply")])
    assert end.value.code in (2, 3)
    assert "none.ply" in capsys.readouterr().err
