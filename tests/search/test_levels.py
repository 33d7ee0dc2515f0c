"""Searching over several levels: known answers, and what the levels have to do with each other."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.protocols import Centers, Progress
from moseg_core.errors import UsageError
from moseg_core.io import load, read_labels, read_result, save
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import parse_recipe
from moseg_core.problem.settings import Method
from moseg_core.search.clipped_result import clip
from moseg_core.search.levels import refine, segment_hierarchy
from moseg_core.search.result import Result
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from tests.shapes import book, solid

# A stem of six cubes with a bar of seven across its top and a foot of three across its bottom.
CUBES = (
    [(3, 0, z) for z in range(1, 7)]
    + [(x, 0, 7) for x in range(7)]
    + [(x, 0, 0) for x in (2, 3, 4)]
)
SHAPE = Shape.from_mesh(*solid(CUBES), name="beam")
HEIGHT = SHAPE.points[:, 2]
EXPECTED = {"bar": HEIGHT >= 7, "rest/stem": (HEIGHT > 1) & (HEIGHT < 7), "rest/foot": HEIGHT <= 1}
WHOLE = Problem(["bar", "rest"], "10*convex_parts + narrow(bar)")
REST = Problem(["stem", "foot"], "10*convex_parts + narrow(stem)")
TASK = Hierarchy(WHOLE, {"rest": REST})
FEW = "pattern_search(max_evaluations=40)"


@pytest.fixture(scope="module")
def result() -> Result:
    return segment_hierarchy(SHAPE, TASK)


def deep() -> Hierarchy:
    halves = Problem(["a", "b"], "compact(a)")
    return Hierarchy(WHOLE, {"rest": Hierarchy(REST, {"stem": halves}), "bar": halves})


def test_first_the_bar_comes_off_then_stem_and_foot_part(result):
    assert result.problem.labels == ("bar", "rest/stem", "rest/foot")
    assert list(result.parts) == list(EXPECTED)
    for name, mask in EXPECTED.items():
        assert (result.labels == result.problem.labels.index(name)).tolist() == mask.tolist()
    assert result.reason == "converged"
    assert result.warnings == ()


def test_the_cost_is_the_sum_over_the_levels_and_that_of_the_labels(result):
    assert list(result.levels) == ["", "rest"]
    assert result.cost == sum(level.cost for level in result.levels.values())
    assert result.evaluation == TASK.evaluate(SHAPE, result.labels)
    assert result.dimension == (16, 16)


def test_a_part_is_segmented_as_a_shape_of_its_own(result):
    rest = np.flatnonzero(~EXPECTED["bar"])
    alone = segment(subshape(SHAPE, rest, name="beam/rest"), REST)
    assert (result.labels[rest] - 1).tolist() == alone.labels.tolist()
    np.testing.assert_array_equal(result.centers.positions[1:], alone.centers.positions)
    np.testing.assert_array_equal(result.centers.weights[1:], alone.centers.weights)


@pytest.mark.parametrize("seed", [0, 5])
def test_parts_of_parts_divide_exactly_what_they_are_parts_of(seed):
    found = segment_hierarchy(SHAPE, deep(), optimizer=FEW, seed=seed)
    assert found.problem.labels == ("bar/a", "bar/b", "rest/stem/a", "rest/stem/b", "rest/foot")
    for path, level in found.levels.items():
        here = [
            k
            for k, leaf in enumerate(found.problem.labels)
            if not path or leaf.startswith(path + "/")
        ]
        elements = np.flatnonzero(np.isin(found.labels, here))
        assert level.shape.n_elements == len(elements)
        for label in level.problem.labels:
            inner = f"{path}/{label}" if path else label
            below = [
                k
                for k, leaf in enumerate(found.problem.labels)
                if leaf == inner or leaf.startswith(inner + "/")
            ]
            assert (level.labels == level.problem.labels.index(label)).tolist() == np.isin(
                found.labels[elements], below
            ).tolist()
    assert found.cost == sum(level.cost for level in found.levels.values())
    assert found.evaluation == deep().evaluate(SHAPE, found.labels)
    assert len(found.centers.weights) == 5


def test_the_same_in_any_number_of_processes_and_every_time(tmp_path):
    names = []
    for k, workers in enumerate((1, 2, 1)):
        again = segment_hierarchy(SHAPE, TASK, restarts=2, seed=3, workers=workers)
        for suffix in ("json", "seg", "ply", "glb"):
            save(again, tmp_path / f"{k}.{suffix}")
        names.append({p.suffix: p.read_bytes() for p in tmp_path.glob(f"{k}.*")})
    assert names[0] == names[1] == names[2]


def test_refining_a_result_is_the_same_as_descending_at_once(result):
    whole = segment(SHAPE, WHOLE)
    refined = refine(whole, {"r*": REST})
    assert refined.labels.tolist() == result.labels.tolist()
    assert refined.evaluation == result.evaluation
    assert refined.seed == whole.seed
    with pytest.raises(UsageError, match="several levels"):
        refine(refined, {"bar": REST})
    with pytest.raises(UsageError, match="unknown label 'baa'; did you mean 'bar'"):
        refine(whole, {"baa": REST})


def test_a_problem_alone_is_segmented_as_ever():
    found = segment_hierarchy(SHAPE, WHOLE, optimizer=FEW)
    plain = segment(SHAPE, WHOLE, optimizer=FEW)
    assert found.problem is plain.problem
    assert found.labels.tolist() == plain.labels.tolist()
    assert found.levels == {}


def test_a_recipe_is_a_task(result):
    recipe = parse_recipe(
        """
        labels = ["bar", "rest"]
        minimize = "10*convex_parts + narrow(bar)"
        [parts.rest]
        labels = ["stem", "foot"]
        minimize = "10*convex_parts + narrow(stem)"
        """,
        "beam",
    )
    assert segment_hierarchy(SHAPE, recipe).labels.tolist() == result.labels.tolist()


def test_history_method_and_versions_tell_the_level(result):
    stages = {"seeding", "search", "restarts"}
    assert set(result.history) == stages | {f"rest: {stage}" for stage in stages}
    assert result.method["rest: seeder"] == result.method["seeder"] == "core:kmeans(outliers=0.001)"
    assert result.versions == dict(sorted(result.versions.items()))
    assert {"basic:narrow", "core:kmeans"} <= set(result.versions)


def test_the_versions_of_a_run_are_known_before_it(result):
    assert result.versions == TASK.versions
    ends = Hierarchy(REST, search=Method(seeder="evolution", labeler="core:greedy"))
    core = TASK.versions["core:kmeans"]
    more = {"core:evolution": core, "core:greedy": core}
    assert Hierarchy(WHOLE, {"rest": ends}).versions == TASK.versions | more


def test_versions_name_constraints_and_the_embedding():
    problem = Problem(["bar", "rest"], "flat(bar)", constraints=["on_plane(bar)"], embedding="mds")
    assert list(problem.versions) == ["basic:flat", "mds:mds", "symmetry:on_plane"]
    assert problem.versions["mds:mds"].startswith("moseg-mds ")


def test_a_component_that_is_not_installed_has_no_version():
    task = Hierarchy(WHOLE, search=Method(seeder="kmean"))
    with pytest.raises(UsageError, match="unknown seeder 'kmean'; did you mean 'kmeans'"):
        _ = task.versions


def test_every_level_has_its_own_method():
    task = parse_recipe(
        """
        labels = ["bar", "rest"]
        minimize = "narrow(bar)"
        optimizer = "pattern_search(max_evaluations=9)"
        [parts."*"]
        labels = ["a", "b"]
        minimize = "compact(a)"
        labeler = "greedy"
        optimizer = "pattern_search(max_evaluations=5)"
        """,
        "mine",
    ).hierarchy()
    found = segment_hierarchy(SHAPE, task)
    assert found.method["labeler"] == "core:hungarian"
    assert found.method["rest: labeler"] == "core:greedy"
    assert found.method["optimizer"] == "core:pattern_search(max_evaluations=9)"
    assert found.method["bar: optimizer"] == "core:pattern_search(max_evaluations=5)"
    assert found.reason == "evaluations"
    assert "bar: the search ended on its limit (evaluations); a longer one may find better" in (
        found.warnings
    )
    both = segment_hierarchy(SHAPE, task, labeler="exhaustive", optimizer=FEW)
    assert both.method["labeler"] == both.method["rest: labeler"] == "core:exhaustive"


def test_a_part_with_too_few_faces_stays_whole():
    many = Problem([f"m{k}" for k in range(15)], "compact(m*)")
    found = segment_hierarchy(SHAPE, Hierarchy(WHOLE, {"rest": Hierarchy(REST, {"foot": many})}))
    assert found.problem.labels == ("bar", "rest/stem", "rest/foot")
    assert found.warnings == (
        "part 'rest/foot' is left whole: it has 13 faces, too few for 15 labels",
    )
    assert found.evaluation == TASK.evaluate(SHAPE, found.labels)


def test_a_part_that_lacks_what_a_term_needs_stays_whole():
    vertices, faces = book(4)
    pages = Shape.from_mesh(vertices, [*faces, *faces])
    task = Hierarchy(
        Problem(["one", "two"], "flat(one)"), {"*": Problem(["a", "b"], "convex_parts")}
    )
    found = segment_hierarchy(pages, task, optimizer=FEW)
    assert found.problem.labels == ("one", "two")
    assert found.levels == {}
    assert (
        sum("is left whole: 'convex_parts' needs an enclosed volume" in w for w in found.warnings)
        >= 1
    )
    assert all("is left whole" in w for w in found.warnings if w.startswith("part 'one'"))


def test_an_empty_part_stays_whole():
    far = Centers(positions=np.array([[3.0, 0.5, 4.0], [1e4, 0.0, 0.0]]), weights=np.ones(2))
    task = Hierarchy(Problem(["all", "none"], "compact(all)"), {"none": REST})
    found = segment_hierarchy(SHAPE, task, start=far, freeze=["all", "none"], optimizer=FEW)
    assert found.evaluation.empty == ("none",)
    assert "part 'none' is left whole: it is empty" in found.warnings


def test_pins_freeze_and_start_are_about_the_first_level():
    begin = Centers(positions=np.array([[3.5, 0.5, 7.5], [3.5, 0.5, 3.0]]), weights=np.ones(2))
    low = np.flatnonzero(EXPECTED["rest/foot"])
    found = segment_hierarchy(
        SHAPE, TASK, start=begin, freeze=["bar"], pins={"rest": low}, optimizer=FEW
    )
    assert found.centers.positions[0] == pytest.approx(begin.positions[0])
    names = np.array(found.problem.labels)[found.labels[low]]
    assert all(name.startswith("rest/") for name in names)
    with pytest.raises(UsageError, match="unknown label 'stem'"):
        segment_hierarchy(SHAPE, TASK, pins={"stem": low})


def test_centres_by_hand_are_those_of_the_whole():
    seeder = {"name": "given", "centers": "bar=3.5,0.5,7.5,rest=3.5,0.5,3"}
    found = segment_hierarchy(SHAPE, TASK, seeder=seeder, optimizer=FEW)
    assert found.method["seeder"].startswith("core:given")
    assert found.method["rest: seeder"] == "core:kmeans(outliers=0.001)"


def test_a_hierarchical_result_is_no_start(result):
    with pytest.raises(UsageError, match=r"result of several levels.*result\.levels\[''\]"):
        segment(SHAPE, WHOLE, start=result)
    again = segment(SHAPE, WHOLE, start=result.levels[""], optimizer=FEW)
    assert again.cost <= result.levels[""].cost
    with pytest.raises(UsageError, match="give a Hierarchy to segment_hierarchy"):
        segment(SHAPE, TASK)


def test_levels_are_clipped_one_by_one(result):
    with pytest.raises(UsageError, match="results of one level only"):
        clip(result)
    assert clip(result.levels["rest"]).clipped is not None


def test_reports_tell_the_level_and_stop_it():
    stages: list[str] = []

    def report(progress: Progress) -> bool:
        stages.append(progress.stage)
        return False

    segment_hierarchy(SHAPE, TASK, report=report)
    assert "pattern_search" in stages
    assert "rest: pattern_search" in stages
    stopped = segment_hierarchy(SHAPE, TASK, report=lambda progress: True)
    assert stopped.reason == "interrupted"
    assert stopped.problem.labels == ("bar", "rest")
    assert any("rest' is left whole: the run was interrupted" in w for w in stopped.warnings)


def test_no_time_at_all_still_divides():
    found = segment_hierarchy(SHAPE, TASK, max_seconds=0)
    assert found.reason == "seconds"
    assert found.problem.labels == TASK.labels


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"resolution": 1}, UsageError, "a resolution of 1 is too low for the 2 labels"),
        ({"seeder": "kmean"}, UsageError, "did you mean 'kmeans'"),
        ({"seed": -1}, UsageError, "must not be negative"),
        ({"sed": 1}, UsageError, "unknown option 'sed'; did you mean 'seed'"),
    ],
)
def test_options_are_checked_before_the_search(options, error, message):
    with pytest.raises(error, match=message):
        segment_hierarchy(SHAPE, TASK, **options)


def test_the_methods_of_parts_are_checked_before_the_search():
    task = parse_recipe(
        'labels = ["a", "b"]\nminimize = "narrow(a)"\n'
        '[parts.b]\nlabels = ["c"]\nminimize = "flat(c)"\nlabeler = "hungary"',
        "mine",
    )
    with pytest.raises(UsageError, match="'hungary'"):
        segment_hierarchy(SHAPE, task, report=lambda progress: pytest.fail("it has begun"))


def test_something_else_is_no_task():
    with pytest.raises(UsageError, match="a Hierarchy, Recipe or Problem is needed, not 'narrow"):
        segment_hierarchy(SHAPE, "narrow(a)")


def test_results_of_several_levels_are_saved_and_read_back(result, tmp_path):
    for suffix in ("json", "seg", "ply", "glb", "png", "svg"):
        save(result, tmp_path / f"beam.{suffix}")
    saved = read_result(tmp_path / "beam.json")
    assert saved.names == result.problem.labels
    assert saved.evaluation == result.evaluation
    assert [(path, level.minimize) for path, level in saved.statement.levels()] == [
        ("", str(WHOLE.expression)),
        ("rest", str(REST.expression)),
    ]
    assert saved.statement.alone() == result.problem.statement.alone()
    assert str(saved.search("rest").optimizer) == result.method["rest: optimizer"]
    np.testing.assert_array_equal(saved.centers.positions, result.centers.positions)
    for suffix in ("json", "seg", "ply"):
        read = read_labels(tmp_path / f"beam.{suffix}", SHAPE.n_elements)
        assert read.labels.tolist() == result.labels.tolist()
        assert suffix == "seg" or read.names == result.problem.labels
    assert load(tmp_path / "beam.glb").n_elements >= SHAPE.n_elements
    assert b"rest/stem" in (tmp_path / "beam.glb").read_bytes()


def test_several_centres_are_about_the_labels_of_the_first_level():
    found = segment_hierarchy(
        SHAPE, TASK, parameterization='voronoi(centers="bar=2")', optimizer=FEW
    )
    assert found.method["parameterization"] == 'core:voronoi(centers="bar=2")'
    assert found.method["rest: parameterization"] == "core:voronoi"
    assert found.centers.per_part.tolist() == [2, 1, 1]
    assert (found.levels[""].centers.of(0).positions == found.centers.positions[:2]).all()
    assert (found.levels["rest"].centers.positions == found.centers.positions[2:]).all()
    both = 'voronoi(connected=false, centers="bar=2")'
    found = segment_hierarchy(SHAPE, TASK, parameterization=both, optimizer=FEW)
    assert found.method["rest: parameterization"] == "core:voronoi(connected=0)"


def test_a_level_may_say_how_many_centres_its_own_labels_have():
    rest = Hierarchy(REST, search=Method(parameterization='voronoi(centers="foot=2")'))
    task = Hierarchy(WHOLE, {"rest": rest})
    for more in ({}, {"parameterization": 'voronoi(centers="bar=2")'}):
        found = segment_hierarchy(SHAPE, task, optimizer=FEW, **more)
        assert found.method["rest: parameterization"] == 'core:voronoi(centers="foot=2")'
        assert found.centers.per_part.tolist() == [2 if more else 1, 1, 2]
