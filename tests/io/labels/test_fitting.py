"""Listings laid onto shapes: by number, by corners, by pieces, by place."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.io.labels.fitting import by_corners, fitted, heaviest
from moseg_core.io.labels.listing import Listing, middles
from moseg_core.shape.shape import Shape
from tests import shapes

PATH = Path("x.any")
TEE = Shape.from_mesh(*shapes.jitter(shapes.tee(4, 3), 1))
N = TEE.n_elements
LABELS = np.random.default_rng(1).integers(0, 4, N)
FAN = Shape.from_mesh(*shapes.fan(shapes.jitter(shapes.tee(4, 3), 1)))


def voted(face, labels):
    """The label of most corners; of several that whose first corner comes first."""
    known = [labels[v] for v in face if labels[v] != -1]
    counts = Counter(known)
    return max(known, key=lambda label: (counts[label], -known.index(label)), default=-1)


@given(st.integers(0, 2**32), st.integers(1, 4))
def test_each_face_has_the_label_of_most_corners(seed, kinds):
    rng = np.random.default_rng(seed)
    sizes = rng.integers(3, 7, 12)
    faces = [rng.integers(0, 15, size).tolist() for size in sizes]
    labels = rng.integers(-1, kinds, 15)
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    found = by_corners(np.concatenate(faces), offsets, labels)
    assert found.tolist() == [voted(face, labels.tolist()) for face in faces]


@given(st.integers(0, 2**32))
def test_each_group_has_the_label_of_most_weight(seed):
    rng = np.random.default_rng(seed)
    group, labels = rng.integers(0, 5, 20), rng.integers(-1, 3, 20)
    weights = rng.integers(1, 4, 20).astype(float)
    found = heaviest(group, labels, weights, 6)
    for g in range(6):
        own = {k: weights[(group == g) & (labels == k)].sum() for k in range(3)}
        best = max(own.values())
        assert found[g] == -1 if best == 0 else own[found[g]] == best


@pytest.mark.parametrize("of", ["unsaid", "elements"])
def test_as_many_labels_as_elements_are_theirs_in_order(of):
    labels, notes = fitted(PATH, Listing(labels=LABELS, of=of), TEE)
    np.testing.assert_array_equal(labels, LABELS)
    assert notes == ()
    assert fitted(PATH, Listing(labels=LABELS, of=of), N)[0].tolist() == LABELS.tolist()


def test_of_a_shape_with_as_many_vertices_as_faces_the_faces_are_meant():
    ring = Shape.from_mesh(*shapes.joined(shapes.strip(2), shapes.strip(2)))
    vertices = len(ring.geometry.vertices)
    assert vertices != ring.n_elements
    tetrahedron = Shape.from_mesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    )
    labels = np.array([0, 1, 2, 3])
    assert fitted(PATH, Listing(labels=labels), tetrahedron)[0].tolist() == [0, 1, 2, 3]
    said, notes = fitted(PATH, Listing(labels=labels, of="vertices"), tetrahedron)
    assert said.tolist() == [0, 0, 1, 2]
    assert "labels of 4 vertices" in notes[0]


def test_points_of_a_cloud_are_its_vertices():
    cloud = Shape.from_points(np.random.default_rng(0).random((6, 3)))
    for of in ("unsaid", "vertices", "elements"):
        labels, notes = fitted(PATH, Listing(labels=np.arange(6), of=of), cloud)
        assert labels.tolist() == list(range(6))
        assert notes == ()


def test_faces_in_another_order_are_known_by_their_places():
    order = np.random.default_rng(2).permutation(N)
    listing = Listing(labels=LABELS[order], places=middles(TEE.geometry)[order])
    labels, notes = fitted(PATH, listing, TEE)
    np.testing.assert_array_equal(labels, LABELS)
    assert notes == ("x.any: its faces are in another order; each face has the label of its place",)


def test_single_precision_is_near_enough_and_far_from_the_origin_too():
    for shift in (0.0, 5e6):
        far = Shape.from_mesh(TEE.geometry.vertices + shift, shapes.tee(4, 3)[1])
        order = np.arange(N)[::-1]
        places = middles(far.geometry)[order].astype(np.float32).astype(float)
        if shift:  # what one may expect of it
            places = middles(far.geometry)[order] + 1e-8 * shift
        labels, _ = fitted(PATH, Listing(labels=LABELS[order], places=places), far)
        np.testing.assert_array_equal(labels, LABELS)


def test_triangles_of_polygons_are_known_by_their_places():
    order = np.random.default_rng(3).permutation(FAN.n_elements)
    of_triangles = LABELS[TEE.geometry.triangle_polygon]
    corners = TEE.geometry.vertices[TEE.geometry.triangles]
    listing = Listing(labels=of_triangles[order], places=corners.mean(axis=1)[order])
    np.testing.assert_array_equal(fitted(PATH, listing, TEE)[0], LABELS)


def test_places_that_are_others_leave_the_order_to_count():
    moved = Listing(labels=LABELS, places=3.0 * middles(TEE.geometry) + 7.0)
    labels, notes = fitted(PATH, moved, TEE)
    np.testing.assert_array_equal(labels, LABELS)
    assert notes == ()


def test_elements_of_which_nothing_lies_in_the_file_have_no_label():
    some = np.arange(N) >= 5
    listing = Listing(labels=LABELS[some], places=middles(TEE.geometry)[some])
    labels, _ = fitted(PATH, listing, TEE)
    np.testing.assert_array_equal(labels, np.where(some, LABELS, -1))


def test_pieces_of_faces_give_them_the_label_of_most_area():
    listing = Listing(
        labels=np.concatenate([LABELS, LABELS + 1]),
        source=np.tile(np.arange(N), 2),
        places=np.tile(middles(TEE.geometry), (2, 1)),
        weights=np.concatenate([np.full(N, 0.7), np.full(N, 0.3)]),
    )
    labels, notes = fitted(PATH, listing, TEE)
    np.testing.assert_array_equal(labels, LABELS)
    assert notes == (f"x.any: labels of {2 * N} pieces; each face has that of most of its area",)


@pytest.mark.parametrize(
    ("count", "of", "message"),
    [
        (3, "unsaid", "; give the labels of this very shape"),
        (N + 1, "unsaid", "; one is missing or over, perhaps a header; give the labels of"),
        (2 * N, "unsaid", "; so these are labels of edges, as MeshCNN has them; give labels of f"),
        (len(TEE.geometry.vertices), "elements", "; its number of vertices, but the file says"),
        (3, "vertices", "x.any has 3 labels of vertices but the shape has"),
    ],
)
def test_what_a_number_of_labels_would_fit_is_said(count, of, message):
    with pytest.raises(ShapeError) as caught:
        fitted(PATH, Listing(labels=np.zeros(count, int), of=of), TEE)
    said = f"the shape has {N} faces, {len(TEE.geometry.vertices)} vertices and {2 * N} edges"
    assert said in str(caught.value)
    assert message in str(caught.value)


def test_vertices_of_an_unknown_number_are_refused():
    with pytest.raises(ShapeError, match="and how many the shape has is not known"):
        fitted(PATH, Listing(labels=np.zeros(5, int), of="vertices"), 5)


def test_labels_of_the_vertices_that_are_left_when_equal_ones_are_joined():
    vertices, faces = shapes.strip(4)
    loose = Shape.from_mesh(
        np.asarray(vertices)[np.concatenate(faces)], np.arange(16).reshape(4, 4)
    )
    joined = int(loose.geometry.merged.max()) + 1
    assert joined not in (loose.n_elements, len(loose.geometry.vertices))
    with pytest.raises(ShapeError, match=f"labels of the {joined} vertices that are left where"):
        fitted(PATH, Listing(labels=np.zeros(joined, int)), loose)
