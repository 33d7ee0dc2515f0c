"""Algorithm 2 against its literal version, and the cases that it is silent about."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.kmeans import KMeans, drawn_points, furthest_points
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, Seeder
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import references, shapes

MESHES = {
    "capsule": shapes.bent_capsule(9, 6),
    "tee": shapes.tee(),
    "sphere": shapes.sphere(2),
    "two boxes": shapes.two_boxes(),
    "disc": shapes.disc(12),
    "soup": shapes.soup(5, 25),
}


@objective(range=(0, 1))
def nothing(part: Part) -> float:
    return 0.0


def run(shape, n, *, parameterization=None, reports=None, seed=0, **parameters):
    problem = Problem([f"p{k}" for k in range(n)], "nothing(p0)", objectives={"nothing": nothing})
    evaluator = ProblemEvaluator(shape, problem, parameterization or Voronoi(shape, n))
    report = (lambda progress: None) if reports is None else reports.append
    return KMeans(**parameters)(evaluator, rng=np.random.default_rng(seed), report=report)


def literal(mesh, shape, n, *, connected=True, rounds=100):
    points = shape.points.tolist()
    neighbors = references.edge_neighbors(*mesh)

    def classify(centers):
        if connected:
            return references.connected_partition(points, neighbors, centers, [1.0] * n)
        return references.voronoi_partition(points, centers, [1.0] * n)

    return references.kmeans(points, shape.areas.tolist(), n, classify, rounds)


def labels_of(shape, seeding, *, connected=True):
    n = len(seeding.centers)
    voronoi = Voronoi(shape, n, connected=connected)
    vector = voronoi.encode(Centers(positions=seeding.centers, weights=np.ones(n)))
    return voronoi.labels(vector[None])[0].tolist()


def test_it_answers_the_protocol():
    assert isinstance(KMeans(), Seeder)


@pytest.mark.parametrize("name", MESHES)
@given(seed=st.integers(0, 2**32), n=st.integers(1, 6), connected=st.booleans())
@settings(max_examples=8, deadline=None)
def test_centres_and_labels_are_those_of_algorithm_2(name, seed, n, connected):
    # Jittered, so that no two distances are equal and rounding decides nothing.
    mesh = shapes.jitter(MESHES[name], seed, 0.08)
    shape = Shape.from_mesh(*mesh)
    found = run(shape, n, parameterization=Voronoi(shape, n, connected=connected))
    centers, labels, rounds = literal(mesh, shape, n, connected=connected)
    assert found.centers == pytest.approx(np.array(centers), abs=1e-12 * shape.frame.scale)
    assert labels_of(shape, found, connected=connected) == labels
    assert len(found.history) == rounds


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_a_fixed_number_of_rounds(n):
    mesh = shapes.jitter(MESHES["capsule"], 8)
    shape = Shape.from_mesh(*mesh)
    found = run(shape, n, rounds=2)
    centers, _, rounds = literal(mesh, shape, n, rounds=2)
    assert found.centers == pytest.approx(np.array(centers), abs=1e-12 * shape.frame.scale)
    assert len(found.history) == rounds <= 2


@given(st.integers(0, 2**32), st.integers(1, 25), st.integers(1, 9))
@settings(max_examples=80, deadline=None)
def test_the_furthest_points(seed, size, n):
    points = np.random.default_rng(seed).integers(0, 4, (size, 3)).astype(np.float64)
    chosen = [points[f].tolist() for f in references.farthest_pair(points.tolist())][:n]
    while len(chosen) < n:
        chosen.append(points[references.furthest_element(points.tolist(), chosen)].tolist())
    assert furthest_points(points, n).tolist() == chosen


def test_one_centre_is_the_centroid_of_all():
    shape = Shape.from_mesh(*shapes.tee())
    found = run(shape, 1)
    centroid = (shape.areas[:, None] * shape.points).sum(axis=0) / shape.area
    assert found.centers[0] == pytest.approx(centroid, rel=1e-12)


def test_as_many_centres_as_elements_are_the_elements():
    shape = Shape.from_mesh(*shapes.jitter(shapes.prism(5), 2))
    found = run(shape, shape.n_elements)
    order = np.lexsort(found.centers.T)
    expected = shape.points[np.lexsort(shape.points.T)]
    assert found.centers[order] == pytest.approx(expected, abs=1e-12)
    assert sorted(labels_of(shape, found)) == list(range(shape.n_elements))


def test_centres_are_centroids_weighted_by_area():
    # Two squares side by side, and a long face beyond: with equal weights the mean would differ.
    vertices = [[x, y, 0.0] for x in (0, 1, 2, 6) for y in (0, 1)]
    faces = [(0, 2, 3, 1), (2, 4, 5, 3), (4, 6, 7, 5)]
    found = run(Shape.from_mesh(vertices, faces), 1)
    assert found.centers[0] == pytest.approx([3.0, 0.5, 0.0])


class Script:
    """A parameterization that classifies as it is told, round by round, and remembers what for."""

    def __init__(self, shape, n, rounds):
        self.voronoi, self.n_parts = Voronoi(shape, n), n
        self.lower, self.upper, self.scale = (
            getattr(self.voronoi, name) for name in ("lower", "upper", "scale")
        )
        self.rounds, self.asked = list(rounds), []

    def encode(self, centers):
        return self.voronoi.encode(centers)

    def labels(self, vectors):
        self.asked.append(self.voronoi.decode(vectors[0]).positions)
        return np.array(self.rounds[len(self.asked) - 1 : len(self.asked)], np.int32)


def test_an_empty_segment_starts_again_furthest_from_the_others():
    shape = Shape.from_mesh(*shapes.strip(8))
    # Segments 0 and 2 are empty at first; the centroids of 1 and 3 are at x = 1.5 and 5.5.
    first = [1, 1, 1, 3, 3, 3, 3, 3]
    script = Script(shape, 4, [first, [0, 1, 1, 1, 2, 3, 3, 3], [0, 1, 1, 1, 2, 3, 3, 3]])
    run(shape, 4, parameterization=script)
    assert len(script.asked) == 3
    # Of 0.5 .. 7.5, 3.5 and 7.5 are furthest from 1.5 and 5.5, and the first is taken; then 7.5.
    assert script.asked[1][:, 0] == pytest.approx([3.5, 1.5, 7.5, 5.5])
    points, areas = shape.points.tolist(), shape.areas.tolist()
    centers, _, _ = references.kmeans(points, areas, 4, lambda centers: first)
    assert script.asked[1] == pytest.approx(np.array(centers))


def test_a_segment_without_area_starts_again_like_an_empty_one():
    vertices, faces = shapes.strip(4)
    shape = Shape.from_mesh(vertices, [*faces, (0, 0, 1)])
    script = Script(shape, 2, [[0, 0, 0, 0, 1], [1, 0, 0, 0, 0], [1, 0, 0, 0, 0]])
    found = run(shape, 2, parameterization=script)
    assert script.asked[1][:, 0] == pytest.approx([2.0, 1 / 3])
    assert np.isfinite(found.centers).all()


def test_the_rounds_stop_when_a_classification_comes_back():
    shape = Shape.from_mesh(*shapes.strip(6))
    cycle = [[0, 0, 1, 1, 1, 1], [0, 0, 0, 1, 1, 1], [0, 0, 0, 0, 1, 1]]
    script = Script(shape, 2, list(itertools.islice(itertools.cycle(cycle), 50)))
    found = run(shape, 2, parameterization=script)
    assert len(script.asked) == 4
    assert len(found.history) == 3
    assert found.centers[:, 0] == pytest.approx([2.0, 5.0])  # the centroids of the third


def test_a_cycle_that_the_flood_itself_makes_ends():
    # A crumpled strip of ten triangles on which the classification never settles.
    corners = [(9, 1), (3, 4), (4, 5), (7, 5), (7, 3), (1, 4)]
    corners += [(2, 7), (4, 9), (7, 5), (1, 9), (1, 6), (6, 8)]
    mesh = shapes.fan((np.array([(x, y, 0.0) for x, y in corners]), shapes.strip(5)[1]))
    shape, n = Shape.from_mesh(*mesh), 3
    found = run(shape, n)
    centers, labels, rounds = literal(mesh, shape, n)
    assert len(found.history) == rounds == 7
    assert found.centers == pytest.approx(np.array(centers), abs=1e-12 * shape.frame.scale)
    assert labels_of(shape, found) == labels
    # At a fixed point one more round would change nothing; here it does.
    _, before, _ = literal(mesh, shape, n, rounds=rounds)
    assert before != labels


def test_every_round_is_recorded_and_reported():
    shape = Shape.from_mesh(*shapes.jitter(shapes.sphere(2), 3))
    reports = []
    found = run(shape, 5, reports=reports)
    rounds = range(1, len(found.history) + 1)
    assert len(rounds) > 2
    assert [record["round"] for record in found.history] == list(rounds)
    assert [(progress.stage, progress.done) for progress in reports] == [
        ("k-means", k) for k in rounds
    ]
    first = furthest_points(shape.points, 5)
    after = run(shape, 5, rounds=1).centers
    step = np.linalg.norm(after - first, axis=1).max() / shape.frame.scale
    assert found.history[0]["largest_step"] == pytest.approx(step)
    assert found.warning == ""


def test_points_that_coincide_still_give_finite_centres():
    shape = Shape.from_mesh(*shapes.joined(shapes.cube(), shapes.cube(), shapes.cube()))
    found = run(shape, 9)
    assert found.centers.shape == (9, 3)
    assert np.isfinite(found.centers).all()


# --- what the paper does not have ----------------------------------------------------------------


def literal_furthest(points, areas, n, spared):
    """Furthest points, each the first from the outside in with more than so much area behind it."""

    def first_beyond(distances, elements):
        behind = 0.0
        for f in sorted(elements, key=lambda f: -distances[f]):
            behind += areas[f]
            if behind > spared:
                return f
        raise AssertionError("everything is spared")

    def apart(p, q):
        return sum((a - b) ** 2 for a, b in zip(p, q, strict=True))

    every = range(len(points))
    total = sum(areas)
    middle = [sum(a * p[k] for a, p in zip(areas, points, strict=True)) / total for k in range(3)]
    radius = [apart(p, middle) for p in points]
    rim = radius[first_beyond(radius, every)]
    inner = [f for f in every if radius[f] <= rim]
    chosen = [inner[f] for f in references.farthest_pair([points[f] for f in inner])][:n]
    while len(chosen) < n:
        nearest = [min(apart(p, points[c]) for c in chosen) for p in points]
        chosen.append(first_beyond(nearest, every))
    return [points[f] for f in chosen]


@given(st.integers(0, 2**32), st.integers(2, 25), st.integers(1, 6), st.floats(0.001, 0.3))
@settings(max_examples=80, deadline=None)
def test_so_much_area_is_left_out_of_account_where_centres_start(seed, size, n, share):
    rng = np.random.default_rng(seed)
    points, areas = rng.normal(size=(size, 3)), rng.uniform(0, 1, size) ** 3
    spared = share * areas.sum()
    found = furthest_points(points, n, areas=areas, spared=spared)
    assert found.tolist() == literal_furthest(points.tolist(), areas.tolist(), n, spared)


def specked(count):
    """A tee with specks far away."""
    specks = [
        (np.array([[30.0 + k, 5, 5], [30.01 + k, 5, 5], [30 + k, 5.01, 5]]), [(0, 1, 2)])
        for k in range(count)
    ]
    return Shape.from_mesh(*shapes.joined(shapes.jitter(shapes.tee(), 5), *specks))


@pytest.mark.parametrize("count", [1, 3])
def test_no_speck_keeps_a_centre_for_itself(count):
    shape, tee = specked(count), Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
    assert run(shape, 2).centers[:, 0].max() > 20  # as in the paper
    preset = KMeans.presets["default"]
    found = run(shape, 2, **preset).centers
    assert found == pytest.approx(run(tee, 2).centers, abs=1e-2)
    for seed in range(20):
        assert run(shape, 2, **preset, **KMeans.presets["again"], seed=seed).centers.max() < 20


def test_drawn_centres_differ_from_start_to_start_and_not_for_one_seed():
    shape = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(20, 10), 2))
    found = [run(shape, 4, drawn=True, seed=seed).centers.tobytes() for seed in range(6)]
    assert len(set(found)) >= 4
    assert run(shape, 4, drawn=True, seed=3).centers.tobytes() == found[3]


def test_points_are_drawn_by_area_and_by_squared_distance():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0], [3, 0, 0]])
    areas = np.array([4.0, 2.0, 1.0, 0.0])
    rng = np.random.default_rng(1)
    drawn = [drawn_points(points, areas, 2, rng)[:, 0].tolist() for _ in range(4000)]
    first = np.bincount([int(x) for x, _ in drawn], minlength=4) / 4000
    assert first == pytest.approx([4 / 7, 2 / 7, 0, 1 / 7], abs=0.03)
    second = np.bincount([int(y) for x, y in drawn if x == 0], minlength=4)
    assert second / second.sum() == pytest.approx([0, 2 / 11, 0, 9 / 11], abs=0.03)
    # Fewer different places than points: they come again.
    assert drawn_points(np.zeros((2, 3)), np.ones(2), 3, rng).shape == (3, 3)
