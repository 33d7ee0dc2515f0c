from __future__ import annotations

import json
import os
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import ReaderSpec
from moseg_core.errors import PluginError, ShapeError, UsageError
from moseg_core.io.labels import Labelling, encode_named_labels, encode_seg, read_labels, reading
from moseg_core.io.read.limits import ReadLimits
from moseg_core.shape.shape import Shape
from tests import shapes

NAMED = "body\n1 3 4 \nupper arm\n5 2 \n"

PLY = """ply
format ascii 1.0
comment moseg label 0 body
comment moseg label 1 upper arm
element vertex 0
property float x
element face 3
property list uchar int vertex_indices
property uchar label
end_header
3 0 1 2 1
3 0 1 2 0
3 0 1 2 1
"""


def result(labels: object, names: object = None) -> str:
    return json.dumps({"labels": labels, "problem": {"labels": names}, "cost": 0.5})


@pytest.mark.parametrize("names", [None, ["body", "arm", "leg"]])
def test_a_result_of_moseg(names, as_file):
    found = read_labels(as_file("x.JSON", result([0, 2, 0], names)), 3)
    assert found.labels.tolist() == [0, 2, 0]
    assert found.names == (None if names is None else tuple(names))


def test_a_result_without_a_problem_has_no_names(as_file):
    assert read_labels(as_file("x.json", '{"labels": [0, 1]}'), 2).names is None


def test_a_labelled_mesh(as_file):
    found = read_labels(as_file("x.ply", PLY), 3)
    assert found.labels.tolist() == [1, 0, 1]
    assert found.names == ("body", "upper arm")
    bare = PLY.replace("moseg label", "label")
    assert read_labels(as_file("x.ply", bare), 3).names is None


@pytest.mark.parametrize(
    ("name", "contents", "message"),
    [
        ("x.seg", "0\n" * 10, " has 10 labels but the shape has 12 elements; give the labels of"),
        ("x.json", result([0] * 10), " has 10 labels but the shape has 12 elements"),
        ("x.ply", PLY, " has 3 labels but the shape has 12 elements"),
        ("x.seg", "", " is empty"),
        ("x.seg", "\ufeff\n", " has 0 labels but the shape has 12 elements"),
        ("x.seg", "0\n\n1\n-2\n", ", line 4: the label -2 is negative; labels count from 0, and"),
        ("x.seg", "0\n1 2\n", ", line 2: expected one label, found 2 words"),
        ("x.seg", "0\n1.5\n", ", line 2: the label 1.5 is not a whole number"),
        ("x.seg", "0\ninf\n", ", line 2: the label inf is not a whole number"),
        ("x.seg", "0\n1\nleg\n", ", line 3: 'leg' is not an integer, which the labels before"),
        ("x.seg", "0\n99999999999999999999\n", ", line 2: '99999999999999999999' is too large"),
        ("x.seg", "-1\n" * 12, " gives a label to none of the 12 elements"),
        ("x.txt", "", " is empty"),
        ("x.txt", "body\n\n", " gives a label to none of the 12 elements"),
        ("x.txt", "a b\n1 2\n2 1\n", " has 2 columns: a, b; say which holds the labels, by"),
        ("x.txt", "a\n1 2 3\nb\n4 2 5\n", ", line 4: face 2 stands on line 2 already; remove one"),
        ("x.txt", "a\n1 2 3 2\n", ", line 2: face 2 stands twice on this line; remove one"),
        ("x.txt", "a\n1 2\nb\n3 13\n", ", line 4: face 13 is none of the shape's faces, 1 to 12"),
        ("x.txt", "a\n0 1\n", ", line 2: face 0 is none of the shape's faces, 1 to 12"),
        ("x.txt", "a\n1 2x\n", ", line 2: '2x' is not an integer"),
        ("x.txt", "a\n1 2\n3 4\n", ", line 3: expected the name of a label, found '3 4'"),
        ("x.txt", "a\nb\n1 2\n", ", line 2: 'b' is not an integer"),
        ("x.txt", "a\n1 2\nb\n", " ends behind the name 'b', without its faces; it is cut off"),
        ("x.txt", b"a\xff\n1 2\n", ", line 1: 'a\ufffd' is not UTF-8"),
        ("x.json", "{", " is not JSON ("),
        ("x.json", b'{"labels": "\xff"}', " is not JSON ("),
        ("x.json", "[" * 100_000, " is not JSON ("),
        ("x.json", "[]", " has 0 labels but the shape has 12 elements"),
        ("x.json", "3", " has int where labels are looked for; allowed are a list with a label"),
        ("x.json", result([0, 0.5]), " gives element 1 the label 0.5; labels are whole numbers"),
        ("x.json", result([2**70] * 12), " has labels that are too large"),
        ("x.json", result([0] * 11 + [-2]), " gives element 11 the label -2; labels count"),
        ("x.json", result([0] * 12, "body"), " has a member problem.labels that is not a list"),
        ("x.json", result([0] * 12, [1, 2]), " has a member problem.labels that is not a list"),
        ("x.json", result([0] * 9 + [1] * 3, ["a"]), " gives element 9 the label 1, but names"),
        ("x.ply", "ply\n", " has no 'end_header'"),
        ("x.ply", PLY.replace("uchar label", "uchar red"), " has no property 'label'; give a file"),
        ("x.ply", PLY.replace("uchar label", "uchar q"), " has no property 'label', or another"),
        ("x.ply", PLY.replace("label 0", "label 3"), " names 2 labels, but not label 0; name them"),
        ("x.ply", PLY.replace("2 1\n3", "2 7\n3").replace("face 3", "face 3"), " has 3 labels but"),
    ],
)  # fmt: skip
def test_malformed_labels_are_refused_with_the_reason(name, contents, message, refusal):
    assert message in refusal(lambda path: read_labels(path, 12), name, contents)


