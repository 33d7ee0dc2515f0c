"""Labels in other people's files, each as ``moseg evaluate`` is told to compare it.

A hammer of 252 faces: 90 of the handle, 162 of the head. Each file has the same labels in another
form; some leave faces out. All were refused once.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from moseg_core.cli import main
from moseg_core.io import load, read_labels

DATA = Path(__file__).parent / "data"
HAMMER, TRUTH = DATA / "hammer.obj", DATA / "hammer.seg"
ERRORS = ("rand_index_error", "rand_index_error_by_area", "hamming", "cut_discrepancy")


@pytest.fixture
def evaluate(capsys):
    def run(result, shape=HAMMER, truth=TRUTH):
        with pytest.raises(SystemExit) as ended:
            main(["evaluate", str(shape), str(result), str(truth), "--json"])
        said = capsys.readouterr()
        assert ended.value.code == 0, said.err
        return json.loads(said.out)["truths"][0], said.err

    return run


@pytest.mark.parametrize(
    "name", ["05b_floats.seg", "05c_numbers.txt", "05d_face_to_label.json", "05i_float_label.ply"]
)
def test_the_same_labels_in_another_form(name, evaluate):
    told, err = evaluate(DATA / name)
    assert {key: told[key] for key in ERRORS} == dict.fromkeys(ERRORS, 0.0)
    assert err == ""


@pytest.mark.parametrize(
    ("name", "left_out"), [("05e_unlabelled.npy", 28), ("05h_partly_labelled.txt", 3)]
)
def test_faces_without_a_label_are_left_out_and_counted_once(name, left_out, evaluate):
    told, err = evaluate(DATA / name)
    assert {key: told[key] for key in ERRORS} == dict.fromkeys(ERRORS, 0.0)
    assert err == f"moseg: {name}: {left_out} of 252 faces are unlabelled and left out\n"


@pytest.mark.parametrize("name", ["05_vertex_labels.ply", "05g_one_per_vertex.npy"])
def test_labels_of_vertices_are_carried_to_the_faces(name, evaluate):
    told, err = evaluate(DATA / name)
    assert err == (
        f"moseg: {name}: labels of 128 vertices; each face has that of most of its corners\n"
    )
    hammer = load(HAMMER)
    truth = read_labels(TRUTH, hammer).labels
    found = read_labels(DATA / name, hammer).labels
    # Only faces at the cut have corners of both parts, and may have been given to the other.
    wrong = np.flatnonzero(found != truth)
    at_cut = set(np.flatnonzero(_between(hammer, truth)).tolist())
    assert 0 < told["rand_index_error"] < 0.1
    assert set(wrong.tolist()) <= at_cut


def _between(shape, labels):
    """Which faces share a vertex with a face of another label."""
    faces = shape.geometry.merged[shape.geometry.triangles]
    kinds = [set() for _ in range(faces.max() + 1)]
    for face, label in zip(faces, labels, strict=True):
        for vertex in face:
            kinds[vertex].add(int(label))
    return np.array([any(len(kinds[v]) > 1 for v in face) for face in faces])


def test_groups_are_named_labels(evaluate):
    groups = DATA / "05f_groups.obj"
    told, err = evaluate(groups, shape=groups, truth=groups)
    assert told["named_right"] == 1.0
    assert err == ""
    found = read_labels(groups, load(groups))
    assert found.names == ("handle", "head")
    assert np.bincount(found.labels).tolist() == [90, 162]
