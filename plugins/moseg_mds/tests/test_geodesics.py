from __future__ import annotations

import moseg_mds.geodesics as geodesics
import numpy as np
import pytest
from moseg_mds.geodesics import distance_solver, geodesic_distances

from moseg_core import ShapeError, UsageError

NEVER_TOO_SHORT = ["exact", "graph"]
ALL = ["exact", "heat", "graph"]


def great_circles(vertices, sources):
    return np.arccos(np.clip(vertices[sources] @ vertices.T, -1, 1))


@pytest.mark.parametrize("method", NEVER_TOO_SHORT)
def test_great_circles(make, method):
    vertices, faces = make.ball(4)
    sources = np.array([0, 700])
    expected = great_circles(vertices, sources)
    found = geodesic_distances(vertices, faces, sources, method=method)
    far = expected > 0
    assert np.abs(found[far] / expected[far] - 1).max() < 0.02
    assert (found[~far] == 0).all()


def test_great_circles_by_heat(make):
    vertices, faces = make.ball(4)
    expected = great_circles(vertices, np.array([0]))
    found = geodesic_distances(vertices, faces, [0], method="heat")
    assert np.abs(found - expected).max() < 0.02 * np.pi
    far = expected > 0.5
    assert np.abs(found[far] / expected[far] - 1).mean() < 0.02


@pytest.mark.parametrize("method", NEVER_TOO_SHORT)
def test_a_cylinder_unrolled(make, method):
    vertices, faces = make.cylinder(48, 16)
    found = geodesic_distances(vertices, faces, [0, 5 * 48 + 7], method=method)
    angle = np.arctan2(vertices[:, 1], vertices[:, 0])
    for source, row in zip((0, 5 * 48 + 7), found, strict=True):
        around = np.abs(angle - angle[source])
        around = np.minimum(around, 2 * np.pi - around)
        expected = np.hypot(around, vertices[:, 2] - vertices[source, 2])
        far = expected > 0
        assert np.abs(row[far] / expected[far] - 1).max() < 0.02


@pytest.mark.parametrize(("method", "tolerance"), [("exact", 1e-9), ("graph", 0.01)])
def test_across_a_cube(make, method, tolerance):
    vertices, faces = make.cube(3)
    at = {tuple(v): k for k, v in enumerate(vertices.tolist())}
    source = at[-0.5, -0.5, -0.5]
    found = geodesic_distances(vertices, faces, [source], method=method)[0]
    # Unfolded: two faces side by side are a rectangle of 1 by 2.
    assert found[at[0.5, 0.5, 0.5]] == pytest.approx(5**0.5, rel=tolerance)
    assert found[at[0.5, 0.5, -0.5]] == pytest.approx(2**0.5, rel=tolerance)
    assert found[at[0.5, -0.5, -0.5]] == pytest.approx(1, rel=tolerance)


@pytest.mark.parametrize("seed", [0, 1])
def test_methods_agree(make, seed):
    vertices, faces = make.ball(3)
    bend = 1 + 0.1 * np.sin(5 * vertices @ np.random.default_rng(seed).normal(size=3))
    mesh = vertices * [1.0, 0.8, 0.6] * bend[:, None], faces
    exact, heat, graph = (geodesic_distances(*mesh, [3, 200], method=m) for m in ALL)
    far = exact > 0.2 * exact.max()
    excess = graph[far] / exact[far] - 1
    assert excess.min() > -1e-6
    assert excess.max() < 0.02
    assert np.abs(heat[far] / exact[far] - 1).mean() < 0.1


@pytest.mark.parametrize("method", NEVER_TOO_SHORT)
def test_distances_are_a_metric_not_below_those_in_space(make, method):
    vertices, faces = make.ball(2)
    table = geodesic_distances(vertices, faces, range(len(vertices)), method=method)
    np.testing.assert_allclose(table, table.T, atol=1e-6)
    assert (table >= make.apart(vertices) - 1e-9).all()
    assert (table <= (table[:, :, None] + table).min(axis=1) + 1e-6).all()


@pytest.mark.parametrize("method", ALL)
def test_distances_scale(make, method):
    vertices, faces = make.ball(3)
    once = geodesic_distances(vertices, faces, [5], method=method)
    np.testing.assert_allclose(
        geodesic_distances(1e4 * vertices, faces, [5], method=method), 1e4 * once, rtol=1e-6
    )


def test_auto_goes_by_size(make, monkeypatch):
    assert distance_solver(*make.ball(2)).method == "exact"
    assert distance_solver(*make.ball(4)).method == "graph"
    monkeypatch.setattr(geodesics, "_HUGE", 5000)
    assert distance_solver(*make.ball(4)).method == "heat"


def pages() -> tuple[np.ndarray, np.ndarray]:
    """Three triangles around one edge."""
    vertices = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1.0]])
    return vertices, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]])


def sliver() -> tuple[np.ndarray, np.ndarray]:
    """A triangle without area between two others."""
    vertices = np.array([[0, 0, 0], [2, 0, 0], [1, 1, 0], [1, -1, 0], [1, 0, 0.0]])
    return vertices, np.array([[0, 4, 2], [4, 1, 2], [0, 1, 4], [1, 0, 3]])


@pytest.mark.parametrize(("mesh", "far"), [(pages(), (2, 3, 2.0)), (sliver(), (2, 3, 2.0))])
def test_bad_meshes_are_left_to_the_graph(mesh, far):
    assert distance_solver(*mesh).method == "graph"
    source, target, expected = far
    found = geodesic_distances(*mesh, [source])[0, target]
    assert found == pytest.approx(expected, rel=0.01)
    for method in ("exact", "heat"):
        with pytest.raises(
            ShapeError, match=f"geodesics='{method}' cannot be used: .* take 'graph'"
        ):
            geodesic_distances(*mesh, [source], method=method)


def test_heat_that_goes_wrong_is_noticed(make, monkeypatch):
    mesh = make.ball(3)
    monkeypatch.setattr(geodesics, "_HUGE", 100)
    monkeypatch.setattr(geodesics, "_SMALL", 10)
    assert distance_solver(*mesh).method == "heat"
    solve = geodesics.igl.heat_geodesics_solve
    monkeypatch.setattr(geodesics.igl, "heat_geodesics_solve", lambda *a: solve(*a) ** 2)
    assert distance_solver(*mesh).method == "graph"
    with pytest.raises(ShapeError, match="% off"):
        distance_solver(*mesh, "heat")


def test_there_may_be_no_way(make):
    vertices, faces = make.ball(1)
    both = np.concatenate([vertices, vertices + 5.0])
    two = np.concatenate([faces, faces + len(vertices)])
    found = geodesic_distances(both, two, [0])[0]
    assert np.isfinite(found[: len(vertices)]).all()
    assert np.isinf(found[len(vertices) :]).all()
    for method in ("exact", "heat"):
        with pytest.raises(ShapeError, match="2 pieces that share no edge"):
            geodesic_distances(both, two, [0], method=method)


@pytest.mark.parametrize("method", ["auto", "graph"])
def test_the_way_may_lead_through_a_single_vertex(method):
    bow = np.array([[0, 0, 0], [1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0.0]])
    found = geodesic_distances(bow, [[0, 1, 2], [0, 3, 4]], [1], method=method)[0]
    np.testing.assert_allclose(found, np.sqrt([2, 0, 4, 8, 8]))


def test_other_methods_are_refused(make):
    with pytest.raises(UsageError, match="auto, exact, heat, graph"):
        geodesic_distances(*make.ball(1), [0], method="euclid")
