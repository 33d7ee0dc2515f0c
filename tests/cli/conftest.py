"""A small mesh on disk and a way to run the command line in this process."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from moseg_core.cli import main


class Outcome:
    """What a run of the command line left behind."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err


@pytest.fixture
def moseg(capsys):
    """Run ``moseg`` with the given words; exit code, stdout and stderr."""

    def run(*words: object) -> Outcome:
        with pytest.raises(SystemExit) as ended:
            main([str(word) for word in words])
        captured = capsys.readouterr()
        return Outcome(ended.value.code, captured.out, captured.err)

    return run


def write_off(path: Path, mesh: trimesh.Trimesh) -> Path:
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"]
    lines += [" ".join(repr(float(x)) for x in v) for v in mesh.vertices]
    lines += ["3 " + " ".join(str(i) for i in f) for f in mesh.faces]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def mallet(tmp_path):
    """A closed T of two boxes, finely meshed: a handle along x and a head across its end."""
    handle = trimesh.creation.box(extents=(4.0, 0.5, 0.5))
    head = trimesh.creation.box(extents=(0.8, 0.8, 2.0))
    head.apply_translation((2.2, 0.0, 0.0))
    solid = trimesh.boolean.union([handle, head], engine="manifold")
    solid = solid.subdivide_to_size(0.25)
    assert solid.is_watertight
    return write_off(tmp_path / "mallet.off", solid)


@pytest.fixture
def open_box(tmp_path):
    """A box without its lid."""
    box = trimesh.creation.box().subdivide().subdivide()
    lid = np.flatnonzero(box.triangles_center[:, 2] > 0.49)
    box.update_faces(~np.isin(np.arange(len(box.faces)), lid))
    return write_off(tmp_path / "open.off", box)


@pytest.fixture
def segmented(moseg, mallet, tmp_path):
    result = tmp_path / "m.json"
    assert moseg("segment", mallet, "--recipe", "paper_hammer", "-o", result).code == 0
    return result
