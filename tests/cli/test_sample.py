"""``moseg sample``: the shapes that come with moseg."""

from __future__ import annotations


def test_sample(moseg, tmp_path):
    mesh, truth = tmp_path / "h.ply", tmp_path / "t.seg"
    assert moseg("sample", "hammer", "-o", mesh, "--labels", truth).code == 0
    faces = len(truth.read_text().split())
    assert 5000 <= faces <= 15000
    assert moseg("sample", "hammer", "-o", tmp_path / "h.stl").code == 2
    wrong = moseg("sample", "hamer", "-o", mesh)
    assert wrong.code == 2
    assert "hammer" in wrong.err