def test_labels_of_a_mesh_need_a_name_each(refusal):
    contents = PLY.replace("3 0 1 2 0", "3 0 1 2 2")
    message = refusal(lambda path: read_labels(path, 3), "x.ply", contents)
    assert message.startswith(" gives element 1 the label 2, but names only 2 labels")


@pytest.mark.parametrize("name", ["labels.xlsx", "labels", "labels.seg.gz"])
def test_other_suffixes_are_refused_with_those_allowed(name, as_file):
    with pytest.raises(
        UsageError, match=r"allowed: \.seg, \.txt, .*, \.json, \.npy, .*, \.glb, \.gltf\b"
    ):
        read_labels(as_file(name, "0\n"), 1)


@pytest.mark.parametrize("name", ["x.eseg", "x.seseg"])
def test_labels_of_edges_are_refused_as_such(name, as_file):
    with pytest.raises(UsageError, match="has labels of edges, as MeshCNN writes them, and moseg"):
        read_labels(as_file(name, "0\n"), 1)


def test_labels_that_are_cut_off_are_never_read_in_part(accepted_cuts):
    def read(path: Path) -> list[int]:
        return read_labels(path, 5).labels.tolist()

    whole = [0, 1, 0, 0, 1]
    for name, contents in [
        ("x.seg", encode_seg(whole)),
        ("x.json", result(whole, ["body", "arm"]).encode()),
    ]:
        for stop, labels in accepted_cuts(read, name, contents).items():
            assert labels == whole
            assert contents[stop:].strip() == b""


def test_named_lines_that_are_cut_off_leave_faces_without_a_label(accepted_cuts):
    """What is missing behind the end of a line cannot be told from what was never labelled."""

    def read(path: Path) -> Labelling:
        return read_labels(path, 5)

    whole = [0, 1, 0, 0, 1]
    read_cuts = accepted_cuts(read, "x.txt", NAMED.encode())
    assert len(read_cuts) > 3
    for labelling in read_cuts.values():
        cut = labelling.labels
        assert cut[cut >= 0].tolist() == np.array(whole)[cut >= 0].tolist()
        assert any("left out" in note for note in labelling.notes) == (cut < 0).any()


def test_how_many_have_no_label_is_said_in_the_words_of_the_shape(as_file):
    one = read_labels(as_file("x.seg", "0\n-1\n1\n"), 3)
    assert one.labels.tolist() == [0, -1, 1]
    assert one.notes == ("x.seg: 1 of 3 elements is unlabelled and left out",)
    tiles = Shape.from_mesh(*shapes.strip(4))
    two = read_labels(as_file("x.csv", "nan\n-1.0\n1\n0\n"), tiles)
    assert two.labels.tolist() == [-1, -1, 1, 0]
    assert two.notes == ("x.csv: 2 of 4 faces are unlabelled and left out",)


