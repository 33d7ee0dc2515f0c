"""Names of properties that hold labels."""

from __future__ import annotations

from pathlib import Path

import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.labels.properties import chosen, familiar, names_labels, plain

PATH = Path("x.ply")


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("label", "label"),
        ("Labels", "label"),
        ("scalar_Label", "label"),
        ("scalar_label_id", "label"),
        ("objectId", "object"),
        ("object_id", "object"),
        ("segIndices", "seg"),
        ("segment-ID", "segment"),
        ("class", "class"),
        ("classes", "class"),
        ("ClassIndex", "class"),
        ("semantic_classes", "semanticclass"),
        ("patches", "patch"),
        ("Meshes", "mesh"),
        ("vertexes", "vertex"),
        ("faces", "face"),
        ("categories", "category"),
        ("x", "x"),
        ("id", "id"),
    ],
)
def test_names_without_what_is_written_differently(name, word):
    assert plain(name) == word


USUAL = (
    *("label", "labels", "object_id", "objectId", "segment", "segment_id", "part", "part_id"),
    *("scalar_Label", "scalar_Classification", "instance", "instance_id", "class_id", "category"),
    *("semantic_label", "cluster", "region", "gt_label", "pred_labels", "face_labels", "group"),
)


@pytest.mark.parametrize("name", USUAL)
def test_usual_names(name):
    assert familiar(["x", name, "quality"]) == [name]


@pytest.mark.parametrize(
    "name", ["x", "nx", "red", "quality", "flags", "intensity", "id", "curvature"]
)
def test_names_that_say_nothing_of_labels(name):
    assert familiar([name]) == []


def test_lists_that_name_labels():
    assert names_labels("names", 4, [252, None])
    assert names_labels("categories", 4, [252])
    assert not names_labels("classes", 252, [252])  # a class for each
    assert not names_labels("labels", 4, [252])


def test_of_several_the_surest_is_taken_and_the_others_are_said():
    name, notes = chosen(PATH, "property", ["objectId", "part", "label"], [])
    assert name == "label"
    assert notes == (
        "x.ply: labels are its property 'label', not 'part' or 'objectId'; --label-property says"
        " which",
    )
    assert chosen(PATH, "property", ["a", "label"], []) == ("label", ())
    assert chosen(PATH, "property", ["a"], []) == (None, ())


def test_what_is_asked_for_is_taken_the_first_that_there_is():
    names = ["label", "a", "scalar_Mine"]
    assert chosen(PATH, "property", names, ["b", "a"]) == ("a", ())
    assert chosen(PATH, "property", names, ["mine"]) == ("scalar_Mine", ())
    with pytest.raises(ShapeError, match=r"^x.ply has no property 'labl'; did you mean 'label'\?$"):
        chosen(PATH, "property", names, ["labl"])
    with pytest.raises(ShapeError, match=r"has no property 'zzz'; it has label, a, scalar_Mine$"):
        chosen(PATH, "property", names, ["zzz"])
    with pytest.raises(ShapeError, match=r"it has none that could hold labels"):
        chosen(PATH, "property", [], ["zzz"])
