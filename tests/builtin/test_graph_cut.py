"""Boundaries go into creases nearby, become short elsewhere, and break nothing."""

from __future__ import annotations

import itertools
import sys
import types

import numpy as np
import pytest

from moseg_core.builtin import graph_cut, swaps
from moseg_core.builtin.band import Band
from moseg_core.builtin.graph_cut import GraphCut, count_pieces
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import FieldSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, never_stop
from moseg_core.errors import PluginError, ShapeError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.shape.shape import Shape
from tests import shapes

AROUND = 24


@objective(range=(0, 1e9))
def area(part: Part) -> float:
    return part.area


@objective(mean_of=lambda given: ("made:unfit", given))
def fitting(part: Part, *, of: int) -> float:
    """How badly a label fits the places of a part, by a field of a test."""
    return part.field("made:unfit", of=of).mean


def lathe(xs, radii):
    """A surface of revolution about x: quads, AROUND in each ring, closed by fans at both ends."""
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    rings = [
        np.stack([np.full(AROUND, x), r * np.cos(angle), r * np.sin(angle)], 1)
        for x, r in zip(xs, radii, strict=True)
    ]
    vertices = np.concatenate([*rings, [[xs[0], 0, 0], [xs[-1], 0, 0]]])
    n = len(xs)
    faces = [
        (k * AROUND + a, k * AROUND + b, (k + 1) * AROUND + b, (k + 1) * AROUND + a)
        for k in range(n - 1)
        for a, b in ((a, (a + 1) % AROUND) for a in range(AROUND))
    ]
    faces += [(n * AROUND, (a + 1) % AROUND, a) for a in range(AROUND)]
    last = (n - 1) * AROUND
    faces += [(n * AROUND + 1, last + a, last + (a + 1) % AROUND) for a in range(AROUND)]
    return Shape.from_mesh(vertices, faces)


def dumbbell(rings=14):
    """Two spheres of radius 1 that meet in a crease at x = 0, of radius 0.6."""
    turn = np.linspace(0.15, np.pi - np.arccos(0.8), rings)
    x, r = -0.8 - np.cos(turn), np.sin(turn)
    return lathe(np.concatenate([x, -x[-2::-1]]), np.concatenate([r, r[-2::-1]]))


def with_fields(monkeypatch, **fields):
    """A registry in which a bundle 'made' has these functions as fields."""
    module = types.ModuleType("made_fields")
    for name, function in fields.items():
        setattr(module, name, function)
    monkeypatch.setitem(sys.modules, "made_fields", module)
    found = tuple(
        Component("made", "moseg-made 1.0", FieldSpec(name=name, target=f"made_fields:{name}"))
        for name in fields
    )
    return Registry(
        [*registry().bundles, Bundle("made", "moseg-made", "1.0", "made_fields", found)]
    )


def evaluator_on(shape, n=2, *, pins=NO_PINS, source=None, minimize="area(a)"):
    own = {"area": area, "fitting": fitting}
    problem = Problem(list("abcde"[:n]), minimize, objectives=own, registry=source)
    return ProblemEvaluator(shape, problem, Voronoi(shape, n), pins=pins)


def refined(
    shape,
    labels,
    n=2,
    *,
    pins=NO_PINS,
    source=None,
    minimize="area(a)",
    report=never_stop,
    **parameters,
):
    cut = GraphCut(**{"field": None, **parameters})
    evaluator = evaluator_on(shape, n, pins=pins, source=source, minimize=minimize)
    cut.check(evaluator)
    handed = np.array(labels, np.int32)
    handed.flags.writeable = False
    return cut(evaluator, handed, report=report)


# --- where boundaries go -------------------------------------------------------------------------


@pytest.mark.parametrize("off", [-0.22, -0.1, 0.1, 0.22])
def test_a_boundary_beside_the_neck_goes_into_it(off):
    shape = dumbbell()
    x, y, _ = shape.points.T
    neck = (x > 0).astype(np.int32)
    start = (x > off + 0.08 * y).astype(np.int32)  # askew too
    assert (start != neck).sum() > AROUND / 2
    assert (refined(shape, start, band=0.12) == neck).all()


