"""Shape files that are damaged, extreme or meant to do harm: read, or refused in one line, in time.

All files are read by one child with limits on time and memory, several times what it takes; that
of single files is not measured, since it would depend on the machine.
"""

from __future__ import annotations

import importlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core.cli import main
from tests import shapes
from tests.io.read.glb_files import glb, pack

DATA = Path(__file__).parent / "data"
SECONDS, BYTES = 120, 4 << 30

READ_ALL = """
import json, resource, sys, warnings
resource.setrlimit(resource.RLIMIT_CPU, ({seconds}, {seconds}))
resource.setrlimit(resource.RLIMIT_AS, ({bytes}, {bytes}))
warnings.simplefilter("error")
import moseg_core as moseg
found = {{}}
for name in json.load(sys.stdin):
    try:
        shape = moseg.load(name)
        found[name] = ["", shape.n_elements, *shape.notes]
    except Exception as error:
        found[name] = [type(error).__name__, str(error)]
print(json.dumps(found))
"""


def off(points, faces) -> bytes:
    rows = [*(" ".join(map(repr, map(float, p))) for p in points)]
    rows += [f"{len(face)} {' '.join(map(str, face))}" for face in faces]
    return "\n".join([f"OFF\n{len(points)} {len(faces)} 0", *rows, ""]).encode()


def binvox(size: int, runs: bytes, *, translate: str = "0 0 0", scale: str = "1") -> bytes:
    head = f"#binvox 1\ndim {size} {size} {size}\ntranslate {translate}\nscale {scale}\ndata\n"
    return head.encode() + runs


def npy(header: str) -> bytes:
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode()


def scene(**changes) -> bytes:
    """One ball, with other primitives, nodes or scenes."""
    vertices, faces = shapes.sphere(1)
    ball = {"POSITION": np.asarray(vertices, "<f4"), "indices": np.ravel(faces).astype("<u2")}
    document, binary = glb([[ball]], [{"mesh": 0}])
    if "primitives" in changes:
        document["meshes"][0]["primitives"] *= changes.pop("primitives")
    document |= changes
    if "scenes" not in changes:
        document["scenes"] = [{"nodes": list(range(len(document["nodes"])))}]
    return pack({key: value for key, value in document.items() if value is not None}, binary)


def ply(n_properties: int, rows: list[str], blank: str = " ") -> bytes:
    names = ["x", "y", "z", *(f"p{k}" for k in range(n_properties))]
    lines = [f"property{blank}float {name}" for name in names]
    head = ["ply", "format ascii 1.0", f"element vertex {len(rows)}", *lines, "end_header"]
    return "\n".join([*head, *rows]).encode()


