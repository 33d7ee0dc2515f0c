"""A stranger's distribution gets what the core's own components get.

A real one, with its metadata: an optimizer that polishes, a seeder with settings, another that
takes centres by hand, parameterizations whose boundaries can be clipped or not.
"""

from __future__ import annotations

import sys

import numpy as np
import pytest

from moseg_core.cli import main
from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.discovery.registry import registry
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.clipped_result import clip
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.clipping.checks import assert_valid

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(40, 16), 2, 0.005), name="capsule")

ACME = '''
    import numpy as np
    from moseg_core import (
        Batch, Centers, Cost, OptimizerSpec, ParameterizationSpec, SeederSpec, Seeding, hookimpl,
    )

    @hookimpl
    def moseg_optimizers():
        return [
            OptimizerSpec(name=name, target=f"acme_parts:{name.title()}")
            for name in ("walk", "stroll", "trip")
        ]

    @hookimpl
    def moseg_seeders():
        return [
            SeederSpec(name="spread", target="acme_parts:Spread"),
            SeederSpec(name="clicks", target="acme_parts:Clicks", takes_centers=True),
        ]

    @hookimpl
    def moseg_parameterizations():
        return [
            ParameterizationSpec(name=name, target=f"acme_parts:{name.title()}")
            for name in ("blocks", "secret", "vague", "plain")
        ]

    class Stroll:
        """Random steps, as many as it is told to."""

        def __init__(self, start, lower, upper, scale, /, *, rng, steps: int = 40):
            self.at, self.cost, self.rng, self.steps, self.asked = start, None, rng, steps, None
            self.lower, self.upper, self.scale, self.history = lower, upper, scale, ()

        @property
        def finished(self):
            return "converged" if len(self.history) >= self.steps else ""

        @property
        def best(self):
            return self.at, self.cost

        progress = 0.5

        def ask(self):
            self.asked = self.at
            if self.cost is not None:
                step = 0.02 * self.scale * self.rng.standard_normal(len(self.at))
                self.asked = np.clip(self.at + step, self.lower, self.upper)
            return Batch(vectors=self.asked[None])

        def tell(self, costs):
            if self.cost is None or costs[0] < self.cost:
                self.at, self.cost = self.asked, costs[0]
            record = {"value": self.cost.value, "empty": self.cost.empty, "steps": self.steps}
            self.history = (*self.history, record)

    class Walk(Stroll):
        presets = {"default": {"steps": 33}, "coarse": {"steps": 9}, "polish": {"steps": 5}}

    class Trip(Stroll):
        presets = {"polish": {"stepps": 5}}

    class Spread:
        presets = {"default": {"apart": 3}}

        def __init__(self, *, apart: int = 1):
            self.apart = apart

        def __call__(self, evaluator, *, rng, report):
            n = evaluator.parameterization.n_parts
            return Seeding(centers=evaluator.shape.points[: self.apart * n : self.apart])

    class Clicks:
        """Centres by hand: numbers with spaces between."""

        def __init__(self, *, centers: str, factor: float = 1.0):
            self.centers = factor * np.array(centers.split(), float).reshape(-1, 3)

        def __call__(self, evaluator, *, rng, report):
            return Seeding(centers=self.centers, labelled=True)

    class Plain:
        """Voronoi partitions without weights, unconnected, that say nothing of boundaries."""

        def __init__(self, shape, n_parts):
            self.shape, self.n_parts = shape, n_parts
            self.lower, self.upper = np.full(3 * n_parts, -np.inf), np.full(3 * n_parts, np.inf)
            self.scale = np.ones(3 * n_parts)

        def labels(self, vectors):
            points = self.shape.points
            return np.array([self.apart(v, points).argmin(axis=1) for v in vectors], np.int32)

        def apart(self, vector, points):
            unit = self.shape.frame.to_unit(points)
            return np.linalg.norm(unit[:, None] - vector.reshape(-1, 3), self.order, axis=2)

        order = 2

        def encode(self, centers):
            return self.shape.frame.to_unit(centers.positions).ravel()

        def decode(self, vector):
            positions = self.shape.frame.to_model(vector.reshape(-1, 3))
            return Centers(positions=positions, weights=np.ones(self.n_parts))

        def coordinates(self, part):
            return np.arange(3 * part, 3 * part + 3)

        def permute(self, vector, order):
            return vector.reshape(-1, 3)[order].ravel()

    class Blocks(Plain):
        """The largest difference of coordinates is what counts."""

        order = np.inf

        def distances(self, vector, points):
            return self.apart(vector, points)

    class Secret(Plain):
        weighted_bisectors = True

    class Vague(Plain):
        def distances(self, vector, points):
            return np.full((len(points), self.n_parts), np.nan)
'''