def test_a_crease_is_preferred_to_the_narrower_place_beyond():
    """A ball on a cone that goes on narrowing: the crease between the two is where people cut."""
    turn = np.linspace(0.15, np.pi - np.arccos(0.8), 40)
    xs = np.linspace(0, 2, 41)[1:]
    shape = lathe(
        np.concatenate([-0.8 - np.cos(turn), xs]), np.concatenate([np.sin(turn), 0.6 - 0.2 * xs])
    )
    x = shape.points[:, 0]
    start = (x > 0.25).astype(np.int32)
    creased = refined(shape, start, field="basic:concavity", band=0.12)
    assert (creased != (x > 0)).sum() <= AROUND  # in the crease, give or take an element
    narrower = refined(shape, start, band=0.12, keep=0.01)  # by lengths alone
    assert x[narrower == 1].min() > 0.3


def test_a_boundary_out_of_reach_stays_on_its_side():
    shape = dumbbell()
    start = (shape.points[:, 0] > 1.0).astype(np.int32)
    found = refined(shape, start, band=0.05)
    moved = np.abs(shape.points[found != start, 0] - 1.0)
    assert moved.max(initial=0.0) < 0.06 * shape.frame.scale


def tube():
    """A tube along x from 0 to 6, on which no place is better than another."""
    return lathe(np.linspace(0, 6, 61), np.full(61, 0.5))


def test_a_crease_is_where_the_field_is_great(monkeypatch):
    shape = tube()
    x = shape.points[:, 0]
    start = (x > 3).astype(np.int32)

    def crease(shape):
        return (np.abs(shape.points[:, 0] - 3.3) < 0.1).astype(float)

    def ridge(shape):
        return -3.0 * (np.abs(shape.points[:, 0] - 3.0) < 0.1)

    source = with_fields(monkeypatch, crease=crease, ridge=ridge)
    options = {"source": source, "band": 0.1, "crease": 1.0}
    into = refined(shape, start, field="made:crease", keep=0.1, **options)
    assert (into == (x > 3.3)).all()
    # A boundary on a ridge goes off it, by two rings: half of the first one's links is on it too.
    off = refined(shape, start, field="made:ridge", keep=0.1, **options)
    gone = np.abs(shape.points[off != start, 0] - 3)
    assert (off != start).sum() == 2 * AROUND
    assert gone.max() < 0.2
    # Dear to move, it stays; and where creases do not count.
    options["field"] = "made:crease"
    assert (refined(shape, start, keep=1e4, **options) == start).all()
    assert (refined(shape, start, keep=0.1, **(options | {"crease": 0.0})) == start).all()


def test_on_a_smooth_surface_a_boundary_becomes_short_and_does_not_wander():
    shape = tube()
    x, y, _ = shape.points.T
    start = (x > 3 + 0.3 * np.sign(y)).astype(np.int32)
    found = refined(shape, start, band=0.1, keep=0.1)
    ring = shape.points[found == 1, 0].min()
    assert (found == (x >= ring - 1e-9)).all()
    assert 2.7 <= ring <= 3.4
    straight = (x > 3).astype(np.int32)
    assert (refined(shape, straight, band=0.1, keep=0.1) == straight).all()


@pytest.mark.parametrize("data", [0.0, 2.0])
def test_on_few_elements_the_labelling_is_the_best_of_all(monkeypatch, data):
    vertices, faces = shapes.rectangle(4, 3, 4, 3)
    shape = Shape.from_mesh(
        vertices + np.random.default_rng(1).normal(0, 0.15, vertices.shape), faces
    )
    labels = np.array([0, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0, 1], np.int32)
    links, scale = shape.links, shape.frame.scale
    band = 0.5
    unfit = np.random.default_rng(2).normal(0, 1, (2, 12))  # below 0 too
    source = with_fields(monkeypatch, unfit=lambda shape, *, of: unfit[of])
    minimize = "fitting(a, of=0) - 0.5*fitting(b, of=1)"
    found = refined(
        *(shape, labels), source=source, minimize=minimize, band=band, keep=0.5, data=data
    )

    near = Band.of(shape, labels, 2, width=band, pins=NO_PINS)
    distances = np.full((12, 2), np.inf)
    distances[np.arange(12), labels] = 0.0
    distances[near.elements] = near.distances

    def cost(tried):
        cut = sum(
            length / scale
            for i, j, length in zip(links.first, links.second, links.lengths, strict=True)
            if tried[i] != tried[j]
        )
        kept = sum(
            0.5 * shape.areas[k] / scale**2 * distances[k, tried[k]] / band
            for k in range(12)
            if tried[k] != labels[k]
        )
        told = sum(
            data * shape.areas[k] / scale**2 * ([1, -0.5][tried[k]] * unfit[tried[k]][k])
            for k in range(12)
        )
        return cut + kept + told

    ways = [[k for k in (0, 1) if np.isfinite(d[k])] for d in distances]
    assert sum(len(way) == 2 for way in ways) >= 5
    best = min((np.array(tried) for tried in itertools.product(*ways)), key=cost)
    assert cost(best) < cost(labels)
    assert cost(found) == pytest.approx(cost(best))


