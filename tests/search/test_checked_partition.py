"""A stranger's parameterization: each answer is checked, and it is the one that is named."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from moseg_core.builtin.kmeans import KMeans
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, Parameterization
from moseg_core.errors import PluginError, ShapeError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.checked_partition import (
    CheckedParameterization,
    checked,
    make_partition,
)
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from moseg_core.testing.fixtures.shapes import specimen
from tests import shapes
from tests.made_up import stranger

SHAPE = Shape.from_mesh(*shapes.strip(8))
WHO = "parameterization 'acme:odd' of moseg-acme 2.0"


@objective(range=(0, 1))
def share(part: Part) -> float:
    return part.area / part.shape.area


def answering(**answers):
    """Voronoi partitions some of whose methods and attributes answer otherwise."""

    def method(answer):
        return lambda self, *given: answer(*given) if callable(answer) else answer

    bounds = ("n_parts", "lower", "upper", "scale", "centers_per_part")
    made = {
        name: property(method(answer)) if name in bounds else method(answer)
        for name, answer in answers.items()
    }
    return type("Odd", (Voronoi,), made)


def odd(**answers):
    return CheckedParameterization(answering(**answers)(SHAPE, 2), SHAPE, who=WHO)


def fail(*given):
    raise KeyError("no idea")


def labelled(value, dtype=np.int32):
    def labels(vectors):
        found = np.zeros((len(vectors), SHAPE.n_elements), dtype)
        found[-1, 3] = value
        return found

    return labels


CENTERS = Centers(positions=SHAPE.points[[0, 7]], weights=np.ones(2))
VECTOR = Voronoi(SHAPE, 2).encode(CENTERS)


def test_what_is_sound_passes_as_it_is():
    plain, same = Voronoi(SHAPE, 2), odd()
    vectors = np.stack([VECTOR, VECTOR + 0.1])
    assert isinstance(same, Parameterization)
    assert same.n_parts == 2
    for name in ("lower", "upper", "scale"):
        assert (getattr(same, name) == getattr(plain, name)).all()
    assert same.labels(vectors).tobytes() == plain.labels(vectors).tobytes()
    assert same.labels(vectors[:0]).shape == (0, 8)
    assert same.encode(CENTERS).tobytes() == VECTOR.tobytes()
    assert (same.decode(VECTOR).positions == plain.decode(VECTOR).positions).all()
    assert same.coordinates(1).tolist() == [4, 5, 6, 7]
    assert (same.permute(VECTOR, np.array([1, 0])) == VECTOR.reshape(2, 4)[::-1].ravel()).all()
    assert checked(same, SHAPE) is same


@pytest.mark.parametrize("dtype", [np.int64, np.uint8, np.int16])
def test_whole_numbers_of_another_type_are_taken_over(dtype):
    found = odd(labels=labelled(1, dtype)).labels(VECTOR[None])
    assert found.dtype == np.int32
    assert found[0].tolist() == [0, 0, 0, 1, 0, 0, 0, 0]


def test_it_says_of_itself_what_the_one_inside_says():
    assert odd().connected is True
    with pytest.raises(AttributeError, match="convex"):
        _ = odd().convex
    # Copies are made without the constructor, and must not look for what is not there yet.
    for other in (copy.copy(odd()), pickle.loads(pickle.dumps(checked(Voronoi(SHAPE, 2), SHAPE)))):
        assert other.labels(VECTOR[None]).shape == (1, 8)


@pytest.mark.parametrize(
    ("labels", "how"),
    [
        (labelled(2), "gave labels from 0 to 2, and must give 0 to 1"),
        (labelled(2_000_000), "gave labels from 0 to 2000000"),
        (labelled(-1), "gave labels from -1 to 0"),
        (labelled(2**32, np.int64), "gave labels from 0 to 4294967296"),
        (labelled(7, np.uint8), "gave labels from 0 to 7"),
        (labelled(0, np.float64), "must give whole numbers of shape .* not float64"),
        (labelled(0, np.bool_), "not bool"),
        (lambda vectors: np.zeros((len(vectors), 7), np.int32), r"not int32 of shape \(1, 7\)"),
        (lambda vectors: np.zeros(8, np.int32), r"not int32 of shape \(8,\)"),
        (lambda vectors: None, "must give whole numbers"),
        (lambda vectors: [[0, 1], [0]], r"must return an array from labels\(\)"),
        (fail, r"failed in labels\(\): KeyError: 'no idea'"),
    ],
)
def test_wrong_labels_are_refused(labels, how):
    with pytest.raises(PluginError, match=f"^{WHO} .*{how}"):
        odd(labels=labels).labels(VECTOR[None])


@pytest.mark.parametrize(
    ("name", "answer"),
    [
        ("encode", fail),
        ("encode", np.zeros(7)),
        ("encode", np.full(8, np.nan)),
        ("encode", "centres"),
        ("permute", fail),
        ("permute", np.zeros((2, 4))),
        ("permute", np.full(8, np.inf)),
        ("decode", fail),
        ("decode", None),
        ("decode", Centers(positions=np.zeros((2, 2)), weights=np.ones(2))),
        ("decode", Centers(positions=np.zeros((2, 3)), weights=np.full(2, np.nan))),
        ("coordinates", fail),
        ("coordinates", [6, 7, 8]),
        ("coordinates", [-1]),
        ("coordinates", []),
        ("coordinates", [0.0, 1.0]),
    ],
)
def test_other_wrong_answers_are_refused(name, answer):
    asked = {
        "encode": (CENTERS,),
        "permute": (VECTOR, np.array([1, 0])),
        "decode": (VECTOR,),
        "coordinates": (0,),
    }
    with pytest.raises(PluginError, match=f"^{WHO} (must|failed in {name})"):
        getattr(odd(**{name: answer}), name)(*asked[name])


@pytest.mark.parametrize(
    ("answers", "how"),
    [
        ({"lower": np.zeros(7)}, "one number per coordinate"),
        ({"lower": "low"}, "numbers as lower"),
        ({"upper": np.full(8, -np.inf)}, "has a lower bound that is not below the upper one"),
        ({"upper": np.full(8, np.nan)}, "has a lower bound"),
        ({"scale": np.zeros(8)}, "positive, finite numbers as scale"),
        ({"scale": fail}, "cannot say its scale: KeyError"),
        ({"n_parts": 2.0}, "a whole number of parts, not 2.0"),
    ],
)
def test_bounds_that_cannot_be_searched_in_are_refused(answers, how):
    with pytest.raises(PluginError, match=f"^{WHO} .*{how}"):
        odd(**answers)


@pytest.mark.parametrize(
    "ask",
    [
        lambda it: it.labels(VECTOR),
        lambda it: it.labels(VECTOR[None, :5]),
        lambda it: it.encode(Centers(positions=np.zeros((3, 3)), weights=np.ones(3))),
        lambda it: it.decode(VECTOR[None]),
        lambda it: it.permute(VECTOR[:4], np.array([1, 0])),
        lambda it: it.permute(VECTOR, np.array([1])),
        lambda it: it.coordinates(2),
    ],
)
def test_a_wrong_question_is_the_mistake_of_who_asks(ask):
    with pytest.raises(ValueError, match="takes"):
        ask(odd())


def test_numbers_that_are_not_finite_come_from_who_gave_them():
    nowhere = Centers(positions=np.full((2, 3), np.nan), weights=np.ones(2))
    assert np.isnan(odd().encode(nowhere)).any()
    assert np.isnan(odd().decode(np.full(8, np.nan)).positions).all()


# --- in a run ------------------------------------------------------------------------------------


@pytest.mark.parametrize("label", [2, 7, 2_000_000, -1])
def test_labels_of_no_part_do_not_reach_k_means(label):
    problem = Problem(["a", "b"], "share(a)", objectives={"share": share})
    partition = answering(labels=labelled(label))(SHAPE, 2)
    evaluator = ProblemEvaluator(SHAPE, problem, partition)
    with pytest.raises(PluginError, match=r"^parameterization Odd of the calling program gave"):
        KMeans()(evaluator, rng=np.random.default_rng(0), report=lambda progress: False)


BUNDLE = """
    import numpy as np
    from moseg_core import MeasureSpec, ParameterizationSpec, SeederSpec, hookimpl
    from moseg_core.builtin.voronoi import Voronoi

    @hookimpl
    def moseg_parameterizations():
        return [
            ParameterizationSpec(name=name, target=f"acme_parts:{name}")
            for name in ("beyond", "raises", "other")
        ] + [
            ParameterizationSpec(name="filled", target="acme_parts:Voronoi", requires=("volume",))
        ]

    @hookimpl
    def moseg_seeders():
        return [SeederSpec(name="careless", target="acme_parts:careless")]

    @hookimpl
    def moseg_measures():
        return [
            MeasureSpec(name="girth", target="acme_parts:girth"),
            MeasureSpec(name="bore", target="acme_parts:bore", requires=("volume",)),
        ]

    class beyond(Voronoi):
        def labels(self, vectors):
            return super().labels(vectors) + 2_000_000

    class raises(Voronoi):
        def labels(self, vectors):
            raise ZeroDivisionError("no idea")

    class other(Voronoi):
        def __init__(self, shape, n_parts):
            super().__init__(shape, n_parts + 1)

    class careless:
        def __call__(self, evaluator, *, rng, report):
            evaluator.parameterization.labels(np.zeros(3))

    def bore(part):
        return part.area / part.shape.volume

    def girth(part):
        raise ArithmeticError("no girth")
