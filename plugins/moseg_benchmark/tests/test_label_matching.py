"""Names of parts put beside the labels of a recipe."""

import numpy as np
import pytest
from moseg_benchmark.label_matching import (
    Naming,
    fitting_set,
    labels_by_overlap,
    labels_of_names,
    piece_counts,
)

from moseg_core import Labelling, Shape, UsageError

# A strip of six squares in a row.
STRIP = Shape.from_mesh(
    [[x, y, 0.0] for x in range(7) for y in (0.0, 1.0)],
    [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(6)],
)


def named(text):
    names = tuple(sorted(set(text.split())))
    return Labelling(labels=np.array([names.index(word) for word in text.split()]), names=names)


def labels(text, recipe, naming=Naming()):  # noqa: B008  # frozen
    return labels_of_names(STRIP, named(text), recipe, naming).tolist()


def test_single_labels_go_by_name():
    assert labels("b b a a b b", ["a", "b"]) == [1, 1, 0, 0, 1, 1]


def test_instances_go_to_pieces_by_size():
    assert labels("leg body leg leg body body", ["body", "leg1", "leg2"]) == [2, 0, 1, 1, 0, 0]


def test_further_pieces_go_to_the_nearest_of_the_main_ones():
    assert labels("leg leg b leg b leg", ["b", "leg1"]) == [1, 1, 0, 1, 0, 1]
    # Squares 4 and 5 are one piece, 0 the first of two of equal size, 2 nearer to 0 than to them.
    assert labels("leg b leg b leg leg", ["b", "leg1", "leg2"]) == [2, 0, 2, 0, 1, 1]


def test_fewer_pieces_leave_labels_unused():
    assert labels("leg leg b b b b", ["b", "leg1", "leg2"]) == [1, 1, 0, 0, 0, 0]


def test_names_that_are_labels_go_to_these():
    assert labels("leg2 leg2 leg1 b b b", ["b", "leg1", "leg2"]) == [2, 2, 1, 0, 0, 0]


def test_what_is_numbered_is_not_one_piece_though_it_touches():
    assert labels("leg7 leg7 leg3 b b b", ["b", "leg1", "leg2"]) == [1, 1, 2, 0, 0, 0]
    text = "leg7 leg7 leg3 leg3 b b"
    assert fitting_set(STRIP, named(text), [["b", "leg1"], ["b", "leg1", "leg2"]], Naming()) == 1
    assert piece_counts(STRIP, named(text)) == {"b": 1, "leg": 2}
    assert piece_counts(STRIP, named("leg b leg b tail b")) == {"b": 3, "leg": 2, "tail": 1}


def test_names_can_be_merged():
    naming = Naming({"torso": ("body",), "tail": ("torso", "body")})
    assert labels("head torso torso torso tail tail", ["head", "body"], naming) == [
        0,
        1,
        1,
        1,
        1,
        1,
    ]


def test_a_name_belongs_to_the_first_kind_that_the_recipe_has():
    naming = Naming({"tail": ("torso", "body"), "neck": ("head",)})
    assert naming.kind("tail", ["body", "head"]) == "body"
    assert naming.kind("tail", ["body", "torso1", "head"]) == "torso"
    assert naming.kind("tail", ["body", "torso", "tail2"]) == "tail"
    with pytest.raises(UsageError, match="no label for 'neck': unknown label 'neck'"):
        naming.kind("neck", ["body"])


def test_a_name_without_a_label_is_refused():
    with pytest.raises(UsageError, match="no label for 'wing': unknown label 'wing'"):
        labels("wing b b b b b", ["b", "ring"])


@pytest.mark.parametrize(
    ("text", "best"),
    [
        ("leg b b leg b b", 1),
        ("leg b b b b b", 0),
        ("leg b leg b leg b", 2),
        ("leg b leg b tail b", 3),
        ("leg b b b tail b", 3),  # labels too many are better than a tail that is body
    ],
)
def test_the_label_set_that_has_as_many_of_each_kind(text, best):
    sets = [["b", *(f"leg{k + 1}" for k in range(n))] for n in (1, 2, 3)]
    sets.append(["b", "leg1", "leg2", "tail"])
    naming = Naming({"tail": ("b",)})
    # The body of a strip is in pieces too, of which every set has as many too few.
    assert fitting_set(STRIP, named(text), sets, naming) == best


def test_names_that_go_by_another_are_counted_too():
    sets = [["b", *(f"arm{k + 1}" for k in range(n))] for n in (1, 2, 3)]
    naming = Naming({"leg": ("arm",)})
    assert fitting_set(STRIP, named("leg b b leg b b"), sets, naming) == 1


def test_specks_are_no_pieces():
    many = Shape.from_mesh(
        [[x, y, 0.0] for x in range(1002) for y in (0.0, 1.0)],
        [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(1001)],
    )
    text = " ".join(["leg"] * 400 + ["b"] * 500 + ["leg"] + ["b"] * 100)
    assert fitting_set(many, named(text), [["b", "leg1", "leg2"], ["b", "leg1"]], Naming()) == 1


def test_a_name_that_no_label_set_has_a_label_for():
    with pytest.raises(UsageError, match="no label for 'wing'"):
        fitting_set(STRIP, named("wing b b b b b"), [["b"], ["b", "leg1"]], Naming())


def test_parts_without_names_take_those_of_most_of_their_area():
    areas = np.array([1.0, 1.0, 5.0, 1.0])
    assert labels_by_overlap(np.array([3, 3, 3, 9]), np.array([0, 0, 1, 0]), areas).tolist() == [
        1,
        1,
        1,
        0,
    ]


def test_what_has_no_name_gets_no_label():
    partly = named("leg body leg leg body body")
    partly.labels[[1, 5]] = -1
    found = labels_of_names(STRIP, partly, ["body", "leg1", "leg2"], Naming())
    assert found.tolist() == [2, -1, 1, 1, 0, -1]
    assert piece_counts(STRIP, partly) == {"body": 1, "leg": 2}
    assert fitting_set(STRIP, partly, [["body", "leg1"], ["body", "leg1", "leg2"]], Naming()) == 1