# --- what the problem says of places -------------------------------------------------------------


def strip(monkeypatch, edge):
    """A strip of 20 by 3 squares, and fields that say that a is before an edge and b behind it."""
    shape = Shape.from_mesh(*shapes.rectangle(20, 3, 20, 3))
    behind = shape.points[:, 0] > edge

    def unfit(shape, *, of):
        return (behind if of == 0 else ~behind).astype(float)

    return shape, with_fields(monkeypatch, unfit=unfit)


BOTH = "fitting(a, of=0) + fitting(b, of=1)"


def test_a_boundary_goes_where_the_problem_says_that_one_label_ends(monkeypatch):
    shape, source = strip(monkeypatch, 7)
    x = shape.points[:, 0]
    start = (x > 10).astype(np.int32)
    options = {"source": source, "minimize": BOTH, "band": 0.2}
    assert (refined(shape, start, data=30.0, **options) == (x > 7)).all()
    # No further than the band, and only as far as it is worth it to move.
    assert (refined(shape, start, data=30.0, **(options | {"band": 0.11})) == (x > 8)).all()
    # To move column k costs 2 (k + 0.5) / 20.2 / 0.2 for its area: 0.25, 0.74, 1.24.
    for data, edge in ((0.2, 10), (0.3, 9), (1.0, 8), (1.3, 7)):
        assert (refined(shape, start, data=data, **options) == (x > edge)).all()
    twice = options | {"minimize": "2*fitting(a, of=0) + 2*fitting(b, of=1)"}
    assert (refined(shape, start, data=0.5, **twice) == (x > 8)).all()


def test_the_other_way_round_it_goes_away_from_there(monkeypatch):
    shape, source = strip(monkeypatch, 9)
    x = shape.points[:, 0]
    start = (x > 8).astype(np.int32)
    given = {"source": source, "band": 0.1, "data": 30.0}
    assert (refined(shape, start, minimize=BOTH, **given) == (x > 9)).all()
    wrong = "fitting(a, of=1) + fitting(b, of=0)"
    assert (refined(shape, start, minimize=wrong, **given) == (x > 6)).all()


def test_without_data_nothing_that_the_problem_says_counts(monkeypatch):
    shape, source = strip(monkeypatch, 7)
    askew = (shape.points @ [1, 0.8, 0] > 11).astype(np.int32)
    options = {"source": source, "band": 0.2, "keep": 0.5}
    plain = refined(shape, askew, **options)
    assert (plain != askew).any()
    assert (refined(shape, askew, minimize=BOTH, **options) == plain).all()
    assert (refined(shape, askew, data=30.0, **options) == plain).all()  # area is no such mean
    assert ("field", "made:unfit") not in {key[:2] for key in shape.made_from}
    said = GraphCut(field=None, data=3.0).check(evaluator_on(shape, source=source))
    assert said.startswith("refiner 'graph_cut' has no data to go by: no term of the problem is")
    asked = evaluator_on(shape, source=source, minimize=BOTH)
    assert GraphCut(field=None, data=3.0).check(asked) == ""
    assert GraphCut(field=None).check(evaluator_on(shape, source=source)) == ""