"""


@objective(range=(0, 1))
def girthy(part: Part) -> float:
    return part.measure("acme:girth")


@objective(measures=("acme:bore",))
def bored(part: Part) -> float:
    return part.measure("acme:bore")


@objective()
def secretly(part: Part) -> float:
    return part.measure("acme:bore")


@pytest.fixture
def run(site):
    """Search with components of the bundle ``acme``."""
    site.add("moseg-core", bundles={"core": "moseg_core.builtin.plugin"})
    site.add("moseg-acme", "2.0", bundles={"acme": "acme_parts"}, acme_parts=BUNDLE)
    registry = site.discover()
    objectives = {"share": share, "girthy": girthy, "bored": bored, "secretly_bored": secretly}

    def start(text="share(a)", shape=SHAPE, **options):
        problem = Problem(["a", "b"], text, objectives=objectives, registry=registry)
        return segment(shape, problem, **{"optimizer": "pattern_search", **options})

    return start


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("beyond", "gave labels from 2000000 to 2000001"),
        ("raises", r"failed in labels\(\): ZeroDivisionError: no idea"),
        ("other", "was asked for 2 parts, and makes 3"),
    ],
)
@pytest.mark.parametrize("seeder", ["kmeans", "evolution"])
def test_a_parameterization_is_blamed_and_not_the_seeder(run, name, how, seeder):
    with pytest.raises(
        PluginError, match=rf"^parameterization 'acme:{name}' of moseg-acme 2\.0 {how}"
    ):
        run(parameterization=name, seeder=seeder)


def test_a_seeder_that_asks_wrongly_is_blamed_and_not_the_parameterization(run):
    with pytest.raises(PluginError, match=r"^seeder 'acme:careless' of moseg-acme 2\.0 failed"):
        run(seeder="careless")


def test_a_measure_is_blamed_and_not_the_objective(run):
    with pytest.raises(
        PluginError,
        match=r"in 'girthy\(a\)' for a.*: measure 'acme:girth' of moseg-acme 2\.0 failed:"
        " ArithmeticError: no girth",
    ) as caught:
        run("girthy(a)")
    assert "objective" not in str(caught.value)


@pytest.mark.parametrize(
    "wrong", [3, [1], [0, 1], [1, 1.5], "12", [[1], [1]]], ids=lambda wrong: str(wrong)
)
def test_centres_a_part_are_whole_numbers(wrong):
    with pytest.raises(PluginError, match="must have a whole number of centres for each of 2 par"):
        odd(centers_per_part=lambda: wrong)


def test_centres_a_part_are_those_that_it_says():
    assert odd().centers_per_part.tolist() == [1, 1]
    body = checked(Voronoi(SHAPE, 2, centers="b=2", labels=["a", "b"]), SHAPE)
    assert body.centers_per_part.tolist() == [1, 2]
    own = Centers(positions=SHAPE.points[:3], weights=np.ones(3), parts=np.array([0, 1, 1]))
    assert body.decode(body.encode(own)).parts.tolist() == [0, 1, 1]
    assert body.encode(CENTERS).shape == (12,)
    for parts in (None, np.array([0, 0, 1]), np.array([1, 1, 0]), np.array([0, 1, 2])):
        wrong = Centers(positions=own.positions, weights=own.weights, parts=parts)
        with pytest.raises(ValueError, match=r"takes 2 centres or \[1, 2\] for each part"):
            body.encode(wrong)
    less = odd(centers_per_part=lambda: np.array([1, 2]))
    with pytest.raises(PluginError, match=r"to 3 finite centres, \[1, 2\] for each part"):
        less.decode(VECTOR)


def test_who_takes_labels_is_told_them():
    told = []

    class Told(Voronoi):
        def __init__(self, shape, n_parts, *, labels, expected_shares):
            told.extend([labels, expected_shares.tolist()])
            super().__init__(shape, n_parts)

    class Asks(Voronoi):
        def __init__(self, shape, n_parts):
            super().__init__(shape, n_parts)

    @objective(range=(0, 1), share=lambda given: 0.4)
    def big(part: Part) -> float:
        return part.area

    problem = Problem(["a", "b"], "big(a, b)", objectives={"big": big})
    make_partition(stranger("parameterization", Told), SHAPE, problem)
    make_partition(stranger("parameterization", Asks), SHAPE, problem)
    assert told == [("a", "b"), [0.4, 0.4]]
    auto = make_partition(stranger("parameterization", Voronoi, centers="auto"), SHAPE, problem)
    assert auto.centers_per_part.tolist() == [3, 3]


def test_a_start_that_is_not_finite_is_still_the_users(run):
    nowhere = Centers(positions=np.full((2, 3), np.nan), weights=np.ones(2))
    with pytest.raises(UsageError, match="the start must have finite centres"):
        run(start=nowhere)


FLAT = Shape.from_mesh(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]],
    [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]],
    name="flat",
)


def test_a_shape_that_lacks_what_a_parameterization_requires_is_refused_before_the_search(run):
    asked = []
    with pytest.raises(
        ShapeError,
        match=r"^parameterization 'acme:filled' needs an enclosed volume, but 'flat' encloses none:"
        ".*; repair the mesh, choose another parameterization or have it estimated",
    ) as caught:
        run(shape=FLAT, parameterization="filled", report=lambda progress: asked.append(progress))
    assert asked == []
    assert caught.value.exit_code == 3
    assert run(shape=specimen("lump"), parameterization="filled", restarts=1).shape.n_elements > 99


def test_a_shape_that_lacks_what_a_measure_requires_is_refused_before_the_search(run):
    asked = []
    with pytest.raises(ShapeError, match=r"^'bored' needs an enclosed volume, but 'flat' enc"):
        run("bored(a)", shape=FLAT, report=lambda progress: asked.append(progress))
    assert asked == []
    assert run("bored(a)", shape=specimen("lump"), restarts=1).shape.n_elements > 99


def test_a_measure_that_was_not_declared_refuses_the_shape_in_its_own_name(run):
    with pytest.raises(
        ShapeError,
        match=r"in 'secretly_bored\(a\)' .*: measure 'acme:bore' needs an enclosed volume",
    ):
        run("secretly_bored(a)", shape=FLAT)
