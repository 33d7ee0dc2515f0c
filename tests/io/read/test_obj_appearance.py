"""Texture coordinates, normals and materials of OBJ files, and files in which they are damaged."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.read.obj import read_obj
from moseg_core.io.read.obj_appearance import corner_numbers, other_numbers

# Two quads with a texture seam between them, and a triangle without texture.
PAGES = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 2 0 0
v 2 1 0
v 3 0 0
vt 0 0
vt 0.5 0 0
vt 0.5 1
vt 0 1
vn 0 0 1
f 1/1/1 2/2/1 3/3/1 4/4/1
usemtl left page
vt 1
vt 1 1
f -6/-5/-1 -3/-2/-1 -2/-1/-1 -5/-4/-1
usemtl
f 5//1 7//1 6//1
"""


def looks_of(shape):
    return shape.geometry.appearance


def test_what_corners_have(as_file):
    looks = looks_of(read_obj(as_file("pages.obj", PAGES)))
    assert looks.texture.values.tolist() == [[0, 0], [0.5, 0], [0.5, 1], [0, 1], [1, 0], [1, 1]]
    assert looks.texture.corners.tolist() == [0, 1, 2, 3, 1, 4, 5, 2, -1, -1, -1]
    assert looks.normals.values.tolist() == [[0, 0, 1]]
    assert looks.normals.corners.tolist() == [0] * 11
    assert looks.materials == ("left page",)
    assert looks.polygon_materials.tolist() == [-1, 0, -1]


def test_a_file_without_any_has_none(as_file):
    looks = looks_of(read_obj(as_file("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")))
    assert (looks.texture, looks.normals, looks.materials) == (None, None, ())
    assert looks.polygon_materials is None


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ("vt 0.5 1", "vt 0.5 one", "texture coordinates that are no numbers; all are passed over"),
        ("vt 0.5 1", "vt nan 1", "texture coordinates that are no numbers; all are passed over"),
        ("2/2/1", "2/99/1", "texture coordinates that corners name and that are not there: 1"),
        ("2/2/1", "2/-9/1", "texture coordinates that corners name and that are not there: 1"),
        ("2/2/1", "2/2/7", "normals that corners name and that are not there: 1"),
    ],
)
def test_damaged_ones_are_passed_over_with_a_note(old, new, note, as_file):
    whole = read_obj(as_file("pages.obj", PAGES))
    shape = read_obj(as_file("pages.obj", PAGES.replace(old, new)))
    assert shape.fingerprint == whole.fingerprint
    assert [each for each in shape.notes if each not in whole.notes] == [note]


def test_one_damaged_number_is_that_of_no_other_corner(as_file):
    looks = looks_of(read_obj(as_file("pages.obj", PAGES.replace("2/2/1", "2/x/1"))))
    assert looks.texture.corners.tolist() == [0, -1, 2, 3, 1, 4, 5, 2, -1, -1, -1]
    assert looks.normals.corners.tolist() == [0] * 11


number = st.integers(-(10**6), 10**6).filter(bool)


@given(rows=st.lists(st.tuples(number, number, number), min_size=1), form=st.integers(0, 3))
def test_corners_of_one_form_read_as_each_alone_does(rows, form):
    write = ("{0}", "{0}/{1}", "{0}//{2}", "{0}/{1}/{2}")[form]
    tokens = [write.format(*row).encode() for row in rows]
    numbers = corner_numbers(tokens)
    assert numbers is not None
    assert numbers[:, 0].tolist() == [row[0] for row in rows]
    others = np.zeros((len(rows), 2), np.int64)
    others[:, : numbers.shape[1] - 1] = numbers[:, 1:]
    np.testing.assert_array_equal(others, other_numbers(tokens))


@pytest.mark.parametrize(
    "words", ["1/2 3", "1//2 3/4", "1 2/3/4", "1/ 2/3", "1_0 2", "1/2/3/4", "x", "1/2/3 4", ""]
)
def test_other_corners_are_not_read_in_one_go(words):
    assert corner_numbers(words.encode().split()) is None