@objective(range=(0, 1))
def slim(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


@pytest.fixture
def acme(site):
    """The registry of the core and the stranger's bundle."""
    site.add("moseg-core", bundles={"core": "moseg_core.builtin.plugin"})
    site.add("moseg-acme", "2.0", bundles={"acme": "acme_parts"}, acme_parts=ACME)
    return site.discover()


@pytest.fixture
def run(acme):
    def start(**options):
        problem = Problem(
            ["one", "other"],
            "slim(one) + 2*slim(other)",
            objectives={"slim": slim},
            registry=acme,
        )
        few = {"restarts": 1, "resolution": 150, "optimizer": "pattern_search"}
        return segment(SHAPE, problem, **{**few, **options})

    return start


# --- presets -------------------------------------------------------------------------------------


def test_an_optimizer_that_says_how_polishes_itself(run):
    found = run(optimizer="walk")
    assert found.method["optimizer"] == "acme:walk(steps=9)"
    assert [record["steps"] for record in found.history["search"]] == [9] * 9
    assert [record["steps"] for record in found.history["polish"]] == [5] * 5
    assert found.cost == found.history["polish"][-1]["value"]


def test_what_the_user_says_of_an_optimizer_is_about_the_search(run):
    found = run(optimizer="walk(steps=12)")
    assert found.method["optimizer"] == "acme:walk(steps=12)"
    assert [record["steps"] for record in found.history["polish"]] == [5] * 5


def test_on_the_elements_themselves_the_settings_decide(run):
    assert run(optimizer="walk", resolution="full").method["optimizer"] == "acme:walk(steps=33)"
    paper = run(optimizer="walk", settings="paper")
    assert paper.method["optimizer"] == "acme:walk"
    assert len(paper.history["search"]) == 40


def test_for_an_optimizer_that_says_nothing_the_default_one_polishes(run):
    found = run(optimizer="stroll")
    assert found.method["optimizer"] == "acme:stroll"
    assert len(found.history["search"]) == 40
    polish = found.history["polish"]
    assert polish[0]["step"] == 0.01
    assert polish[-1]["evaluations"] <= 300
    assert found.versions["core:pattern_search"].startswith("moseg-core ")
    assert "core:pattern_search" not in run(optimizer="walk").versions


def test_the_default_optimizer_is_found_whatever_else_has_its_name(site, acme, run):
    site.add(
        "moseg-rival",
        bundles={"rival": "rival_parts"},
        rival_parts="""
            from moseg_core import OptimizerSpec, hookimpl

            @hookimpl
            def moseg_optimizers():
                return [OptimizerSpec(name="pattern_search", target="acme_parts:Walk")]
        """,
    )
    problem = Problem(
        ["one", "other"], "slim(one)", objectives={"slim": slim}, registry=site.discover()
    )
    found = segment(SHAPE, problem, restarts=1, resolution=150)
    assert found.method["optimizer"] == "core:pattern_search(threshold=0.005)"


def test_a_seeder_is_tuned_to_the_settings(run):
    few = {"optimizer": "walk", "resolution": "full"}
    assert run(seeder="spread", **few).method["seeder"] == "acme:spread(apart=3)"
    assert run(seeder="spread(apart=2)", **few).method["seeder"] == "acme:spread(apart=2)"
    assert run(seeder="spread", settings="paper", **few).method["seeder"] == "acme:spread"


@pytest.mark.parametrize(
    ("presets", "how"),
    [
        ({"polish": {"stepps": 5}}, "unknown parameter 'stepps'; did you mean 'steps'"),
        ({"polsh": {"steps": 5}}, "unknown occasion 'polsh'; did you mean 'polish'"),
        ({"coarse": {"steps": 2.5}}, "'steps' must be whole"),
        ({"coarse": 5}, "not iterable"),
        (["coarse"], "no attribute 'items'"),
    ],
)
def test_presets_that_cannot_be_are_refused_before_the_search(acme, presets, how):
    choice = Choice("trip")
    acme.find("optimizer", "trip").load().presets = presets
    with pytest.raises(
        PluginError, match=rf"optimizer 'acme:trip' of moseg-acme 2\.0 has impossible .*{how}"
    ):
        prepare(choice, "optimizer", acme)


# --- centres by hand -----------------------------------------------------------------------------

ENDS = " ".join(str(x) for x in [*SHAPE.points[3], *SHAPE.points[-3]])


def test_centres_by_hand_are_about_the_first_level_only(acme):
    problem = Problem(["one", "other"], "slim(one)", objectives={"slim": slim}, registry=acme)
    found = segment_hierarchy(
        SHAPE,
        Hierarchy(problem, {"one": problem}),
        seeder={"name": "clicks", "centers": ENDS},
        optimizer="walk(steps=1)",
    )
    assert found.method["seeder"].startswith("acme:clicks(centers=")
    assert found.method["one: seeder"] == "core:kmeans(outliers=0.001)"


def test_a_seeder_that_says_that_it_takes_centres_must(acme):
    def deaf(evaluator, *, rng, report): ...

    sys.modules["acme_parts"].Clicks = type("Deaf", (), {"__call__": deaf})
    with pytest.raises(PluginError, match=r"'acme:clicks' .* has no parameter 'centers'"):
        prepare(Choice("clicks"), "seeder", acme)


@pytest.fixture
def command(acme, tmp_path, capsys):
    """``moseg segment`` with the stranger's bundle installed; exit code and messages."""
    registry.cache_clear()
    lines = ["OFF", f"{len(SHAPE.geometry.vertices)} {SHAPE.n_elements} 0"]
    lines += [" ".join(repr(float(x)) for x in v) for v in SHAPE.geometry.vertices]
    sizes = np.diff(SHAPE.geometry.offsets)
    rows = np.split(SHAPE.geometry.corners, SHAPE.geometry.offsets[1:-1])
    lines += [f"{n} {' '.join(map(str, row))}" for n, row in zip(sizes, rows, strict=True)]
    shape = tmp_path / "capsule.off"
    shape.write_text("\n".join(lines) + "\n")
    task = ["--labels", "one,other", "--minimize", "narrow(one)", "--optimizer", "walk(steps=3)"]

    def start(*words):
        with pytest.raises(SystemExit) as ended:
            main(["segment", str(shape), *task, *(str(word) for word in words)])
        return ended.value.code, capsys.readouterr().err

    yield start
    registry.cache_clear()


def test_centers_go_to_a_seeder_that_takes_them(command, tmp_path):
    out = tmp_path / "out.json"
    code, messages = command("--seeder", "clicks(factor=1)", f"--centers={ENDS}", "-o", out)
    assert code == 0, messages
    assert "acme:clicks(factor=1, centers=" in out.read_text()
    by_hand = ",".join(
        f"{label}={','.join(ENDS.split()[k : k + 3])}" for label, k in (("one", 0), ("other", 3))
    )
    code, messages = command("--centers", by_hand, "-o", out)
    assert code == 0, messages
    assert "core:given(centers=" in out.read_text()


def test_centers_do_not_go_to_other_seeders(command):
    code, messages = command("--seeder", "spread", f"--centers={ENDS}")
    assert code == 2
    assert "a seeder that takes centres, 'core:given' or 'acme:clicks', not 'spread'" in messages


# --- clipping ------------------------------------------------------------------------------------


def test_a_parameterization_that_knows_distances_is_clipped(run):
    found = run(parameterization="blocks", optimizer="walk")
    smooth = clip(found)
    assert len(smooth.clipped.labels) > SHAPE.n_elements
    assert_valid(SHAPE.geometry, found.labels, smooth.clipped)
    fresh = smooth.clipped.mesh.vertices[len(SHAPE.geometry.vertices) :]
    apart = np.abs(fresh[:, None] - found.centers.positions).max(axis=2)
    assert len(fresh) > 10
    np.testing.assert_allclose(apart[:, 0], apart[:, 1], atol=1e-9)


def test_a_parameterization_that_has_weighted_bisectors_is_clipped_along_them(run):
    found = run(parameterization="secret", optimizer="walk")
    fresh = clip(found).clipped.mesh.vertices[len(SHAPE.geometry.vertices) :]
    apart = np.linalg.norm(fresh[:, None] - found.centers.positions, axis=2)
    assert len(fresh) > 10
    np.testing.assert_allclose(apart[:, 0], apart[:, 1], atol=1e-9)


def test_a_parameterization_that_knows_neither_is_refused_by_name(run):
    found = run(parameterization="plain", optimizer="walk")
    with pytest.raises(
        UsageError,
        match=r"parameterization 'acme:plain' of moseg-acme 2\.0 cannot be clipped",
    ):
        clip(found)


def test_distances_are_checked(run):
    found = run(parameterization="vague", optimizer="walk")
    with pytest.raises(PluginError, match=r"'acme:vague' .* must give finite distances"):
        clip(found)


def test_on_the_command_line_it_is_refused_before_the_search(command, tmp_path):
    out = tmp_path / "out.ply"
    code, messages = command("--parameterization", "plain", "--clip", "-o", out)
    assert code == 2
    assert "parameterization 'acme:plain' of moseg-acme 2.0 cannot be clipped" in messages
    assert len(messages.strip().splitlines()) == 1
    assert not out.exists()
    code, messages = command("--parameterization", "blocks", "--clip", "-o", out)
    assert code == 0, messages
    assert "faces into" in messages
