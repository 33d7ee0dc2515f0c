"""One case at a time: what it measures, and what becomes of one that fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from moseg_benchmark import cases
from moseg_benchmark.cases import BenchmarkCase, CaseResult, all_leaves, cluster, run_case
from moseg_benchmark.label_matching import Naming
from moseg_benchmark.psb import find_models

from moseg_core import load, load_recipe, read_labels, save_labels


def silent(progress):
    return False


@pytest.fixture(scope="module")
def models(psb):
    return find_models(psb)


def test_a_bug_in_a_case_is_its_reason(models, monkeypatch):
    def broken(case, shape, people, report):
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(cases, "_measure", broken)
    result, labels = run_case(BenchmarkCase(model=models[0], method="people"), report=silent)
    assert result.failure == "ZeroDivisionError: by nothing"
    assert labels is None


def test_one_person_alone_agrees_with_nobody(models):
    model = replace(models[0], people=models[0].people[:1])
    result, _ = run_case(BenchmarkCase(model=model, method="people"), report=silent)
    assert result.failure == "one person alone has nobody to agree with"


def test_clusters_are_the_same_in_every_run(models):
    shape = load(models[0].mesh)
    first = cluster(shape, 4)
    assert sorted(set(first.tolist())) == [0, 1, 2, 3]
    assert (cluster(shape, 4) == first).all()


def test_a_model_without_names_has_no_costs(models, recipe):
    nameless = replace(models[0], names=None)
    case = BenchmarkCase(model=nameless, method="costs", recipe=recipe)
    result, _ = run_case(case, report=silent)
    assert result.failure.startswith("there are no named parts")


def test_names_that_do_not_match_are_not_scored(models, recipe):
    statement = replace(recipe.statement, labels=("up", "down"), minimize="narrow(up)")
    strange = replace(recipe, name="strange", statement=statement)
    case = BenchmarkCase(model=models[0], method="paper", recipe=strange)
    result, _ = run_case(case, report=silent)
    assert result.rand_index_error is not None
    assert result.named_right is None
    # Where they are said to belong together, they are.
    naming = Naming({"one": ("up",), "two": ("sideways", "down")})
    result, labels = run_case(replace(case, naming=naming), report=silent)
    shape = load(models[0].mesh)
    true = read_labels(models[0].names, shape.n_elements).labels
    assert result.named_right == pytest.approx(shape.areas[labels == true].sum() / shape.area)


def test_a_part_that_was_left_whole_counts_as_its_first_leaf(models, tmp_path):
    few = 'optimizer = "pattern_search(max_evaluations=5)"\n'
    many = ", ".join(f'"m{k}"' for k in range(400))
    path = tmp_path / "levels.toml"
    path.write_text(
        f'labels = ["one", "two"]\nminimize = "narrow(one)"\n{few}'
        f'[parts.one]\nlabels = [{many}]\nminimize = "narrow(m*)"\n{few}'
        f'[parts.two]\nlabels = ["a", "b"]\nminimize = "narrow(a)"\n{few}'
    )
    recipe = load_recipe(str(path))
    case = BenchmarkCase(model=models[0], method="default", recipe=recipe)
    result, labels = run_case(case, report=silent)
    assert result.failure == ""
    # 'one' has fewer faces than labels.
    leaves = recipe.hierarchy().labels
    assert {leaves[k] for k in np.unique(labels)} == {"one/m0", "two/a", "two/b"}


def test_a_recipe_of_several_label_sets(models, recipe):
    counted = replace(
        recipe,
        name="counted",
        statement=replace(
            recipe.statement, labels=("one", "two{1..3}"), minimize="narrow(one) + narrow(two*)"
        ),
    )
    leaves = all_leaves(counted)
    assert leaves == ["one", "two1", "two2", "two3"]
    case = BenchmarkCase(model=models[0], method="default", recipe=counted)
    result, labels = run_case(case, report=silent)
    assert result.failure == ""
    assert set(np.unique(labels)) <= set(range(len(leaves)))
    assert 0.0 < result.named_right <= 1.0
    # People's parts: one in the middle, two at its ends. The costs are those of that label set.
    costs, _ = run_case(replace(case, method="costs"), report=silent)
    plain = replace(counted, statement=replace(counted.statement, labels=("one", "two1", "two2")))
    assert (
        costs.cost == run_case(replace(case, method="costs", recipe=plain), report=silent)[0].cost
    )
    assert costs.empty == 0


def test_results_come_back_from_plain_data():
    result = CaseResult(model=21, category="Cup", method="costs", people=(1.5, 2.0), incomplete=1)
    assert CaseResult.read({**vars(result), "people": [1.5, 2.0]}) == result


def test_people_and_names_may_leave_faces_out(models, recipe, tmp_path):
    model = models[0]
    shape = load(model.mesh)
    some = np.arange(shape.n_elements) % 9 == 4
    people = []
    for path in model.people:
        labels = np.where(some, -1, read_labels(path, shape).labels)
        people.append(tmp_path / path.name)
        save_labels(labels, people[-1])
    named = read_labels(model.names, shape)
    save_labels(np.where(some, -1, named.labels), tmp_path / "n.txt", names=named.names)
    partly = replace(model, people=tuple(people), names=tmp_path / "n.txt")
    results = {}
    for method in ("people", "k-means", "costs"):
        whole, part = (
            run_case(BenchmarkCase(model=m, method=method, recipe=recipe), report=silent)[0]
            for m in (model, partly)
        )
        assert whole.failure == part.failure
        results[method] = whole, part
    for method in ("people", "k-means"):
        whole, part = results[method]
        assert part.rand_index_error == pytest.approx(whole.rand_index_error, abs=0.05)
    whole, part = results["costs"]
    assert part.cost == pytest.approx(whole.cost, rel=0.2)
