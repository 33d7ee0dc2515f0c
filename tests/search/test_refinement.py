"""Boundaries moved after the search: what a refiner may return, and what its result is."""

from __future__ import annotations

import sys
import types
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import RefinerSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Progress, never_stop
from moseg_core.errors import MosegError, PluginError, ShapeError, UsageError
from moseg_core.io.files import save
from moseg_core.io.result_json import read_result
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method
from moseg_core.search.clipped_result import check_components, clip
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.refinement import ReadyRefiner, Refinement
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import fail, on_strip, refiner, stranger

LABELS = np.array([0, 0, 0, 0, 1, 1, 1, 1], np.int32)


def found_on(evaluator, labels=LABELS):
    return Refinement(labels=labels, evaluation=evaluator.evaluate_labels(labels))


def refined(answer, evaluator=None, *, report=never_stop, **more):
    evaluator = evaluator or on_strip()
    ready = ReadyRefiner.of(answer if hasattr(answer, "ready") else refiner(answer))
    return ready.refine(evaluator, found_on(evaluator), report=report, **more)


# --- what a refiner may return -------------------------------------------------------------------


def test_labels_and_cost_are_those_that_the_refiner_returns():
    moved = np.where(np.arange(8) < 3, 0, 1)  # of another type of whole numbers
    found = refined(moved)
    assert found.labels.tolist() == moved.tolist()
    assert found.labels.dtype == np.int32
    assert found.evaluation.cost.value == pytest.approx(3.0)
    assert found.failure is None
    assert found.warning == ""
    assert found.history == (
        {"value": pytest.approx(4.0), "empty": 0, "moved": 0},
        {"value": pytest.approx(3.0), "empty": 0, "moved": 1},
    )


def test_a_cost_that_a_refiner_has_raised_much_is_a_warning():
    found = refined(np.where(np.arange(8) < 7, 0, 1))
    assert "raised the cost from 4 to 7" in found.warning
    assert refined(np.where(np.arange(8) < 5, 0, 1)).warning == ""


@pytest.mark.parametrize(
    "garbage",
    [
        None,
        "labels",
        [0, 1],
        LABELS + 0.5,
        LABELS + 1,
        LABELS - 1,
        np.zeros((8, 1), int),
        [[0], [1, 2]],
    ],
)
def test_a_refiner_that_returns_garbage_is_named_and_the_labels_stay(garbage):
    found = refined(garbage)
    assert isinstance(found.failure, PluginError)
    assert str(found.failure).startswith(
        "refiner 'strange:made' of moseg-strange 2.0 must return a labelling: "
    )
    assert found.warning == f"the boundaries are not refined: {found.failure}"
    assert found.labels is LABELS
    assert found.history == ()


def test_what_it_raises_is_told_with_its_name():
    found = refined(fail)
    assert isinstance(found.failure, PluginError)
    assert "refiner 'strange:made' of moseg-strange 2.0 failed: ValueError: no idea" in str(
        found.failure
    )

    def refuse(evaluator, labels):
        raise ShapeError("no creases here")

    assert str(refined(refuse).failure) == "no creases here"


def test_it_may_not_write_into_what_it_is_given():
    def write(evaluator, labels):
        labels[3] = 1
        return labels

    found = refined(write)
    assert "read-only" in str(found.failure)
    assert LABELS.tolist() == [0, 0, 0, 0, 1, 1, 1, 1]


def test_a_part_that_is_lost_is_named():
    found = refined(np.zeros(8, int))
    assert "moseg-strange 2.0 left nothing of the part 'b'" in str(found.failure)


def test_a_part_that_had_nothing_may_have_nothing():
    evaluator = on_strip(names=("a", "b", "c"))
    assert refined(np.where(np.arange(8) < 3, 0, 1), evaluator).failure is None


def test_pinned_elements_keep_their_label_or_get_the_one_that_they_are_pinned_to():
    evaluator = on_strip(pins={"a": [3], "b": [0]})  # the second is broken from the start
    across = np.where(np.arange(8) < 3, 0, 1)
    assert "gave the label 'b' to element 3, which is pinned to 'a'" in str(
        refined(across, evaluator).failure
    )
    assert refined(np.where(np.arange(8) < 5, 0, 1), evaluator).failure is None
    healed = LABELS.copy()
    healed[0] = 1
    assert refined(healed, evaluator).failure is None


def test_an_error_of_an_objective_leaves_the_labels_as_they_were():
    @objective(range=(0, 8))
    def picky(part: Part) -> float:
        if part.n_elements != 4:
            raise ValueError("four, please")
        return part.area

    problem = Problem(["a", "b"], "picky(a)", objectives={"picky": picky})
    evaluator = replace_problem(on_strip(), problem)
    found = refined(np.where(np.arange(8) < 3, 0, 1), evaluator)
    assert "four, please" in str(found.failure)
    assert found.labels is LABELS


