"""The tables that the parts of one labelling share are made once, and belong to it."""

from __future__ import annotations

import pytest

from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError
from moseg_core.shape import boundary_sums, part_sums
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.components.test_field import Heights


def cut_cube() -> Segmentation:
    shape = Shape.from_mesh(*shapes.cube())
    return Segmentation.from_labels(shape, [0, 0, 1, 1, 2, 2], 3, lookup=Heights())


@pytest.fixture
def passes(monkeypatch):
    """How often the kernels ran."""
    counted = []
    for module, name in ((part_sums, "summarize_field"), (boundary_sums, "sum_boundaries")):
        kernel = getattr(module, name)

        def counting(*arguments, kernel=kernel, name=name):
            counted.append(name)
            kernel(*arguments)

        monkeypatch.setattr(module, name, counting)
    return counted


def test_one_pass_for_all_parts(passes):
    found = cut_cube()
    for part in found.parts:
        part.field("height")
        assert part.boundary.length > 0
        part.boundary.mean("height")
    found.fields("height")
    found.boundaries.means("height")
    found.parts[0].boundary_with(found.parts[2]).mean("height")
    assert passes == ["summarize_field", "sum_boundaries", "sum_boundaries"]
    found.parts[0].field("height", factor=2.0)
    assert passes.count("summarize_field") == 2


def test_a_pass_is_about_the_parts_made_so_far_and_the_second_about_all_others(passes):
    found, all_at_once = cut_cube(), cut_cube()
    expected = [part.field("height") for part in all_at_once.parts]
    scales = [part.scales.tolist() for part in all_at_once.parts]
    passes.clear()
    found.part(2), found.part(0)
    assert (found.part(2).field("height"), passes) == (expected[2], ["summarize_field"])
    assert (found.part(0).field("height"), len(passes)) == (expected[0], 1)
    assert found.part(0).scales.tolist() == scales[0]
    assert (found.part(1).field("height"), len(passes)) == (expected[1], 2)
    assert found.part(1).scales.tolist() == scales[1]


def test_passes_are_two_at_most_though_parts_are_made_one_by_one(passes):
    found = Segmentation.from_labels(Shape.from_mesh(*shapes.cube()), range(6), 6, lookup=Heights())
    for k in (3, 0, 5, 1, 2, 4):
        found.part(k).field("height")
    assert passes == ["summarize_field"] * 2


def test_exchanged_labels_have_tables_of_their_own():
    found = cut_cube()
    turned = found.permuted([2, 0, 1])
    for j, k in enumerate([2, 0, 1]):
        assert turned.parts[j].field("height") == found.parts[k].field("height")
        assert turned.parts[j].boundary.length == found.parts[k].boundary.length
    assert turned.boundaries.lengths[0, 1] == found.boundaries.lengths[2, 0]


def test_parts_of_two_segmentations_have_no_boundary_with_each_other():
    with pytest.raises(MosegError, match="parts of two segmentations"):
        cut_cube().parts[0].boundary_with(cut_cube().parts[1])
    with pytest.raises(MosegError, match="two segmentations"):
        cut_cube().parts[0].boundary_lengths([cut_cube().parts[1]])
    with pytest.raises(MosegError, match="parts of two segmentations"):
        cut_cube().parts[0].distance_to(cut_cube().parts[1])
