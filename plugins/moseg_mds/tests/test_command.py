from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
from moseg_mds.embedding import MDS

import moseg_core as moseg
from moseg_core.cli import main


@pytest.fixture
def bent(make, tmp_path):
    """A file with quads, bent to half a ring."""
    vertices, _ = make.rolled(make.strip(21, 3), 4 / np.pi)
    quads = [
        [r * 21 + c, r * 21 + c + 1, (r + 1) * 21 + c + 1, (r + 1) * 21 + c]
        for r in range(2)
        for c in range(20)
    ]
    lines = ["OFF", f"{len(vertices)} {len(quads)} 0"]
    lines += [" ".join(map(repr, v)) for v in vertices.tolist()]
    lines += [" ".join(map(str, [4, *q])) for q in quads]
    path = tmp_path / "bent.off"
    path.write_text("\n".join(lines))
    return path


def run(*arguments) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(a) for a in arguments])
    return ended.value.code


def test_what_is_written_is_the_embedded_shape(bent, tmp_path, capsys):
    out = tmp_path / "flat.ply"
    assert run("embed", bent, "-o", out) == 0
    original, found = moseg.load(bent), moseg.load(out)
    np.testing.assert_array_equal(found.geometry.corners, original.geometry.corners)
    np.testing.assert_array_equal(found.geometry.offsets, original.geometry.offsets)
    expected = MDS()(original).geometry.vertices
    np.testing.assert_array_equal(found.geometry.vertices, expected)
    printed, messages = capsys.readouterr()
    words = dict(line.split() for line in printed.splitlines())
    assert list(words) == ["stress", "geodesics", "landmarks", "seconds"]
    assert words["geodesics"] == "exact"
    assert words["landmarks"] == "63"
    assert float(words["stress"]) < 0.01
    assert f"wrote {out}" in messages


def test_options_and_formats(bent, tmp_path, capsys):
    outs = [tmp_path / f"flat.{suffix}" for suffix in ("glb", "png")]
    options = ["--geodesics", "graph", "--landmarks", 20, "--refine", 50, "--exponent", 1, "--json"]
    assert run("embed", bent, "-o", outs[0], "-o", outs[1], *options) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["geodesics"] == "graph"
    assert found["landmarks"] == 20
    assert found["stress"] == pytest.approx(
        MDS(geodesics="graph", landmarks=20, refine=50, exponent=1.0).embed(moseg.load(bent)).stress
    )
    assert outs[0].read_bytes()[:4] == b"glTF"
    assert outs[1].read_bytes()[1:4] == b"PNG"


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["-o", "x.stl"], 2, "written as .ply, .glb, .png, not '.stl'"),
        (["-o", "nowhere/x.ply"], 2, "no folder"),
        ([], 2, "out"),
        (["-o", "x.ply", "--landmarks", "2"], 2, "landmarks is 2"),
        (["-o", "x.ply", "--geodesics", "euclid"], 2, "euclid"),
    ],
)
def test_mistakes(bent, tmp_path, monkeypatch, capsys, arguments, code, message):
    monkeypatch.chdir(tmp_path)
    assert run("embed", bent, *arguments) == code
    assert message in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["bent.off"]


def test_several_pieces_end_with_3(make, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    ball = trimesh.Trimesh(*make.ball(1))
    trimesh.util.concatenate([ball, ball.copy().apply_translation([5, 0, 0])]).export("two.ply")
    assert run("embed", "two.ply", "-o", "x.ply") == 3
    assert "2 pieces" in capsys.readouterr().err


def test_help(capsys):
    assert run("embed", "--help") == 0
    assert "landmarks" in capsys.readouterr().out
