"""Lists and maps in JSON."""

from __future__ import annotations

import json

import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.labels.json_forms import read_json
from moseg_core.io.labels.listing import Wanted

WANTED = Wanted(n_elements=3, n_vertices=5, noun="face")


@pytest.fixture
def read(as_file):
    def read(document, wanted=WANTED):
        return read_json(as_file("x.json", json.dumps(document)), wanted)

    return read


@pytest.mark.parametrize(
    "document",
    [
        [1, 0, 1],
        [1.0, 0.0, 1.0],
        [True, False, True],
        ["1", "0", "1"],
        [[1], [0], [1]],
        {"0": 1, "1": 0, "2": 1},
        {"1": 1, "2": 0, "3": 1},
        {"0": [1], "1": [0, 2]},
        [[1], [0, 2]],
        {"labels": [1, 0, 1]},
        {"labels": {"0": 1, "1": 0, "2": 1}},
        {"shape": "cup", "face_labels": [1, 0, 1], "areas": [0.1, 0.2, 0.3]},
        {"seg": [1, 0, 1]},
        {"partIds": [1, 0, 1]},
        {"segments": [{"id": 1, "faces": [0, 2]}, {"id": 0, "faces": [1]}]},
    ],
)
def test_numbers(document, read):
    assert read(document).labels.tolist() == [1, 0, 1]
    assert read(document).names is None


@pytest.mark.parametrize(
    "document",
    [
        ["leg", "arm", "leg"],
        {"0": "leg", "1": "arm", "2": "leg"},
        {"leg": [0, 2], "arm": [1]},
        {"leg": [1, 3], "arm": [2]},
        {"labels": [0, 1, 0], "names": ["leg", "arm"]},
        {"labels": [0, 1, 0], "classes": ["leg", "arm"]},
        {"labels": [0, 1, 0], "label_names": {"0": "leg", "1": "arm"}},
        {"labels": [0, 1, 0], "problem": {"labels": ["leg", "arm"]}},
        {"labels": ["leg", "arm", "leg"]},
        [{"name": "leg", "faces": [0, 2]}, {"name": "arm", "faces": [1]}],
        {"parts": [{"label": "leg", "triangles": [0, 2]}, {"label": "arm", "triangles": [1]}]},
        {"labels": {"leg": [0, 2], "arm": [1]}},
    ],
)
def test_names(document, read):
    found = read(document)
    assert [found.names[k] for k in found.labels] == ["leg", "arm", "leg"]


@pytest.mark.parametrize(
    ("document", "labels"),
    [
        ([None, 0, -1], [-1, 0, -1]),
        ({"2": 4}, [-1, -1, 4]),
        ({"0": None, "1": 3}, [-1, 3, -1]),
        ({"leg": [1], "arm": []}, [-1, 0, -1]),
        (["leg", None, ""], [0, -1, -1]),
    ],
)
def test_faces_without_a_label(document, labels, read):
    assert read(document).labels.tolist() == labels


@pytest.mark.parametrize(
    "document",
    [
        {"segIndices": [7, 7, 0, 0, 0], "sceneId": "s"},
        {"vertex_labels": [7, 7, 0, 0, 0]},
        {"point_labels": [7, 7, 0, 0, 0]},
        [{"id": 7, "vertices": [0, 1]}, {"id": 0, "vertices": [2, 3, 4]}],
    ],
)
def test_of_vertices(document, read):
    found = read(document)
    assert (found.labels.tolist(), found.of) == ([7, 7, 0, 0, 0], "vertices")


def test_groups_of_segments_are_objects_with_names(read):
    groups = [
        {"id": 0, "objectId": 0, "segments": [7, 9], "label": "chair"},
        {"id": 1, "objectId": 4, "segments": [2]},
    ]
    found = read({"segIndices": [7, 9, 2, 5, 2], "segGroups": groups})
    assert found.labels.tolist() == [0, 0, 1, -1, 1]
    assert found.names == ("chair", "object 4")


def test_a_member_may_be_asked_for(read):
    wanted = Wanted(n_elements=3, properties=("mine",))
    assert read({"labels": [0, 0, 0], "mine": [2, 1, 0]}, wanted).labels.tolist() == [2, 1, 0]


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ("text", " has str where labels are looked for; allowed are a list with a label for each"),
        ({}, " has no labels under its members "),
        ({"a": 1}, " has no labels under its members 'a'; allowed are"),
        ([[0], 1], " has [0] in its list of labels"),
        ([{"a": 1}], " has a record without a list of faces: a"),
        ([[0, 1], [1]], " gives face 1 the label '0' and the label '1'; a face has one label"),
        ({"a": [0, 7]}, " gives the label 'a' to face 7, but there are 3, counted from 0"),
        ({"a": [2**70]}, " has an id under 'a' that is too large"),
        ({"-3": [1]}, " gives element 0 the label -3; labels count from 0"),
        ({"segGroups": []}, " groups segments and has none itself; give the file that ends in"),
        ({"segGroups": [], "segmentsFile": "s.json"}, " groups segments and has none itself; gi"),
        ({"segIndices": [0], "segGroups": [{}]}, " has segGroups without lists of 'segments'"),
        ({"\ud83d": [1], "a": [1]}, " gives face 1 the label '\\ud83d' and the label 'a'"),
        ({"labels": [0, 1, 0], "names": "ab"}, " has a member names that is not a list of names"),
    ],
)
def test_what_is_refused(document, message, refusal):
    said = refusal(lambda path: read_json(path, WANTED), "x.json", json.dumps(document))
    assert said.startswith(message)


@pytest.mark.parametrize("labels", [{"0": 1, "3": 0}, {"1": [0], "0": [3]}, [[3], [0]]])
def test_ids_under_a_key_that_names_vertices_are_of_these(labels, read):
    found = read({"vertex_labels": labels})
    expected = [1, -1, -1, 0, -1]
    assert (found.labels.tolist(), found.of) == (expected, "vertices")


def test_ids_under_a_key_that_names_faces_are_of_these(read):
    assert read({"face_labels": {"0": 1, "2": 0}}).of == "elements"
    with pytest.raises(ShapeError, match="to face 3, but there are 3"):
        read({"face_labels": dict.fromkeys("01234", 0)})


def test_what_a_record_says_that_it_labels_goes_before_its_list(read):
    found = read({"faces": [{"id": 3, "vertices": [0, 4]}]})
    assert (found.labels.tolist(), found.of) == ([3, -1, -1, -1, 3], "vertices")
    assert read({"seg": [1, 0, 1]}).of == "unsaid"