def test_a_field_that_a_shape_cannot_have_is_known_before_the_search(monkeypatch):
    shape = tube()
    broken = with_fields(monkeypatch, unfit=lambda shape, *, of: np.full(3, of))
    asked = evaluator_on(shape, source=broken, minimize=BOTH)
    with pytest.raises(PluginError, match="field 'made:unfit' must return a finite number"):
        GraphCut(field=None, data=1.0).check(asked)
    assert GraphCut(field=None).check(asked) == ""


def test_places_count_on_solids_clouds_and_embedded_shapes_too(monkeypatch):
    def unfit(shape, *, of):
        return np.abs((shape.points[:, 0] > 4) - float(of))

    options = {"source": with_fields(monkeypatch, unfit=unfit), "minimize": BOTH, "band": 0.3}
    block = Shape.from_voxels(np.ones((12, 2, 2), bool))
    grid = np.stack(np.meshgrid(np.arange(12.0) + 0.5, np.arange(3.0), [0.0]), -1).reshape(-1, 3)
    sheet = Shape.from_mesh(*shapes.rectangle(12, 3, 12, 3))
    bent = sheet.deformed(sheet.geometry.vertices * [1.0, 3.0, 1.0], space="bent")
    for shape in (block, Shape.from_points(grid, adjacency="knn"), bent):
        x = shape.points[:, 0]
        start = (x > 6).astype(np.int32)
        assert (refined(shape, start, data=100.0, **options) == (x > 4)).all(), shape.noun


# --- which pairs have a turn ---------------------------------------------------------------------


def with_every_turn(shape, labels, n, *, width):
    """The same with a turn of every pair in every sweep."""
    evaluator, cut = evaluator_on(shape, n), GraphCut(field=None, band=width)
    band = Band.of(shape, labels, n, width=width, pins=NO_PINS)
    energy = swaps.Energy(
        costs=cut._costs(evaluator, shape, band),
        first=band.first,
        second=band.second,
        weights=cut._weights(evaluator)[0][band.links],
    )
    most = count_pieces(shape.links, labels, n)

    def unbroken(after):
        return bool((count_pieces(shape.links, after, n) <= most).all())

    for _ in range(10):
        before = labels
        for pair in energy.touching(labels[band.elements]):
            labels, _ = graph_cut._swapped(labels, band.elements, energy, pair, unbroken)
        if (labels == before).all():
            return labels
    return labels


@pytest.mark.parametrize("seed", range(6))
def test_what_is_left_out_would_change_nothing(monkeypatch, seed):
    """Pairs whose labels have not changed since."""
    shape = Shape.from_mesh(*shapes.jitter(shapes.sphere(3), 3, 0.01))
    rng, n = np.random.default_rng(seed), 7
    partition = Voronoi(shape, n)
    centers = shape.points[rng.choice(shape.n_elements, n, replace=False)]
    vector = partition.encode(Centers(positions=centers, weights=rng.uniform(0.5, 1.5, n)))
    labels = partition.labels(vector[None])[0]
    minimum_cut, cuts = swaps._cut, []

    def counted(*arguments):
        cuts.append(len(arguments[0]))
        return minimum_cut(*arguments)

    monkeypatch.setattr(swaps, "_cut", counted)
    found = refined(shape, labels, n, band=0.3)
    done = len(cuts)
    assert (found == with_every_turn(shape, labels, n, width=0.3)).all()
    assert (found != labels).any()
    assert 0 < done < len(cuts) - done


# --- by way of groups ----------------------------------------------------------------------------


