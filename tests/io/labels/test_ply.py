"""Properties of PLY files that are labels."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.labels.listing import Wanted
from moseg_core.io.labels.ply import read_ply_labels
from tests.io.read.ply_files import FACES, FORMATS, ORDERS, VERTICES, encode, mesh_file

FOUR = Wanted(n_elements=4, n_vertices=4, noun="face")
LABELS = [3, 0, 3, 1]


def mesh(form="ascii", *, faces=(), vertices=(), values=LABELS) -> bytes:
    """The tetrahedron with properties such as "int label" of faces and of vertices."""
    position = ["float x", "float y", "float z", *vertices]
    points = [row + [v] * len(vertices) for row, v in zip(VERTICES.tolist(), values, strict=True)]
    polygons = [[face, *[v] * len(faces)] for face, v in zip(FACES, values, strict=True)]
    return encode(
        form,
        [
            ("vertex", position, points),
            ("face", ["list uchar int vertex_indices", *faces], polygons),
        ],
    )


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("kind", ["uchar", "int16", "ushort", "int", "uint32", "float", "double"])
@pytest.mark.parametrize("name", ["label", "objectId", "scalar_Classification"])
def test_any_type_and_any_usual_name(form, kind, name, as_file):
    found = read_ply_labels(as_file("x.ply", mesh(form, faces=[f"{kind} {name}"])), FOUR)
    assert (found.labels.tolist(), found.of, found.names) == (LABELS, "elements", None)
    middle = [VERTICES[face].mean(axis=0) for face in FACES]
    np.testing.assert_allclose(found.places, middle, atol=1e-6)


@pytest.mark.parametrize("form", FORMATS)
def test_of_vertices(form, as_file):
    found = read_ply_labels(as_file("x.ply", mesh(form, vertices=["ushort label"])), FOUR)
    assert (found.labels.tolist(), found.of, found.places) == (LABELS, "vertices", None)


def test_of_faces_before_vertices_and_points_of_clouds(as_file):
    both = mesh(faces=["int part"], vertices=["int label"])
    assert read_ply_labels(as_file("x.ply", both), FOUR).of == "elements"
    asked = Wanted(n_elements=4, properties=("label",))
    assert read_ply_labels(as_file("x.ply", both), asked).of == "vertices"
    properties = ["int label", "float x", "float y", "float z"]
    cloud = encode("ascii", [("vertex", properties, [[3, *row] for row in VERTICES.tolist()])])
    found = read_ply_labels(as_file("x.ply", cloud), FOUR)
    assert (found.labels.tolist(), found.of) == ([3] * 4, "elements")


@pytest.mark.parametrize("form", FORMATS)
def test_names_in_comments(form, as_file):
    comments = ["made by hand", "moseg label 1 upper arm", "moseg label 0 tail"]
    path = as_file("x.ply", mesh_file(form, labels=[1, 0, 0, 1], comments=comments))
    found = read_ply_labels(path, FOUR)
    assert found.labels.tolist() == [1, 0, 0, 1]
    assert found.labels.dtype == np.int64
    assert found.names == ("tail", "upper arm")


def test_names_in_comments_are_of_the_property_label_alone(as_file):
    contents = mesh(faces=["int label", "int part"], values=[0, 1, 1, 0])
    contents = contents.replace(b"element vertex", b"comment moseg label 0 leg\nelement vertex", 1)
    contents = contents.replace(b"element vertex", b"comment moseg label 1 arm\nelement vertex", 1)
    path = as_file("x.ply", contents)
    assert read_ply_labels(path, FOUR).names == ("leg", "arm")
    assert read_ply_labels(path, Wanted(n_elements=4, properties=("part",))).names is None


def test_pieces_say_whose_they_are_and_how_large(as_file):
    found = read_ply_labels(as_file("x.ply", mesh(faces=["int label", "int source"])), FOUR)
    assert found.source.tolist() == LABELS
    corners = VERTICES[np.array(FACES)]
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    np.testing.assert_allclose(found.weights, areas, rtol=1e-6)


def test_faces_of_two_corners_are_no_elements(as_file):
    faces = [*FACES[:2], [0, 1], *FACES[2:]]
    path = as_file("x.ply", mesh_file("ascii", faces=faces, labels=[3, 0, 9, 3, 1]))
    found = read_ply_labels(path, FOUR)
    assert found.labels.tolist() == LABELS
    assert len(found.places) == 4


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (mesh(), " has no property 'label'; give a file with labelled faces or points"),
        (
            mesh(faces=["int q"]),
            " has no property 'label', or another name that is usual for labels",
        ),
        (mesh(faces=["float label"], values=[0.5] * 4), " gives face 0 the label 0.5; labels are"),
        (
            mesh(vertices=["int label"], values=[0, 0, -4, 0]),
            " gives vertex 2 the label -4; labels",
        ),
        (
            mesh("binary_big_endian", faces=["uchar label"])[:-3],
            " ends after 3 of 4 rows of the element 'face'",
        ),
    ],
)
def test_what_is_refused(contents, message, refusal):
    assert refusal(lambda path: read_ply_labels(path, FOUR), "x.ply", contents).startswith(message)


def test_lists_are_no_labels(refusal):
    face = ("face", ["list uchar int vertex_indices", "list uchar int label"], [[[0, 1, 2], [1]]])
    contents = encode("ascii", [("vertex", ["float x"], [[0]] * 3), face])
    message = refusal(lambda path: read_ply_labels(path, FOUR), "x.ply", contents)
    assert message.startswith(" has a face property 'label' that is a list, not one number")


@pytest.mark.parametrize(
    ("comments", "message"),
    [
        (["moseg label 0"], " has the comment 'moseg label 0'; it must read 'moseg label <index>"),
        (["moseg label x body"], " has the comment 'moseg label x body'"),
        (["moseg label 0 a", "moseg label 0 b"], " names label 0 twice: 'a' and 'b'"),
    ],
)
def test_comments_that_name_no_label(comments, message, refusal):
    contents = mesh_file("ascii", labels=[0] * 4, comments=comments)
    assert message in refusal(lambda path: read_ply_labels(path, FOUR), "bad.ply", contents)


@pytest.mark.parametrize("form", FORMATS)
def test_damaged_bytes_are_read_or_refused(form, damages):
    contents = mesh_file(form, faces=[*FACES, [0, 1, 2, 3]], labels=range(5))
    assert damages(lambda path: read_ply_labels(path, FOUR), "damaged.ply", contents) > 50


@pytest.mark.parametrize("form", list(ORDERS))
def test_a_binary_file_that_is_cut_off_is_never_read(form, accepted_cuts):
    contents = mesh_file(form, labels=LABELS)
    assert accepted_cuts(lambda path: read_ply_labels(path, FOUR), "cut.ply", contents) == {}
