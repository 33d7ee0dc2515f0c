from __future__ import annotations

import numpy as np
from moseg_objectives_basic.fields.places import Places

from moseg_core import Shape


def test_a_small_shape_is_its_own_places(make):
    shape = Shape.from_mesh(*make.ball(2))
    places = Places.of(shape, shape.n_elements)
    assert places.shape is shape
    assert places.members.tolist() == places.chosen.tolist() == list(range(shape.n_elements))


def test_of_each_group_the_element_nearest_to_its_middle_is_chosen(make):
    shape = Shape.from_mesh(*make.ball(3))
    places = Places.of(shape, 100)
    assert len(places.chosen) == places.shape.n_elements == 100
    for group, chosen in enumerate(places.chosen):
        members = np.flatnonzero(places.members == group)
        away = np.linalg.norm(shape.points[members] - places.shape.points[group], axis=1)
        assert chosen in members
        assert away[members == chosen][0] <= away.min() + 1e-12


def test_elements_without_area_are_not_chosen_where_others_are(make):
    vertices, faces = make.ball(2)
    pointless = [[a, a, b] for a, b, _ in faces]
    shape = Shape.from_mesh(vertices, [*faces.tolist(), *pointless])
    places = Places.of(shape, 60)
    with_area = np.bincount(places.members, shape.areas > 0) > 0
    assert (shape.areas[places.chosen[with_area]] > 0).all()