def by_way_of_groups(monkeypatch, shape, labels, n=2, **options):
    """The same in one step, and by way of so few groups that each has a dozen elements."""
    whole = refined(shape, labels, n, **options)
    monkeypatch.setattr(graph_cut, "_MANY", 100)
    monkeypatch.setattr(graph_cut, "_GROUPS", shape.n_elements // 12)
    return whole, refined(shape, labels, n, **options)


@pytest.mark.parametrize("off", [-0.22, 0.22])
def test_a_large_band_is_cut_in_the_same_crease(monkeypatch, off):
    shape = dumbbell(40)
    x, y, _ = shape.points.T
    start = (x > off + 0.08 * y).astype(np.int32)
    whole, found = by_way_of_groups(monkeypatch, shape, start, band=0.12)
    assert (whole == (x > 0)).all()
    assert (found == whole).all()


def test_a_cut_by_way_of_groups_is_hardly_dearer_and_breaks_nothing(monkeypatch):
    shape = Shape.from_mesh(*shapes.jitter(shapes.sphere(4), 3, 0.01))
    n, width = 5, 0.3
    weights = GraphCut(field=None, band=width)._weights(evaluator_on(shape, n))[0]
    dearer = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        partition = Voronoi(shape, n)
        centers = shape.points[rng.choice(shape.n_elements, n, replace=False)]
        vector = partition.encode(Centers(positions=centers, weights=rng.uniform(0.5, 1.5, n)))
        labels = partition.labels(vector[None])[0]
        pinned = np.sort(rng.choice(shape.n_elements, 9, replace=False))
        pins = Pins(elements=pinned, labels=labels[pinned].astype(np.int64))
        band = Band.of(shape, labels, n, width=width, pins=pins)
        cut = GraphCut(field=None, band=width)
        energy = swaps.Energy(
            costs=cut._costs(evaluator_on(shape, n), shape, band),
            first=band.first,
            second=band.second,
            weights=weights[band.links],
        )
        with monkeypatch.context() as patch:
            found = by_way_of_groups(patch, shape, labels, n, band=width, pins=pins)
        start, whole, grouped = (
            energy.of(each[band.elements].astype(np.int64)) for each in (labels, *found)
        )
        assert grouped < start
        dearer.append((grouped - whole) / (start - whole))
        assert (found[1][pinned] == labels[pinned]).all()
        assert (count_pieces(shape.links, found[1], n) == 1).all()
    assert np.mean(dearer) < 0.1


def test_told_to_end_it_does_so_after_the_groups(monkeypatch):
    shape = dumbbell(40)
    x, y, _ = shape.points.T
    start = (x > 0.1 + 0.08 * y).astype(np.int32)
    monkeypatch.setattr(graph_cut, "_MANY", 100)
    monkeypatch.setattr(graph_cut, "_GROUPS", shape.n_elements // 12)
    reports = []
    found = refined(shape, start, band=0.12, report=lambda p: bool(reports.append(p)) or True)
    assert [progress.stage for progress in reports] == ["graph_cut"]
    assert (found != start).any()


# --- what does not break -------------------------------------------------------------------------


def test_no_part_is_lost_or_broken_and_pins_hold():
    shape = Shape.from_mesh(*shapes.jitter(shapes.sphere(3), 3, 0.01))
    rng = np.random.default_rng(0)
    for seed in range(4):
        partition = Voronoi(shape, 5)
        centers = shape.points[rng.choice(shape.n_elements, 5, replace=False)]
        vector = partition.encode(Centers(positions=centers, weights=rng.uniform(0.5, 1.5, 5)))
        labels = partition.labels(vector[None])[0]
        free = refined(shape, labels, 5, band=0.2)
        moved = np.flatnonzero(free != labels)
        assert len(moved) > 20
        pinned = np.sort(rng.choice(moved, 3, replace=False))
        pins = Pins(elements=pinned, labels=labels[pinned].astype(np.int64))
        found = refined(shape, labels, 5, band=0.2, pins=pins)
        assert (found[pinned] == labels[pinned]).all()
        for each in (free, found):
            assert set(each.tolist()) == set(labels.tolist())
            assert (count_pieces(shape.links, each, 5) == 1).all(), seed


def test_a_thin_part_is_not_cut_through():
    """A bridge of one part between two others is cheap to cut, and stays in one piece."""
    shape = Shape.from_mesh(*shapes.rectangle(10, 9, 10, 9))
    x, y, _ = shape.points.T
    bridge = np.abs(y - 4.5) < 1
    labels = np.where(bridge | (x < 2) | (x > 8), 0, np.where(y < 4.5, 1, 2)).astype(np.int32)
    found = refined(shape, labels, 3, band=0.2, keep=0.0)
    assert (count_pieces(shape.links, found, 3) == 1).all()


def test_a_part_of_several_pieces_may_keep_them():
    shape = tube()
    x = shape.points[:, 0]
    labels = ((x > 1) & (x < 2) | (x > 4)).astype(np.int32)
    found = refined(shape, labels, band=0.02)
    assert count_pieces(shape.links, found, 2).tolist() == [2, 2]


def test_it_ends_when_it_is_told_after_one_time_through():
    shape = dumbbell()
    x, y, _ = shape.points.T
    start = (x > 0.1 + 0.08 * y).astype(np.int32)
    reports = []
    found = refined(shape, start, band=0.12, report=lambda p: bool(reports.append(p)) or True)
    assert [progress.stage for progress in reports] == ["graph_cut"]
    assert (found != start).any()


# --- other shapes, and what is missing -----------------------------------------------------------


def test_an_embedded_shape_is_refined_as_the_user_gave_it():
    shape = dumbbell()
    x = shape.points[:, 0]
    bent = shape.deformed(shape.geometry.vertices * [1.0, 5.0, 0.2], space="bent")
    start = (x > 0.2).astype(np.int32)
    assert (refined(bent, start, band=0.12) == refined(shape, start, band=0.12)).all()


def test_cells_of_a_solid_and_points_with_neighbours_have_boundaries_too():
    occupied = np.zeros((12, 5, 5), bool)
    occupied[:5], occupied[7:], occupied[5:7, 2, 2] = True, True, True
    block = Shape.from_voxels(occupied)
    start = (block.points[:, 0] > 4.3).astype(np.int32)
    found = refined(block, start, band=0.2)
    assert (found != start).any()
    assert set(block.points[found != start, 0].round(1)) <= {4.5, 5.5}
    grid = np.stack(np.meshgrid(np.arange(12.0), np.arange(6.0), [0.0]), -1).reshape(-1, 3)
    cloud = Shape.from_points(grid, adjacency="knn")
    start = (grid[:, 0] > 5 + (grid[:, 1] == 3)).astype(np.int32)
    found = refined(cloud, start, band=0.2, keep=3.0)
    assert (found == (grid[:, 0] > 5)).all()


def test_what_is_missing_is_told_with_what_to_do():
    cloud = Shape.from_points(np.random.default_rng(0).normal(size=(30, 3)))
    with pytest.raises(ShapeError, match=r"which elements touch; take the nearest"):
        refined(cloud, np.arange(30) % 2)
    bare = Registry([bundle for bundle in registry().bundles if bundle.name == "core"])
    with pytest.raises(UsageError) as caught:
        refined(dumbbell(), np.zeros(10), field="basic:concavity", source=bare)
    said = str(caught.value)
    assert said.startswith("refiner 'graph_cut' goes by the field 'basic:concavity': unknown field")
    assert "graph_cut(field=none)" in said


def test_by_default_it_goes_along_creases_where_that_field_is_to_be_had():
    shape = dumbbell()
    start = (shape.points[:, 0] > 0.22 + 0.08 * shape.points[:, 1]).astype(np.int32)
    creased = refined(shape, start, field="basic:concavity")
    assert (refined(shape, start, field="auto") == creased).all()
    assert GraphCut().check(evaluator_on(shape)) == ""
    bare = Registry([bundle for bundle in registry().bundles if bundle.name == "core"])
    alone = refined(shape, start)
    assert (alone != creased).any()
    assert (refined(shape, start, field="auto", source=bare) == alone).all()
    said = GraphCut().check(evaluator_on(shape, source=bare))
    assert said.startswith("refiner 'graph_cut' goes by lengths alone, not along creases: unknown")
    block = Shape.from_voxels(np.ones((4, 2, 2), bool))
    said = GraphCut().check(evaluator_on(block))
    assert "not along creases: field 'basic:concavity' needs a surface" in said
    assert said.endswith("with graph_cut(field=none) or read the surface alone (--voxels surface)")
    with pytest.raises(ShapeError, match=r"field=none\) or read the surface alone \(--vox.*\)$"):
        GraphCut(field="basic:concavity").check(evaluator_on(block))
    assert GraphCut(field=None).check(evaluator_on(block, source=bare)) == ""


def test_a_band_of_no_width_moves_nothing():
    shape = dumbbell()
    start = (shape.points[:, 0] > 0.2).astype(np.int32)
    assert (refined(shape, start, band=0.0) == start).all()
    assert (refined(shape, np.zeros_like(start), 1) == 0).all()
