"""Fields: computed once on the user's shape, carried to all other versions, checked."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.discovery.lookup import FoundField
from moseg_core.components.field import field_sums, field_values, link_values
from moseg_core.components.profile import profiling
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError, PluginError, ShapeError
from moseg_core.language import Table
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from tests import shapes


class Heights:
    """A lookup that knows one field, the height times a factor, and counts its computations."""

    def __init__(self, function=None, requires=(), defaults=None):
        self.calls = []
        self.defaults = defaults or {}
        self.function = self.height if function is None else function
        self.requires = requires

    def height(self, shape, *, factor=1.0):
        self.calls.append((shape.n_elements, factor))
        return factor * shape.points[:, 2]

    def field(self, name):
        return FoundField(
            id="here:height",
            source="home",
            function=self.function,
            requires=self.requires,
            defaults=self.defaults,
        )


def capsule() -> Shape:
    return Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(9, 8), 3))


def test_a_field_is_computed_once_per_shape_and_parameters():
    shape, heights = capsule(), Heights()
    for _ in range(2):
        values = field_values(shape, "height", lookup=heights)
        assert values == pytest.approx(shape.points[:, 2])
        assert not values.flags.writeable
    twice = field_values(shape, "height", lookup=heights, factor=2.0)
    assert twice == pytest.approx(2 * shape.points[:, 2])
    assert heights.calls == [(shape.n_elements, 1.0), (shape.n_elements, 2.0)]
    field_values(capsule(), "height", lookup=heights)
    assert len(heights.calls) == 3


def test_a_parameter_that_is_said_may_be_its_default():
    shape, heights = capsule(), Heights(defaults={"factor": 1.0})
    for parameters in ({}, {"factor": 1.0}, {"factor": 1}):
        field_values(shape, "height", lookup=heights, **parameters)
        field_sums(shape, heights.field("height"), parameters)
    assert heights.calls == [(shape.n_elements, 1.0)]
    field_values(shape, "height", lookup=heights, factor=2.0)
    assert len(heights.calls) == 2


def test_fields_are_a_stage_of_their_own_in_a_profile():
    shape, heights = capsule(), Heights()
    with profiling() as profile:
        for _ in range(2):
            field_values(shape, "height", lookup=heights)
    assert [(name, entry.calls) for name, _, entry in profile.of("stage")] == [("fields", 1)]


def test_a_field_may_take_a_table_which_may_be_any_mapping():
    asked = []

    def scaled(shape, *, among):
        asked.append(among)
        return among["legs"]["factor"] * shape.points[:, 2]

    shape, heights = capsule(), Heights(scaled)
    tables = [{"legs": {"factor": 2.0}}, Table({"legs": {"factor": 2.0}})]
    for among in tables:
        values = field_values(shape, "height", lookup=heights, among=among)
        assert values == pytest.approx(2 * shape.points[:, 2])
    assert asked == [tables[1]]
    tripled = field_values(shape, "height", lookup=heights, among={"legs": {"factor": 3.0}})
    assert tripled == pytest.approx(3 * shape.points[:, 2])
    part = Segmentation.from_labels(shape, np.zeros(shape.n_elements, int), 1, lookup=heights)
    summary = part.parts[0].field("height", among=tables[1])
    assert summary.greatest == pytest.approx(2 * shape.points[:, 2].max())
    assert len(asked) == 2


def test_versions_of_a_shape_have_the_values_of_the_original():
    shape, heights = capsule(), Heights()
    flat = shape.deformed(shape.geometry.vertices * [1.0, 1.0, 0.5], space="flat")
    coarse, coarse_flat = coarsen(shape, 20), coarsen(flat, 20)
    on_fine = field_values(shape, "height", lookup=heights)
    assert (field_values(flat, "height", lookup=heights) == on_fine).all()
    for level in (coarse, coarse_flat):
        found = field_values(level, "height", lookup=heights)
        for k in range(level.n_elements):
            own = level.members == k
            mean = np.average(on_fine[own], weights=level.input.areas[own])
            assert found[k] == pytest.approx(mean)
    assert len(heights.calls) == 1


def test_elements_without_area_have_the_plain_mean():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 3], [4, 0, 3], [3, 0, 3]]
    shape = Shape.from_mesh(vertices, [[0, 1, 2], [3, 4, 5], [3, 5, 4]])
    from moseg_core.shape.coarse import grouped

    coarse = grouped(shape, np.array([0, 1, 1]), "coarse2")
    assert field_values(coarse, "height", lookup=Heights()).tolist() == [0.0, 3.0]
    found = Segmentation.from_labels(shape, [0, 0, 0], 1, lookup=Heights()).parts[0]
    assert found.field("height") == (0.0, 0.0, 0.0, 0.0)


@given(st.integers(0, 2**32), st.integers(1, 4))
@settings(max_examples=20, deadline=None)
def test_summaries_are_those_of_the_elements_on_every_level(seed, n):
    shape = capsule()
    coarse = coarsen(shape, 20)
    labels = np.random.default_rng(seed).integers(0, n, coarse.n_elements)
    labels[:n] = range(n)
    values = shape.points[:, 2]
    for level, of_level in ((coarse, labels), (shape, labels[coarse.members])):
        found = Segmentation.from_labels(level, of_level, n, lookup=Heights())
        for k, part in enumerate(found.parts):
            own = labels[coarse.members] == k
            mean = np.average(values[own], weights=shape.areas[own])
            spread = np.sqrt(np.average((values[own] - mean) ** 2, weights=shape.areas[own]))
            summary = part.field("height")
            assert summary == pytest.approx((mean, spread, values[own].min(), values[own].max()))
            assert found.fields("height")[k] == summary


def test_the_mean_over_the_shape_is_the_same_for_every_part_on_every_level():
    shape = capsule()
    mean = np.average(2 * shape.points[:, 2], weights=shape.areas)
    for level in (shape, coarsen(shape, 20)):
        labels = np.arange(level.n_elements) % 2
        parts = Segmentation.from_labels(level, labels, 3, lookup=Heights()).parts
        for part in parts:
            assert part.field_of_shape("height", factor=2.0) == pytest.approx(mean)


def test_the_spread_does_not_drown_in_a_large_mean():
    vertices, faces = shapes.rectangle(4.0, 1.0, 40, 2)
    heights = Heights(lambda shape: 1e9 + shape.points[:, 0])
    shape = Shape.from_mesh(vertices, faces)
    part = Segmentation.from_labels(shape, [0] * shape.n_elements, 1, lookup=heights).parts[0]
    assert part.field("height").spread == pytest.approx(4 / 12**0.5, rel=1e-3)


def test_a_part_without_area_has_no_field():
    shape = capsule()
    found = Segmentation.from_labels(shape, [0] * shape.n_elements, 2, lookup=Heights())
    with pytest.raises(MosegError, match="an empty part"):
        found.parts[1].field("height")
    assert np.isnan(found.fields("height")[1].mean)


def test_a_shape_that_lacks_what_a_field_requires_is_refused():
    cloud = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]], name="dots")
    with pytest.raises(ShapeError, match="field 'here:height' needs a surface, but 'dots' is"):
        field_values(cloud, "height", lookup=Heights(requires=("surface",)))


@pytest.mark.parametrize(
    "wrong",
    [
        lambda shape: shape.points[:-1, 2],
        lambda shape: np.where(np.arange(shape.n_elements) == 3, np.nan, 1.0),
        lambda shape: "high",
        lambda shape: shape.points,
    ],
)
def test_values_that_are_not_a_finite_number_for_each_element_are_refused(wrong):
    with pytest.raises(PluginError, match="field 'here:height' must return a finite number for"):
        field_values(capsule(), "height", lookup=Heights(wrong))


def test_sums_are_kept_with_the_level():
    shape, heights = capsule(), Heights()
    coarse = coarsen(shape, 20)
    found = heights.field("height")
    assert field_sums(coarse, found, {}) is field_sums(coarse, found, {})
    assert link_values(coarse, found, {}) is link_values(coarse, found, {})
    assert field_sums(coarse, found, {}) is not field_sums(coarse, found, {"factor": 2.0})


def test_the_values_along_links_are_the_mean_of_both_sides_times_the_length():
    shape = capsule()
    height = shape.points[:, 2]
    links = shape.links
    mean = (height[links.first] + height[links.second]) / 2
    along = link_values(shape, Heights().field("height"), {})
    assert along == pytest.approx(links.lengths * mean)