def test_a_whole_labelling_can_be_asked_for(as_file):
    tiles = Shape.from_mesh(*shapes.strip(4))
    found = read_labels(as_file("x.seg", "3\n-1\n-1\n1\n"), tiles, fill=True)
    assert found.labels.tolist() == [3, 3, 1, 1]
    assert found.notes == (
        "x.seg: 2 of 4 faces are unlabelled and counted as the nearest labelled",
    )


def test_a_number_of_elements_has_no_nearest(as_file):
    with pytest.raises(UsageError, match=r"x\.seg: fill=True .* give the shape"):
        read_labels(as_file("x.seg", "3\n1\n"), 2, fill=True)


@pytest.mark.skipif("MOSEG_PSB" not in os.environ, reason="MOSEG_PSB names no benchmark folder")
def test_benchmark_labels_come_back_as_they_were_written(as_file):
    folder = Path(os.environ["MOSEG_PSB"])
    for path in sorted(folder.joinpath("labels").glob("*.txt"))[::10]:
        number = path.name.removesuffix("_labels.txt")
        off = folder.joinpath("off", f"{number}.off").read_text().split(maxsplit=3)
        found = read_labels(path, int(off[2]))
        again = read_labels(
            as_file("a.txt", encode_named_labels(found.labels, found.names)), int(off[2])
        )
        assert again.names == found.names
        np.testing.assert_array_equal(again.labels, found.labels)
        for seg in sorted(folder.joinpath("seg", number).glob("*.seg"))[:2]:
            assert (
                encode_seg(read_labels(seg, int(off[2])).labels).split() == seg.read_bytes().split()
            )


@pytest.fixture
def acme(monkeypatch):
    """A bundle's reader of ``.sheet`` files, whose labels a function tells."""

    def make(told):
        made = types.ModuleType("labels_of_acme")
        made.told = told
        monkeypatch.setitem(sys.modules, "labels_of_acme", made)
        spec = ReaderSpec(
            name="sheet",
            target="labels_of_acme:read",
            suffixes=(".sheet", ".sheet.gz"),
            labels="labels_of_acme:told",
        )
        bundle = Bundle("acme", "acme", "1", "", (Component("acme", "acme 1", spec),))
        monkeypatch.setattr(reading, "registry", lambda: Registry([bundle]))

    return make


def test_the_reader_of_a_bundle_tells_labels(acme, tmp_path, row):
    asked = []
    told = Labelling(labels=np.array([0, 1, 1, -1, 0, 0]), names=("a", "b"), notes=("seen",))
    acme(lambda path, shape: asked.append((path.name, shape)) or told)
    found = read_labels(tmp_path / "x.Sheet.GZ", row)
    assert asked == [("x.Sheet.GZ", row)]
    assert (found.labels.tolist(), found.names) == ([0, 1, 1, -1, 0, 0], ("a", "b"))
    assert found.notes == ("seen", "x.Sheet.GZ: 1 of 6 faces is unlabelled and left out")
    assert read_labels(tmp_path / "x.sheet", row, fill=True).labels.min() == 0
    assert "x.sheet.gz".endswith(reading.bearing_suffixes())
    with pytest.raises(UsageError, match="labels are those of places; give the shape"):
        read_labels(tmp_path / "x.sheet", 6)


def test_limits_hold_for_labels_as_for_shapes(acme, tmp_path, row):
    given = []
    told = Labelling(labels=np.zeros(6, int), names=None)
    acme(lambda path, shape, *, limits: given.append(limits) or told)
    raised = ReadLimits(cells=7)
    read_labels(tmp_path / "x.sheet", row, limits=raised)
    read_labels(tmp_path / "x.sheet", row)
    assert given == [raised, ReadLimits()]


def test_a_bundle_that_tells_no_labels_is_named(acme, tmp_path, row):
    acme(lambda path, shape: [0, 1])
    with pytest.raises(PluginError, match=r"'acme:sheet' of acme 1 must tell a Labelling of 6"):
        read_labels(tmp_path / "x.sheet", row)
    acme(lambda path, shape: 1 / 0)
    with pytest.raises(PluginError, match=r"'acme:sheet' of acme 1 failed on the labels of"):
        read_labels(tmp_path / "x.sheet", row)
    acme(lambda path, shape: path.read_bytes())
    with pytest.raises(ShapeError, match="cannot be read: No such file"):
        read_labels(tmp_path / "x.sheet", row)