def spiral(count: int):
    t = np.linspace(0, 200 * np.pi, count // 2)
    inner, outer = ([r * np.cos(t), r * np.sin(t), 0 * t] for r in (t, t + 1.5))
    return np.concatenate([np.transpose(inner), np.transpose(outer)[::-1]])


def as_npy(array) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


RNG = np.random.default_rng(0)
TRIO = (1, 2, 3)
PLACES = "0 0 0\n1 0 0\n0 1 0\n0 0 1"
FAR = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1e12, 0, 0], [1e12 + 1, 0, 0], [1e12, 1, 0]]
GRID = "{{'descr': '|b1', 'fortran_order': False, 'shape': {}, }}"
MADE = {
    "points_in_one_place.xyz": lambda: b"1 2 3\n" * 300_000,
    "points_nearly_so.xyz": lambda: b"1 2 3\n" * 300_000 + PLACES.encode() + b"\n",
    "points_in_27_places.npy": lambda: as_npy(RNG.integers(0, 3, (300_000, 3)).astype(float)),
    "polygon_random5000.off": lambda: off(RNG.normal(size=(5000, 3)), [range(5000)]),
    "polygon_repeated15000.off": lambda: off(np.eye(3), [[k % 3 for k in range(15_000)]]),
    "polygon_spiral30000.off": lambda: off(spiral(30_000), [range(30_000)]),
    "properties20000.ply": lambda: ply(20_000, [f"{k} 0 {k * k}" + 20_000 * " 0" for k in TRIO]),
    "mesh_at_20000_nodes.glb": lambda: scene(nodes=[{"mesh": 0}] * 20_000),
    "primitive_20000_times.glb": lambda: scene(primitives=20_000),
    "roots40000.glb": lambda: scene(
        nodes=[{"mesh": 0}, *({"children": [40_000 + k]} for k in range(40_000)), *[{}] * 40_000],
        scenes=None,
    ),
    "grid_1290_empty.binvox": lambda: binvox(1290, b"\0\xff" * 8_418_388),
    "grid_200_full.npy": lambda: as_npy(np.ones((200, 200, 200), bool)),
    "face_300000_times.off": lambda: off(np.eye(3), [(0, 1, 2)] * 300_000),
    "axes65.npy": lambda: npy(GRID.format("(" + "1, " * 65 + ")")) + b"\1",
    "minus4000.npy": lambda: npy(GRID.format("(" + "-" * 4000 + "3,)")) + b"\1",
    "cells_of_1e299.binvox": lambda: binvox(4, b"\1\x40", scale="1e299"),
    "cells_that_coincide.binvox": lambda: binvox(4, b"\1\x40", translate="1e20 0 0"),
    "no_break_spaces.ply": lambda: ply(0, PLACES.splitlines(), blank="\u00a0"),
    "cut_off.ply": lambda: ply(0, PLACES.splitlines()) + b".1",
    "cut_off.xyz": lambda: PLACES.encode() + b".1",
    "column_x_twice.csv": lambda: b"x,y,z,x\n0,0,0,1\n1,0,0,1\n0,1,0,2\n0,1,1,2\n",
    "areas_beyond.csv": lambda: b"x,y,z,area\n0,0,0,1e308\n1,0,0,1e308\n0,1,0,1e308\n",
    "far_apart.off": lambda: off(FAR, [(0, 1, 2), (3, 4, 5)]),
    "far_apart.xyz": lambda: "\n".join(" ".join(map(repr, map(float, p))) for p in FAR).encode(),
    "columns100000.npy": lambda: as_npy(np.ones((4, 100_000))),
}  # fmt: skip


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> dict[str, list]:
    """What reading each file gave: the kind of error and its text, or "", a size and notes."""
    folder = tmp_path_factory.mktemp("hostile")
    paths = [path for path in sorted(DATA.iterdir()) if path.suffix[1:] in _SUFFIXES]
    paths.remove(DATA / "4_faces.off")  # sound: what the labels of test_trust.py are of
    for name, make in MADE.items():
        (folder / name).write_bytes(make())
        paths.append(folder / name)
    done = subprocess.run(
        [sys.executable, "-c", READ_ALL.format(seconds=SECONDS, bytes=BYTES)],
        input=json.dumps([str(path) for path in paths]),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return {Path(name).name: told for name, told in json.loads(done.stdout).items()}


_SUFFIXES = ["off", "ply", "glb", "npy", "binvox", "csv", "xyz"]

REFUSED = {
    # The table of files.
    "glb_instances500.glb": "become 10,080 triangles and more; the limit is triangles_per_byte=0.5",
    "binvox_full180.binvox": "5,832,000 occupied cells in 45797 bytes; the limit is cells_per_byte",
    "binvox_scale_1e300.binvox": "are beyond what can be measured; repair or rescale the grid",
    "binvox_translate_1e308.binvox": "are beyond what can be measured; repair or rescale the grid",
    "binvox_dim_6.9.binvox": "a grid of 6.9 x 6 x 6, which are no numbers of cells",
    "glb_count_bigstride2.glb": "bytes apart; export it again",
    "glb_escape.glb": "needs the extension '\\x1b]0;owned\\x07\\nsecond line'; export it without",
    "npy_shape_2_64.npy": "its shape is (18446744073709551616, 0, 1)",
    "npy_shape_bool.npy": "its header tells no shape of whole numbers",
    "npy_header_minus.npy": "is not an .npy file",
    "csv_hugearea.csv": "the area of point 0 is 1e+308, beyond what can be measured",
    "off_one_vertex_1e20.off": "vertex 3, at [0.5257311121191336, 1e+20, 0.0], is 1e+20 away",
    # Those of the same kinds.
    "points_in_one_place.xyz": "all points are in one place",
    "polygon_repeated15000.off": "has 15000 corners, but names no more than 3 vertices",
    "mesh_at_20000_nodes.glb": "--limit triangles_per_byte=... raises it",
    "primitive_20000_times.glb": "--limit triangles_per_byte=... raises it",
    "grid_1290_empty.binvox": "a grid of 2,146,689,000 cells; the limit is grid_cells=268435456",
    "axes65.npy": "its shape has 65 axes",
    "minus4000.npy": "its header tells no shape of whole numbers",
    "cells_of_1e299.binvox": "are beyond what can be measured",
    "cells_that_coincide.binvox": "cells with sides of 0.25 cannot be told apart at [1e+20",
    "no_break_spaces.ply": "line 4: 'property\\xa0float x' is not understood in a PLY header",
    "column_x_twice.csv": "names several columns 'x': 1, 4; leave one of them",
    "areas_beyond.csv": "the area of point 0 is 1e+308",
    "columns100000.npy": "rows of 100,000 cells, too many for points; the limit is columns=1000",
}  # fmt: skip

ACCEPTED = {
    "edge_bomb_same_face4000.off": (4000, "3999 duplicate faces"),
    "ngon_random2000.off": (1, ""),
    "utm_coordinates.off": (600, ""),
    "points_nearly_so.xyz": (300_004, "300000 points have no area"),
    "points_in_27_places.npy": (300_000, ""),
    "polygon_random5000.off": (1, ""),
    "polygon_spiral30000.off": (1, ""),
    "properties20000.ply": (3, ""),
    "roots40000.glb": (80, ""),
    "grid_200_full.npy": (8_000_000, ""),
    "face_300000_times.off": (300_000, "299999 duplicate faces"),
    "cut_off.ply": (4, "the last line has no end"),
    "cut_off.xyz": (4, "the last line has no end"),
    "far_apart.off": (2, "2 connected components"),
    "far_apart.xyz": (6, ""),
}


@pytest.mark.parametrize(("name", "words"), REFUSED.items())
def test_files_that_are_refused_with_a_reason_of_one_line(found, name, words):
    kind, message = found[name]
    assert kind == "ShapeError"
    assert words in message
    assert "\n" not in message
    assert len(message) < 400


@pytest.mark.parametrize(("name", "told"), ACCEPTED.items())
def test_files_that_are_read_however_odd_they_are(found, name, told):
    size, words = told
    kind, n_elements, *notes = found[name]
    assert kind == "", n_elements
    assert n_elements == size
    assert words in " ".join(notes)


def test_every_file_has_an_answer(found):
    assert set(found) - {"4_faces.off"} == set(REFUSED) | set(ACCEPTED)  # a sound one, of others


def test_a_shape_far_from_the_origin_comes_back_from_a_glb_file(tmp_path):
    shape = moseg.load(DATA / "utm_coordinates.off")
    problem = moseg.Problem(labels=["a", "b"], minimize="narrow(a)")
    result = moseg.segment(shape, problem, restarts=1, resolution=100)
    moseg.save(result, tmp_path / "r.glb")
    back = moseg.load(tmp_path / "r.glb")
    assert back.n_elements == shape.n_elements
    assert back.area == pytest.approx(shape.area, rel=1e-5)
    assert not any("no area" in note for note in back.notes)


def test_limits_are_raised_and_lifted(tmp_path):
    file = tmp_path / "instances.glb"
    file.write_bytes(scene(nodes=[{"mesh": 0, "name": "ball"}] * 200))
    with pytest.raises(moseg.ShapeError, match="triangles_per_byte"):
        moseg.load(file)
    raised = moseg.ReadLimits(triangles_per_byte=10)
    shape = moseg.load(file, limits=raised)
    assert shape.n_elements == 16_000
    with pytest.raises(moseg.ShapeError, match="triangles_per_byte"):
        moseg.read_labels(file, shape)
    assert moseg.read_labels(file, shape, limits=raised).names == ("ball",)


@pytest.mark.parametrize("command", ["evaluate", "explain", "measure", "render", "view"])
def test_labels_obey_the_limit_of_the_command_line(tmp_path, monkeypatch, capsys, command):
    file, labels = tmp_path / "instances.glb", tmp_path / "labels.glb"
    nodes = [{"mesh": 0, "name": "ab"[k % 2]} for k in range(200)]
    for path in (file, labels):
        path.write_bytes(scene(nodes=nodes))
    asked = {
        "evaluate": [str(file), str(labels), str(labels)],
        "explain": [str(file), "--parts", str(labels), "--labels=a,b", "--minimize=flat(a)"],
        "measure": [f"{file}={labels}"],
        "render": [str(file), str(labels), "-o", str(tmp_path / "x.png")],
        "view": [str(file), str(labels), "-o", str(tmp_path / "x.html")],
    }[command]
    given = []

    def read(path, shape, **options):
        given.append(options["limits"])
        raise moseg.ShapeError("seen")

    module = importlib.import_module(f"moseg_core.cli.{command}")
    monkeypatch.setattr(module, "read_labels", read)
    with pytest.raises(SystemExit) as ended:
        main([command, *asked])
    assert (ended.value.code, given) == (3, [])  # the shape itself is beyond the limit
    capsys.readouterr()
    with pytest.raises(SystemExit):
        main([command, *asked, "--limit", "triangles_per_byte=10"])
    assert given == [moseg.ReadLimits(triangles_per_byte=10)]
    assert "seen" in capsys.readouterr().err


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.off")
    with pytest.raises(moseg.ShapeError, match="it is a pipe, not a file"):
        moseg.load(tmp_path / "a.off")
