"""Results on disk, and when a later run takes them over."""

from __future__ import annotations

import importlib
import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from moseg_benchmark.cases import BenchmarkCase, CaseResult
from moseg_benchmark.label_matching import Naming
from moseg_benchmark.lessons import LearnedCase, LearnedResult
from moseg_benchmark.psb import find_models
from moseg_benchmark.records import Records, asked_of

from moseg_core import Method, load_recipe, registry
from moseg_core.components.chosen import Choice


@pytest.fixture
def case(psb, recipe):
    return BenchmarkCase(model=find_models(psb)[0], method="default", recipe=recipe)


@pytest.fixture
def records(tmp_path):
    return Records(tmp_path)


RESULT = CaseResult(model=21, category="Cup", method="default", rand_index_error=0.1, cost=2.0)
LABELS = np.array([0, 2, 1])


def test_what_was_written_is_taken_over(case, records):
    assert records.result(case) is None
    records.write(case, RESULT, LABELS)
    assert records.result(case) == RESULT
    assert records.labels(case).tolist() == [0, 2, 1]


def test_names_and_descriptions_say_nothing_to_the_search(case, records):
    records.write(case, RESULT, LABELS)
    described = replace(case.recipe, description="what it is for")
    assert records.result(replace(case, recipe=described)) == RESULT


def stated(case, **changes):
    """The case under a recipe that says something else."""
    statement = replace(case.recipe.statement, **changes)
    return replace(case, recipe=replace(case.recipe, statement=statement))


def divided(case, **changes):
    """The case under a recipe whose first label is divided."""
    part = {"labels": ("a", "b"), "minimize": "narrow(a)"} | changes
    return stated(case, parts=(("one", replace(case.recipe.statement, **part)),))


@pytest.mark.parametrize(
    ("first", "other"),
    [
        ({}, {"labels": ("two1", "one", "two2")}),
        ({}, {"minimize": "2*narrow(one) + narrow(two*) + convex_parts"}),
        ({}, {"constraints": ("mirror(two2, two1)",)}),
        ({"constraints": ("mirror(two2, two1)",)}, {"constraints": ("mirror(two1, two2)",)}),
        (
            {"constraints": ("on_plane(one)",), "plane": "x"},
            {"constraints": ("on_plane(one)",), "plane": "y"},
        ),
        ({}, {"embedding": Choice("mds")}),
        ({"embedding": Choice("mds")}, {"embedding": Choice("mds", {"landmarks": 20})}),
        ({"embedding": Choice("mds")}, {"embedding": Choice("mds"), "space": "mds"}),
        ({}, {"search": Method(labeler="greedy")}),
        ({"search": Method(restarts=1)}, {"search": Method(restarts=2)}),
    ],
    ids=[
        *("labels", "minimize", "constraint", "labels of a constraint", "plane", "embedding"),
        *("parameter of the embedding", "space", "component", "restarts"),
    ],
)
def test_another_statement_is_measured_anew(case, records, first, other):
    records.write(stated(case, **first), RESULT, LABELS)
    assert records.result(stated(case, **first)) == RESULT
    assert records.result(stated(case, **other)) is None


def test_another_statement_for_a_part_is_measured_anew(case, records):
    records.write(divided(case), RESULT, LABELS)
    assert records.result(divided(case)) == RESULT
    assert records.result(case) is None
    assert records.result(divided(case, constraints=("mirror(b, a)",))) is None


def test_another_matching_of_names_is_measured_anew(case, records):
    records.write(case, RESULT, LABELS)
    matched = replace(case, naming=Naming({"two": ("one",)}))
    assert records.result(matched) is None
    records.write(matched, RESULT, LABELS)
    assert records.result(matched) == RESULT
    assert records.result(replace(case, naming=Naming({"two": ("three", "one")}))) is None


FOREIGN = """\
from moseg_core import Part, SeederSpec, ObjectiveSpec, hookimpl, objective

@objective(range=(0, 1))
def long(part: Part) -> float:
    return 0.5

@hookimpl
def moseg_objectives():
    return [ObjectiveSpec(name="long", target="foreign_bundle:long")]

@hookimpl
def moseg_seeders():
    return [SeederSpec(name="thrown", target="foreign_bundle:long")]
"""


@pytest.fixture
def foreign(tmp_path, monkeypatch):
    """A way to install a distribution in a version, instead of that in another one."""
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    (site / "foreign_bundle.py").write_text(FOREIGN)

    def install(version: str) -> None:
        for info in site.glob("*.dist-info"):
            info.rename(site / f"moseg_foreign-{version}.dist-info")
        info = site / f"moseg_foreign-{version}.dist-info"
        info.mkdir(exist_ok=True)
        header = f"Metadata-Version: 2.1\nName: moseg-foreign\nVersion: {version}\n"
        (info / "METADATA").write_text(header)
        (info / "entry_points.txt").write_text("[moseg]\nforeign = foreign_bundle\n")
        importlib.invalidate_caches()
        registry.cache_clear()

    yield install
    sys.modules.pop("foreign_bundle", None)
    monkeypatch.undo()
    importlib.invalidate_caches()
    registry.cache_clear()


@pytest.mark.parametrize("what", ["objective", "seeder", "objective of a part"])
def test_another_version_of_a_distribution_is_measured_anew(case, records, foreign, what):
    foreign("1.0")
    case = {
        "objective": stated(case, minimize="long(one)"),
        "seeder": stated(case, search=Method(seeder="thrown")),
        "objective of a part": divided(case, minimize="long(a)"),
    }[what]
    assert "moseg-foreign 1.0" in asked_of(case)["versions"].values()
    records.write(case, RESULT, LABELS)
    assert records.result(case) == RESULT
    foreign("1.1")
    assert records.result(case) is None


