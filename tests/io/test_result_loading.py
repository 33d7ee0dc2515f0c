"""Saved results as results: with the shape that they are of, and no other."""

from __future__ import annotations

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.read.examples import example
from moseg_core.io.result_json import read_result, write_json
from moseg_core.io.result_loading import find_shape, load_result
from moseg_core.problem.problem import Problem
from tests import shapes
from tests.results import area, result_on


@pytest.fixture
def shape(tmp_path):
    """A shape that was read from a file."""
    (tmp_path / "data").mkdir()
    path = tmp_path / "data" / "cube.off"
    path.write_bytes(example(".off"))
    return moseg.load(path)


@pytest.fixture
def saved(shape, tmp_path):
    """A result of installed components alone, of which everything can be looked up again."""
    problem = Problem(["first", "second"], "2*narrow(first) + similar(first, second)")
    labels = (np.arange(shape.n_elements) % 2).astype(np.int32)
    result = result_on(
        shape,
        problem=problem,
        labels=labels,
        evaluation=problem.evaluate(shape, labels),
        dimension=(6, 8),
        warnings=("watch out",),
        history={"search": ({"iteration": 0, "value": np.inf},)},
    )
    path = tmp_path / "r.json"
    moseg.save(result, path)
    return path, result


def test_a_result_comes_back_as_it_was(saved, tmp_path):
    path, result = saved
    found = load_result(path)
    assert found.evaluation == result.evaluation
    assert found.labels.tolist() == result.labels.tolist()
    assert found.labels.dtype == np.int32
    assert {k: p.membership for k, p in found.parts.items()} == {
        k: p.membership for k, p in result.parts.items()
    }
    assert found.table() == result.table()
    assert (found.reason, found.warnings, found.dimension) == ("converged", ("watch out",), (6, 8))
    assert str(found.problem.expression) == str(result.problem.expression)
    moseg.save(found, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == path.read_bytes()


def test_a_result_of_a_search_on_two_levels_comes_back_too(tmp_path):
    rod = moseg.Shape.from_mesh(*shapes.bent_capsule(9, 8), name="rod")
    task = moseg.Hierarchy(
        Problem(["one", "rest"], "narrow(one)"), {"rest": Problem(["a", "b"], "narrow(a)")}
    )
    result = moseg.segment_hierarchy(rod, task, restarts=1, seeder="kmeans")
    path = tmp_path / "h.json"
    moseg.save(result, path)
    found = load_result(path, rod)
    assert found.problem.labels == ("one", "rest/a", "rest/b")
    assert found.table() == result.table()
    assert write_json(found) == path.read_bytes()


def test_the_shape_is_found_where_it_was_or_beside_the_result(saved, shape, tmp_path):
    path, _ = saved
    assert load_result(path).shape.file == shape.file
    there = tmp_path / "data" / "cube.off"
    beside = there.rename(tmp_path / "cube.off")
    assert load_result(path).shape.file == str(beside)
    elsewhere = tmp_path / "scans"
    elsewhere.mkdir()
    moved = beside.rename(elsewhere / "cube.off")
    with pytest.raises(ShapeError, match=r"'cube.off' of .* is not found; say.*--shapes FOLDER"):
        load_result(path)
    found = find_shape(read_result(path), path, folders=[elsewhere])
    assert found.file == str(moved)
    # An older result knows the name alone.
    text = path.read_text().replace(f'"file": "{shape.file}", ', "")
    path.write_text(text)
    assert find_shape(read_result(path), path, folders=[elsewhere]).file == str(moved)
    given = load_result(path, moseg.load(moved))
    assert given.shape.file == str(moved)


def test_another_shape_is_refused(saved, box, shape, tmp_path):
    path, _ = saved
    with pytest.raises(ShapeError, match=r"and 'box' of \d+ has another geometry; give the shape"):
        load_result(path, box)
    other = tmp_path / "data" / "cube.off"
    other.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with pytest.raises(ShapeError, match=r"is not found: .*is another, or was read with other"):
        load_result(path)
    other.write_text("no shape")
    with pytest.raises(ShapeError, match=r"is not found: .*cube.off"):
        load_result(path)


def test_the_surface_of_a_grid_is_found_in_the_grid(tmp_path):
    np.save(tmp_path / "grid.npy", np.ones((3, 3, 3), bool))
    surface = moseg.load(tmp_path / "grid.npy").with_elements("surface")
    path = tmp_path / "r.json"
    moseg.save(result_on(surface), path)
    assert find_shape(read_result(path), path).geometry.elements == "surface"


def test_objectives_of_ones_own_come_with_the_problem(shape, tmp_path):
    result = result_on(shape)
    path = tmp_path / "own.json"
    moseg.save(result, path)
    with pytest.raises(
        UsageError, match=r"unknown objective 'area'[^$]*load_result\(path, problem"
    ):
        load_result(path)
    problem = Problem(["first", "second"], "2*area(first)", objectives={"area": area})
    assert load_result(path, problem=problem).evaluation == result.evaluation
    with pytest.raises(UsageError, match=r"has the labels first, second, the problem .* a, b"):
        load_result(path, problem=Problem(["a", "b"], "narrow(a)"))
