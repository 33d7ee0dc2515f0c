from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import UsageError
from moseg_core.io.label_files import encode_named_labels, encode_seg, read_labels, save_labels

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


@given(labels=st.lists(st.integers(0, 2**40), min_size=1, max_size=50))
def test_seg_round_trip(labels, as_file):
    found = read_labels(as_file("x.seg", encode_seg(np.array(labels))), len(labels))
    assert found.labels.tolist() == labels
    assert found.labels.dtype == np.int64
    assert found.names is None


NAMES = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S", "Zs")), min_size=1)


@given(data=st.data(), names=st.lists(NAMES, min_size=1, max_size=6, unique=True))
def test_named_round_trip(data, names, as_file):
    index = st.integers(0, len(names) - 1)
    labels = data.draw(st.lists(index, min_size=1, max_size=40))
    try:
        contents = encode_named_labels(labels, names)
    except UsageError:
        # Only for names that could be mistaken, for example a number or one with outer blanks.
        assert any(name != name.strip() or name.lstrip("+-")[:1].isdigit() for name in names)
        return
    found = read_labels(as_file("x.txt", contents), len(labels))
    assert found.labels.tolist() == labels
    assert found.names == tuple(names)


@pytest.mark.parametrize(
    "text",
    [
        NAMED,
        NAMED.replace("\n", "\r\n"),
        "\n\n" + NAMED.replace("\nupper", "\n\n  \nupper") + "\n\n",
        NAMED.rstrip(),
        "\ufeff" + NAMED,
        "body\n4\nupper arm\n2 5\n  body\n3\nbody \n1\n",
        "body\n1 3 4\nupper arm\n2\nbody\n\nupper arm\n5",
    ],
)
def test_variants_of_named_labels_read_alike(text, as_file):
    found = read_labels(as_file("x.txt", text), 5)
    assert found.labels.tolist() == [0, 1, 0, 0, 1]
    assert found.names == ("body", "upper arm")


def test_a_name_that_no_face_bears_keeps_its_place(as_file):
    contents = encode_named_labels([0, 2], ["a", "b", "c"])
    assert contents == b"a\n1\nb\n\nc\n2\n"
    assert read_labels(as_file("x.txt", contents), 2).names == ("a", "b", "c")


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
        ("x.seg", "0\n\n1\n-1\n", ", line 4: the label -1 is negative; labels count from 0"),
        ("x.seg", "0\n1 2\n", ", line 2: expected one label, found 2 words"),
        ("x.seg", "0\n1.0\n", ", line 2: '1.0' is not an integer"),
        ("x.seg", "0\n99999999999999999999\n", ", line 2: '99999999999999999999' is not"),
        ("x.txt", "", " is empty"),
        ("x.txt", "body\n1 2 3 4 5 6 7 8 9 10 12\n", " has no label for face 11 (1 such of 12)"),
        ("x.txt", "body\n1\n", " has no label for face 2 (11 such of 12); every face needs one"),
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
        ("x.json", "[]", " has no list of integers 'labels'; give a result of moseg"),
        ("x.json", result([0, 0.5]), " has no list of integers 'labels'"),
        ("x.json", result([True] * 12), " has no list of integers 'labels'"),
        ("x.json", result([2**70] * 12), " has labels that are too large"),
        ("x.json", result([0] * 11 + [-2]), " gives element 11 the label -2; labels and elements"),
        ("x.json", result([0] * 12, "body"), " has a member problem.labels that is not a list"),
        ("x.json", result([0] * 12, [1, 2]), " has a member problem.labels that is not a list"),
        ("x.json", result([0] * 9 + [1] * 3, ["a"]), " gives element 9 the label 1, but names"),
        ("x.ply", "ply\n", " has no 'end_header'"),
        ("x.ply", PLY.replace("uchar label", "uchar part"), " has no property 'label'"),
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


@pytest.mark.parametrize("name", ["labels.csv", "labels", "labels.seg.gz"])
def test_other_suffixes_are_refused_with_those_allowed(name, as_file):
    with pytest.raises(
        UsageError, match=r"allowed: \.seg, \.txt, \.json, \.ply, \.glb, \.npz, \.npy$"
    ):
        read_labels(as_file(name, "0\n"), 1)


def test_labels_that_are_cut_off_are_never_read_in_part(accepted_cuts):
    def read(path: Path) -> list[int]:
        return read_labels(path, 5).labels.tolist()

    whole = [0, 1, 0, 0, 1]
    for name, contents in [
        ("x.seg", encode_seg(whole)),
        ("x.txt", NAMED.encode()),
        ("x.json", result(whole, ["body", "arm"]).encode()),
    ]:
        for stop, labels in accepted_cuts(read, name, contents).items():
            assert labels == whole
            assert contents[stop:].strip() == b""


@pytest.mark.parametrize(
    ("labels", "names", "message"),
    [
        ([0, 2], ["a", "b"], "label 2 has no name; there are 2 names"),
        ([0, -1], ["a"], "labels count from 0; element 1 has -1"),
        ([[0]], ["a"], "labels must be a row of integers"),
        ([0.5], ["a"], "labels must be a row of integers"),
        ([0], ["a", "b", "a"], "the label name 'a' is repeated"),
        ([0], [""], "the label name '' cannot be written"),
        ([0], [" a"], "the label name ' a' cannot be written"),
        ([0], ["a\nb"], r"the label name 'a\\nb' cannot be written"),
        ([0], ["12"], "the label name '12' cannot be written"),
        ([0], ["3 legs"], "the label name '3 legs' cannot be written"),
    ],
)
def test_labels_that_cannot_be_written(labels, names, message):
    with pytest.raises(UsageError, match=message):
        encode_named_labels(labels, names)


def test_names_may_begin_with_a_digit_that_is_no_number(as_file):
    contents = encode_named_labels([0, 1], ["1st leg", "-x"])
    assert read_labels(as_file("x.txt", contents), 2).names == ("1st leg", "-x")


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


def test_labels_are_saved_by_suffix(tmp_path):
    save_labels([1, 0, 1], tmp_path / "x.SEG")
    assert (tmp_path / "x.SEG").read_bytes() == b"1\n0\n1\n"
    save_labels([1, 0, 1], str(tmp_path / "x.txt"), names=["a", "b"])
    found = read_labels(tmp_path / "x.txt", 3)
    assert (found.names[found.labels[0]], found.names[found.labels[1]]) == ("b", "a")


@pytest.mark.parametrize(
    ("name", "message"),
    [("x.txt", "needs names"), ("x.json", "as .txt or .seg, not '.json'"), ("x", "not 'x'")],
)
def test_labels_that_cannot_be_saved_are_refused(tmp_path, name, message):
    with pytest.raises(UsageError, match=message):
        save_labels([0, 1], tmp_path / name)
    assert list(tmp_path.iterdir()) == []