def test_a_distribution_that_is_not_used_does_not_matter(case, records, foreign):
    foreign("1.0")
    records.write(case, RESULT, LABELS)
    foreign("1.1")
    assert records.result(case) == RESULT


def test_other_versions_of_moseg_and_of_the_benchmark_are_measured_anew(case, records, monkeypatch):
    from moseg_benchmark import records as module

    people = BenchmarkCase(model=case.model, method="people")
    records.write(people, RESULT, None)
    assert records.result(people) == RESULT
    assert {"moseg", "moseg-benchmark"} <= set(asked_of(people)["versions"])
    monkeypatch.setattr(module, "__version__", "9.9")
    assert records.result(people) is None
    monkeypatch.undo()
    monkeypatch.setattr(module.metadata, "version", lambda name: "9.9")
    assert records.result(people) is None


@pytest.mark.parametrize("library", ["numpy", "scipy", "numba", "libigl", "manifold3d"])
def test_another_version_of_a_library_is_measured_anew(case, records, monkeypatch, library):
    from moseg_benchmark import records as module

    versions = dict.fromkeys(("moseg-benchmark", "numpy", "scipy", "numba", library), "1.0")

    def version(name: str) -> str:
        if name not in versions:
            raise module.metadata.PackageNotFoundError(name)
        return versions[name]

    monkeypatch.setattr(module.metadata, "version", version)
    records.write(case, RESULT, LABELS)
    assert records.result(case) == RESULT
    versions[library] = "1.1"
    assert records.result(case) is None


MEASURE = """

@hookimpl
def moseg_measures():
    return [MeasureSpec(name="length", target="foreign_bundle:long")]
"""


def test_another_version_of_a_measure_that_an_objective_may_ask_for_is_measured_anew(
    case, records, foreign, tmp_path
):
    path = tmp_path / "site" / "foreign_bundle.py"
    path.write_text(FOREIGN.replace("import Part", "import MeasureSpec, Part") + MEASURE)
    foreign("1.0")
    assert asked_of(case)["versions"]["foreign:length"] == "moseg-foreign 1.0"
    records.write(case, RESULT, LABELS)
    assert records.result(case) == RESULT
    foreign("1.1")
    assert records.result(case) is None


def test_installed_recipes_use_what_their_bundles_bring(case):
    bulldog = replace(case, recipe=load_recipe("paper_bulldog"))
    assert {"basic:convex_parts", "symmetry:mirror", "core:voronoi"} <= set(
        asked_of(bulldog)["versions"]
    )


def test_failures_and_damaged_files_are_not_taken_over(case, records, tmp_path):
    records.write(case, replace(RESULT, cost=None, failure="no disk"), LABELS)
    assert records.result(case) is None
    path, labels = tmp_path / f"{case.key}.json", tmp_path / f"{case.key}.seg"
    for damage in ("", "[1]", '{"asked": 1}', '{"asked": {}, "row": {"model": 1, "people": []}}'):
        records.write(case, RESULT, LABELS)
        path.write_text(damage)
        assert records.result(case) is None
    records.write(case, RESULT, LABELS)
    labels.write_text("0\n2\n")
    assert records.result(case) is None
    labels.write_text("0\n2\nx\n")
    assert records.labels(case) is None
    labels.unlink()
    assert records.result(case) is None
    assert records.labels(case) is None


def test_labels_of_a_run_that_ended_before_its_record_are_not_taken_over(
    case, records, monkeypatch
):
    from moseg_benchmark import records as module

    def ended(*_):
        raise KeyboardInterrupt

    records.write(case, RESULT, LABELS)
    other = stated(case, minimize="2*narrow(one) + narrow(two*) + convex_parts")
    monkeypatch.setattr(module, "write_file", ended)
    with pytest.raises(KeyboardInterrupt):
        records.write(other, RESULT, LABELS[::-1])
    monkeypatch.undo()
    assert records.labels(case).tolist() == [1, 2, 0]  # as many as those of the first run
    assert records.result(case) is None
    assert records.result(other) is None


def test_what_was_asked_reads_back_as_it_was(case):
    recipes = map(load_recipe, ("paper_octopus", "paper_bulldog", "symmetry_then_convex"))
    for asking in (divided(case), *(replace(case, recipe=recipe) for recipe in recipes)):
        asked = asked_of(asking)
        assert json.loads(json.dumps(asked)) == asked


def test_other_examples_or_another_learner_are_measured_anew(members, records):
    one, two, three, *_ = find_models(members)
    result = LearnedResult(
        model=21, category="Cup", method="learned 1", rand_index_error=0.1, cost=2.0, examples=1
    )
    case = LearnedCase(model=one, method="learned 1", examples=(two,))
    records.write(case, result, LABELS)
    assert records.result(case) == result
    assert records.result(replace(case, examples=(three,))) is None
    assert records.result(replace(case, examples=(two, three))) is None
    assert records.result(replace(case, learner="profiles(likely=0)")) is None


def test_a_learned_recipe_is_kept_for_all_seeds(members, records, recipe):
    one, two, *_ = find_models(members)
    case = LearnedCase(model=one, method="learned 1", examples=(two,))
    assert records.recipe(case) is None
    records.write_recipe(case, recipe)
    assert records.recipe(replace(case, seed=5)).statement == recipe.statement
    assert records.recipe(BenchmarkCase(model=one, method="default", recipe=recipe)) is recipe
