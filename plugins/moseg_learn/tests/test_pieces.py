from __future__ import annotations

import numpy as np
from moseg_learn.pieces import pieces_of

from moseg_core import Example, Shape


def strip(labels, names, *, widths=None, name="strip"):
    """Quads in a row, of width 1 where nothing else is said."""
    x = np.concatenate([[0.0], np.cumsum(widths or [1.0] * len(labels))])
    vertices = [[at, y, 0.0] for at in x for y in (0.0, 1.0)]
    quads = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(len(labels))]
    return Example(Shape.from_mesh(vertices, quads, name=name), labels, names)


def kinds_along(pieces):
    return [pieces.kinds[label] for label in pieces.labels]


def test_each_connected_piece_of_a_name_is_a_part():
    pieces = pieces_of(strip([0, 1, 0, 0, 1], ("leg", "body")))
    assert pieces.counts() == {"body": 2, "leg": 2}
    assert kinds_along(pieces) == ["leg", "body", "leg", "leg", "body"]
    assert pieces.kinds == ("body", "body", "leg", "leg")
    assert pieces.labels[2] == 2, "the larger part of a kind comes first"


def test_parts_that_are_numbered_stay_apart_though_they_touch():
    pieces = pieces_of(strip([0, 1, 2], ("leg1", "leg2", "body")))
    assert pieces.counts() == {"body": 1, "leg": 2}
    together = pieces_of(strip([0, 0, 1], ("leg", "body")))
    assert together.counts() == {"body": 1, "leg": 1}
    apart = pieces_of(strip([0, 1, 2], ("leg1", "leg2", "body")), numbers="different")
    assert apart.counts() == {"body": 1, "leg1": 1, "leg2": 1}


def test_scraps_go_to_the_neighbour_with_the_longest_boundary():
    example = strip([0, 1, 0, 1, 1], ("body", "leg"), widths=[9, 0.01, 9, 9, 9])
    pieces = pieces_of(example)
    assert pieces.counts() == {"body": 1, "leg": 1}
    assert kinds_along(pieces) == ["body", "body", "body", "leg", "leg"]


def test_the_largest_piece_of_a_name_is_no_scrap():
    pieces = pieces_of(strip([0, 1, 0], ("body", "eye"), widths=[9, 0.01, 9]))
    assert pieces.counts() == {"body": 2, "eye": 1}


def test_a_scrap_that_touches_nothing_goes_to_the_nearest():
    quads = [[0, 1, 2, 3], [1, 4, 5, 2], [6, 7, 8, 9]]
    vertices = [[0, 0, 0], [9, 0, 0], [9, 1, 0], [0, 1, 0], [18, 0, 0], [18, 1, 0]]
    vertices += [[17, 2, 0], [17.01, 2, 0], [17.01, 2.01, 0], [17, 2.01, 0]]
    pieces = pieces_of(Example(Shape.from_mesh(vertices, quads), [0, 1, 0], ("left", "right")))
    assert kinds_along(pieces) == ["left", "right", "right"]
    assert pieces.kinds == ("left", "right")


def test_where_nothing_is_known_to_touch_a_name_is_one_part():
    cloud = Shape.from_points(np.random.default_rng(0).normal(size=(40, 3)))
    pieces = pieces_of(Example(cloud, np.arange(40) % 2, ("a", "b")))
    assert pieces.counts() == {"a": 1, "b": 1}


def test_on_super_elements_parts_are_the_same_but_for_their_borders(make):
    whole = pieces_of(make.beast(rounds=4))
    coarse = whole.at(800)
    assert 500 < coarse.shape.n_elements <= 800
    assert coarse.kinds == whole.kinds
    again = coarse.labels[coarse.shape.members]
    areas = whole.shape.areas
    assert areas[again == whole.labels].sum() > 0.95 * whole.shape.area
    assert whole.at(0) is whole
    assert whole.at(10_000) is whole


def test_a_part_that_would_vanish_keeps_an_example_on_its_own_elements(make):
    example = make.beast(rounds=4)
    labels = example.labels.copy()
    labels[np.argmax(example.shape.points[:, 1])] = 3
    pieces = pieces_of(Example(example.shape, labels, example.names))
    assert pieces.counts()["tail"] == 1
    assert pieces.at(200) is pieces


def test_elements_without_a_label_are_in_no_piece():
    pieces = pieces_of(strip([0, -1, 0, 1, -1, -1], ("leg", "body")))
    assert pieces.labels.tolist() == [1, -1, 2, 0, -1, -1]
    assert pieces.kinds == ("body", "leg", "leg")
    assert [part.area for part in pieces.parts] == [1.0, 1.0, 1.0]
    assert len(pieces.segmentation.parts) == 4
    kinds = pieces.as_kinds()
    assert kinds.labels.tolist() == [1, -1, 1, 0, -1, -1]
    assert kinds.names == ("body", "leg")


def test_scraps_do_not_go_to_what_has_no_label():
    labels, widths = [0, 1, -1, 0, 1], [9, 0.01, 9, 9, 9]
    pieces = pieces_of(strip(labels, ("body", "leg"), widths=widths))
    assert pieces.labels.tolist() == [0, 0, -1, 1, 2]
    assert pieces.kinds == ("body", "body", "leg")
    # With nothing labelled beside it, a scrap goes to the nearest that is.
    labels, widths = [0, -1, 1, -1, 1], [9, 9, 0.01, 8, 9]
    pieces = pieces_of(strip(labels, ("body", "leg"), widths=widths))
    assert pieces.labels.tolist() == [0, -1, 1, -1, 1]
    assert pieces.kinds == ("body", "leg")


def test_without_unlabelled_elements_everything_is_as_if_there_could_be_none(make):
    whole = pieces_of(make.beast())
    assert len(whole.parts) == len(whole.segmentation.parts) == len(whole.kinds)
    assert whole.labels.min() == 0


def test_on_super_elements_what_is_mostly_without_a_label_has_none(make):
    beast = make.beast(rounds=4)
    missing = beast.shape.points[:, 2] > 0.5
    partly = Example(beast.shape, np.where(missing, -1, beast.labels), beast.names)
    coarse = pieces_of(partly).at(800)
    assert 500 < coarse.shape.n_elements <= 800
    again = coarse.labels[coarse.shape.members] < 0
    assert (again == missing).mean() > 0.95