def replace_problem(evaluator, problem):
    evaluator.problem = problem
    return evaluator


def test_nothing_is_refined_once_the_user_has_asked_to_stop():
    found = refined(fail, interrupted=True)
    assert found.labels is LABELS
    assert found.failure is None
    assert found.warning == "the boundaries are not refined, since the run was interrupted"


def test_one_that_cannot_be_made_is_named_before_the_search():
    with pytest.raises(PluginError, match=r"refiner 'strange:made' .* cannot be made: ValueError"):
        ReadyRefiner.of(stranger("refiner", fail))


def test_what_it_checks_is_checked():
    class Checks:
        def check(self, evaluator):
            if evaluator.shape.volume is None:
                raise ShapeError("it needs a volume")

        def __call__(self, evaluator, labels, *, report):
            return labels

    ready = ReadyRefiner.of(stranger("refiner", Checks))
    with pytest.raises(ShapeError, match="it needs a volume"):
        ready.check(on_strip())
    assert ReadyRefiner.of(refiner(LABELS)).check(on_strip()) == ""  # one that checks nothing


# --- in a search ---------------------------------------------------------------------------------

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")
FEW = "pattern_search(max_evaluations=30)"


@objective(range=(0, 1))
def slim(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


class Rim:
    """One element at the boundary of the first part goes to it, not more."""

    def __init__(self, *, broken: bool = False, hopeless: bool = False):
        self.broken, self.hopeless = broken, hopeless
        if hopeless:
            raise UsageError("there is no hope")

    def check(self, evaluator):
        seen.append("check")
        return "it goes by ear"

    def __call__(self, evaluator, labels, *, report):
        seen.append(("told to stop", report(Progress(stage="rim", done=0))))
        if self.broken:
            raise RuntimeError("the rim is broken")
        one, other = evaluator.shape.adjacency.pairs.T
        moved = labels.copy()
        moved[one[(labels[one] == 1) & (labels[other] == 0)][0]] = 0
        return moved


seen: list[object] = []


@pytest.fixture
def with_rim(monkeypatch):
    """A registry in which there is a refiner 'rim'."""
    seen.clear()
    module = types.ModuleType("rim_bundle")
    module.Rim = Rim
    monkeypatch.setitem(sys.modules, "rim_bundle", module)
    component = Component(
        "made", "moseg-made 1.0", RefinerSpec(name="rim", target="rim_bundle:Rim")
    )
    bundle = Bundle("made", "moseg-made", "1.0", "rim_bundle", (component,))
    return Registry([*registry().bundles, bundle])


def problem_in(source, labels=("stem", "bar")):
    return Problem(
        labels,
        f"2*slim({labels[0]}) + slim({labels[1]})",
        objectives={"slim": slim},
        registry=source,
    )


def run(source, shape=SHAPE, **options):
    return segment(shape, problem_in(source), **{"optimizer": FEW, **options})


def partition_of(result):
    """The labels that a result's centres give."""
    partition = registry().find("parameterization", "core:voronoi").load()(result.shape, 2)
    return partition.labels(partition.encode(result.centers)[None])[0]


def test_a_refined_result_has_the_refined_labels_and_the_centres_of_the_partition(
    with_rim, tmp_path
):
    plain, found = run(with_rim), run(with_rim, refiner="rim")
    assert not plain.refined
    assert "refiner" not in plain.method
    assert found.refined
    assert (found.labels != plain.labels).sum() == 1
    assert found.centers.positions.tolist() == plain.centers.positions.tolist()
    assert (partition_of(found) == plain.labels).all()
    assert found.evaluation.cost == found.problem.evaluate(SHAPE, found.labels).cost
    before, after = found.history["refine"]
    assert (before["value"], before["moved"]) == (plain.cost, 0)
    assert (after["value"], after["moved"]) == (found.cost, 1)
    assert found.method["refiner"] == "made:rim"
    assert found.versions["made:rim"] == "moseg-made 1.0"
    assert seen == ["check", ("told to stop", False)]
    save(found, tmp_path / "found.json")
    saved = read_result(tmp_path / "found.json")
    assert saved.labels.tolist() == found.labels.tolist()
    assert saved.method["refiner"] == "made:rim"
    assert str(saved.search().refiner) == "made:rim"
    save(plain, tmp_path / "plain.json")
    assert str(read_result(tmp_path / "plain.json").search().refiner) == "none"


def test_a_start_from_a_refined_result_begins_at_its_centres(with_rim):
    found = run(with_rim, refiner="rim")
    again = run(with_rim, start=found, optimizer="pattern_search(max_evaluations=1)")
    assert (again.labels == partition_of(found)).all()


def test_refined_boundaries_are_not_clipped(with_rim):
    found = run(with_rim, refiner="rim")
    with pytest.raises(UsageError, match="boundaries that the refiner 'made:rim' moves cannot be"):
        clip(found)
    ready = {"parameterization": stranger("parameterization", fail), "refiner": refiner(LABELS)}
    ready["parameterization"] = replace(ready["parameterization"], factory=type("Any", (), BISECTS))
    with pytest.raises(UsageError, match=r"refiner 'strange:made' of moseg-strange 2\.0 moves"):
        check_components(ready)
    del ready["refiner"]
    check_components(ready)


BISECTS = {"weighted_bisectors": True}


def test_a_refiner_that_fails_leaves_the_result_that_was_found(with_rim):
    plain = run(with_rim)
    with pytest.raises(PluginError, match="RuntimeError: the rim is broken") as caught:
        run(with_rim, refiner="rim(broken=true)")
    found = caught.value.result
    assert (found.labels == plain.labels).all()
    assert found.evaluation.cost == plain.evaluation.cost
    assert found.reason == "failed"
    assert not found.refined
    assert any(w.startswith("the boundaries are not refined: refiner") for w in found.warnings)


def test_what_is_wrong_with_it_is_told_before_the_search(with_rim):
    def search(progress):
        raise AssertionError("it began")

    for wrong, message in (
        ("rim(hopeless=true)", "there is no hope"),
        ("rym", "unknown refiner 'rym'; did you mean 'rim'"),
        ("rim(brocken=true)", "did you mean 'broken'"),
    ):
        with pytest.raises(MosegError, match=message):
            run(with_rim, refiner=wrong, report=search)


def test_what_it_does_without_is_a_warning_of_the_refined_result(with_rim):
    assert "it goes by ear" in run(with_rim, refiner="rim").warnings
    assert "it goes by ear" not in run(with_rim).warnings
    left = run(with_rim, refiner="rim", report=lambda progress: True)
    assert "it goes by ear" not in left.warnings


def test_only_the_request_has_a_refiner_under_the_papers_settings(with_rim):
    recipe = Method(refiner="rim")
    assert run(with_rim, defaults=recipe).refined
    assert not run(with_rim, defaults=recipe, refiner="none").refined
    assert not run(with_rim, defaults=recipe, settings="paper").refined
    assert run(with_rim, refiner="rim", settings="paper").refined


def test_when_the_time_is_up_it_is_told_at_once(with_rim):
    found = run(with_rim, refiner="rim", max_seconds=0)
    assert found.reason == "seconds"
    assert found.refined
    assert seen == ["check", ("told to stop", True)]


def test_an_interrupted_run_is_not_refined(with_rim):
    found = run(with_rim, refiner="rim", report=lambda progress: True)
    assert found.reason == "interrupted"
    assert not found.refined
    assert "the boundaries are not refined, since the run was interrupted" in found.warnings


def test_a_run_that_is_interrupted_while_it_is_refined_says_so(with_rim):
    found = run(with_rim, refiner="rim", report=lambda progress: progress.stage == "rim")
    assert found.reason == "interrupted"
    assert found.refined


def test_after_a_search_on_super_elements_the_inputs_elements_are_refined(with_rim):
    plain, found = (run(with_rim, resolution=30, refiner=r) for r in (None, "rim"))
    assert "polish" in found.history
    assert len(found.labels) == SHAPE.n_elements
    assert (found.labels != plain.labels).sum() == 1


def test_every_level_is_refined_before_its_parts_are_divided(with_rim):
    inner = problem_in(with_rim, ("low", "high"))
    task = Hierarchy(problem_in(with_rim), {"stem": Hierarchy(inner, search=Method(refiner="rim"))})
    found = segment_hierarchy(SHAPE, task, optimizer=FEW)
    assert "stem: refine" in found.history
    assert "refine" not in found.history
    assert found.refined
    assert found.method["stem: refiner"] == "made:rim"
    both = segment_hierarchy(SHAPE, task, optimizer=FEW, refiner="rim")
    assert both.levels[""].labels.tolist() == run(with_rim, refiner="rim").labels.tolist()
    assert both.levels["stem"].shape.n_elements == (both.levels[""].labels == 0).sum()
    assert "refine" in both.history
    assert task.versions["made:rim"] == "moseg-made 1.0"
