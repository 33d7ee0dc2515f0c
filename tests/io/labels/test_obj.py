"""Groups, objects and materials of OBJ files."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.labels.listing import Wanted
from moseg_core.io.labels.obj import read_obj_labels

VERTICES = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 2 1\n"
F1, F2, F3 = "f 1 2 3\n", "f 2/1 4/1 3/1\n", "f 3 \\\n 4 5\n"


@pytest.fixture
def read(as_file):
    def read(text, *properties):
        wanted = Wanted(n_elements=3, properties=properties)
        return read_obj_labels(as_file("x.obj", VERTICES + text), wanted)

    return read


@pytest.mark.parametrize("statement", ["g", "o", "usemtl"])
def test_names_hold_until_the_next(statement, read):
    found = read(f"{statement} leg\n{F1}{F2}{statement} upper arm\n{F3}")
    assert (found.labels.tolist(), found.names) == ([0, 0, 1], ("leg", "upper arm"))
    np.testing.assert_allclose(found.places[0], [1 / 3, 1 / 3, 0])
    assert found.notes == ()


def test_a_name_may_come_again(read):
    assert read(f"g leg\n{F1}g arm\n{F2}g leg\n{F3}").labels.tolist() == [0, 1, 0]


def test_what_tells_faces_apart_is_taken(read):
    found = read(f"o whole\ng all\nusemtl red\n{F1}usemtl blue\n{F2}{F3}")
    assert found.names == ("red", "blue")
    assert read(f"o whole\n{F1}{F2}{F3}").names == ("whole",)


def test_a_choice_between_several_is_said_and_may_be_made(read):
    text = f"g leg\nusemtl red\n{F1}usemtl blue\n{F2}g arm\n{F3}"
    found = read(text)
    assert found.names == ("leg", "arm")
    assert found.notes == (
        "x.obj: labels are its 2 groups, not its 2 materials; --label-property says which",
    )
    for asked in ("usemtl", "material", "Materials"):
        assert read(text, asked).names == ("red", "blue")
        assert read(text, asked).notes == ()


def test_faces_under_no_name_have_no_label(read):
    assert read(f"{F1}g leg\n{F2}g\n{F3}").labels.tolist() == [-1, 0, -1]
    assert read(f"usemtl (null)\n{F1}usemtl a\n{F2}usemtl None\n{F3}").labels.tolist() == [
        -1,
        0,
        -1,
    ]


def test_a_file_without_names_is_refused(refusal):
    def read(path):
        return read_obj_labels(path, Wanted(n_elements=1))

    message = refusal(read, "x.obj", VERTICES + F1)
    assert message.startswith(" names no groups (g), objects (o) or materials (usemtl)")
    asked = Wanted(n_elements=1, properties=("usemtl",))
    message = refusal(lambda path: read_obj_labels(path, asked), "x.obj", f"{VERTICES}g a\n{F1}")
    assert message.startswith(" has no kind of names 'material'")
