from __future__ import annotations

import numpy as np
import pytest
from moseg_mds.surface import Surface

from moseg_core import Shape, ShapeError


def test_a_soup_is_one_surface(make):
    mesh = make.blob(0)
    whole, loose = Surface.of(make.shape(mesh)), Surface.of(make.shape(make.soup(mesh)))
    np.testing.assert_array_equal(whole.vertices, loose.vertices)
    np.testing.assert_array_equal(np.sort(whole.triangles), np.sort(loose.triangles))
    np.testing.assert_array_equal(whole.origin[mesh[1]].reshape(-1), loose.origin)


def test_the_order_of_faces_does_not_matter(make):
    vertices, faces = make.blob(1)
    order = np.random.default_rng(0).permutation(len(faces))
    one, other = (Surface.of(Shape.from_mesh(vertices, f)) for f in (faces, faces[order]))
    np.testing.assert_array_equal(one.triangles, other.triangles)


def test_what_is_no_surface_goes_to_the_nearest_point(make):
    vertices, faces = make.ball(1)
    n = len(vertices)
    stray = np.concatenate([vertices, [[9.0, 0, 0], [0, 0, -7.0]]])
    # Vertex n belongs to nothing, vertex n + 1 to a face that is a point.
    surface = Surface.of(Shape.from_mesh(stray, [*faces.tolist(), [n + 1] * 3]))
    assert len(surface.vertices) == n
    assert len(surface.triangles) == len(faces)
    assert surface.origin[n] == surface.origin[vertices[:, 0].argmax()]
    assert surface.origin[n + 1] == surface.origin[vertices[:, 2].argmin()]


def test_polygons_are_cut_up():
    square = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    assert len(Surface.of(square).triangles) == 2


def test_several_pieces_are_refused_with_their_number(make):
    vertices, faces = make.ball(1)
    shift = [[0, 0, 0], [3, 0, 0], [6, 0, 0]]
    many = np.concatenate([vertices + s for s in np.array(shift)])
    triples = np.concatenate([faces + k * len(vertices) for k in range(3)])
    with pytest.raises(ShapeError, match=r"in 3 pieces .* 80 of 240 .* join them") as found:
        Surface.of(Shape.from_mesh(many, triples, name="balls"))
    assert found.value.exit_code == 3
    assert str(found.value).startswith("'balls' cannot be embedded")


def test_pieces_that_touch_in_a_vertex_are_one():
    bow = [[0, 0, 0], [1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0.0]]
    assert len(Surface.of(Shape.from_mesh(bow, [[0, 1, 2], [0, 3, 4]])).vertices) == 5
