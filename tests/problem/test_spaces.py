"""Problems with an embedding: where the partition lives, and where each term is evaluated."""

from __future__ import annotations

import gc
import pickle
import weakref
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import EmbeddingSpec
from moseg_core.components.protocols import Batch
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ExpressionError, PluginError, ShapeError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.segment import segment
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(40, 16), 2, 0.005), name="capsule")
LABELS = ("a", "b")
CALLS: list[str] = []


class Stretched:
    """Three times as long along x as along y."""

    def __init__(self, *, by: float = 3.0) -> None:
        self.by = by

    def __call__(self, shape: Shape) -> Shape:
        CALLS.append(shape.name)
        places = (shape.geometry.vertices - shape.frame.center) * [self.by, 1.0, 1.0]
        return shape.deformed(places / 10.0, space="whatever")


class Fewer:
    """Loses an element."""

    def __call__(self, shape: Shape) -> Shape:
        return Shape.from_mesh(shape.geometry.vertices, shape.geometry.triangles[1:])


def known() -> Registry:
    specs = [
        EmbeddingSpec(name="stretched", target=f"{__name__}:Stretched"),
        EmbeddingSpec(name="fewer", target=f"{__name__}:Fewer"),
    ]
    found = tuple(Component("test", "tests 1.0", spec) for spec in specs)
    rest = [bundle for bundle in registry().bundles if bundle.name in ("core", "basic")]
    return Registry([*rest, Bundle("test", "tests", "1.0", __name__, found)])


def problem(text, **options):
    return Problem(LABELS, text, registry=known(), **options)


def halves(shape=SHAPE):
    return (shape.points[:, 0] > np.median(shape.points[:, 0])).astype(int)


def test_each_term_is_evaluated_where_it_says():
    text = "narrow(a) @ stretched + 2*narrow(a) @ original + convex_parts"
    found = problem(text, embedding="stretched", space="stretched")
    assert [term.space for term in found.terms] == ["stretched", "original", "stretched"]
    evaluation = found.evaluate(SHAPE, halves())
    bent = found.embed(SHAPE)
    there = Segmentation.from_labels(bent, halves(), 2)
    here = Segmentation.from_labels(SHAPE, halves(), 2)

    def narrow(part):
        s1, s2, s3 = part.scales
        return (s2 + s3) / (2 * s1)

    values = [term.calls[0].value for term in evaluation.terms]
    assert values[0] == pytest.approx(narrow(there.parts[0]))
    assert values[1] == pytest.approx(narrow(here.parts[0]))
    assert abs(values[0] - values[1]) > 0.01
    plain = problem("convex_parts").evaluate(bent, halves()).cost.value
    assert values[2] == pytest.approx(plain)
    assert [term.text for term in evaluation.terms][:2] == [
        "narrow(a) @ stretched",
        "narrow(a) @ original",
    ]


def test_a_view_has_the_same_parts_elsewhere():
    bent = problem("narrow(a)", embedding="stretched").embed(SHAPE)
    segmentation = Segmentation.from_labels(bent, halves(), 2)
    original = segmentation.view("original")
    assert original.shape is SHAPE
    assert segmentation.view("stretched") is segmentation
    assert original is segmentation.view("original")
    for part, image in zip(original.parts, segmentation.parts, strict=True):
        assert part.membership == image.membership
        assert part.area != pytest.approx(image.area)
    with pytest.raises(ShapeError, match="'capsule' is not known in the space 'mds'"):
        segmentation.view("mds")


def test_a_deformed_shape_is_a_shape_in_full():
    twice = SHAPE.deformed(2 * SHAPE.geometry.vertices, space="twice")
    assert twice.areas == pytest.approx(4 * SHAPE.areas)
    assert twice.volume == pytest.approx(8 * SHAPE.volume)
    assert (twice.space, twice.original, twice.adjacency) == ("twice", SHAPE, SHAPE.adjacency)
    assert twice.key != SHAPE.key
    mirrored = SHAPE.deformed(SHAPE.geometry.vertices * [-1, 1, 1], space="mirrored")
    assert mirrored.volume == pytest.approx(SHAPE.volume)
    flat = SHAPE.deformed(SHAPE.geometry.vertices * [1, 1, 0], space="flat")
    assert flat.volume is None
    with pytest.raises(ShapeError, match="a finite place for each of its"):
        SHAPE.deformed(SHAPE.geometry.vertices[1:], space="short")


def test_coarse_shapes_have_both_spaces():
    bent = problem("narrow(a)", embedding="stretched").embed(SHAPE)
    coarse = coarsen(bent, 100)
    assert coarse.original is not None
    assert (coarse.original.members == coarse.members).all()
    assert coarse.original.fine is SHAPE
    labels = np.arange(coarse.n_elements) % 2
    on_both = Segmentation.from_labels(coarse, labels, 2)
    view = on_both.view("original")
    assert view.shape is SHAPE
    exact = Segmentation.from_labels(SHAPE, labels[coarse.members], 2)
    assert view.parts[0].scales == pytest.approx(exact.parts[0].scales)


def test_costs_of_batches_are_those_of_single_evaluations():
    text = "narrow(a) @ original + ellipsoidal(b) @ stretched + convex_parts"
    found = problem(text, embedding="stretched")
    bent = found.embed(SHAPE)
    evaluator = ProblemEvaluator(bent, found, Voronoi(bent, 2))
    rng = np.random.default_rng(0)
    rows = rng.uniform(-0.3, 0.3, (6, 2, 4))
    rows[:, :, 3] = 1.0
    vectors = rows.reshape(6, -1)
    costs = evaluator.costs(Batch(vectors=vectors))
    for vector, cost in zip(vectors, costs, strict=True):
        fresh = found.evaluate(bent, evaluator.labels(vector)).cost
        assert cost == fresh


@pytest.mark.parametrize("resolution", ["full", 100])
def test_a_run_lives_in_the_embedding_and_is_told_on_the_original(resolution):
    text = "narrow(a) @ original + narrow(b)"
    found = problem(text, embedding="stretched", space="stretched")
    result = segment(SHAPE, found, seed=0, resolution=resolution, workers=2, restarts=2)
    assert result.shape is SHAPE
    assert result.partitioned.space == "stretched"
    assert result.parts["a"].shape is SHAPE
    partition = Voronoi(result.partitioned, 2)
    again = partition.labels(partition.encode(result.centers)[None])[0]
    assert (again == result.labels).all()
    assert result.cost == found.evaluate(SHAPE, result.labels).cost.value
    assert result.method["embedding"] == "stretched"
    assert result.versions["test:stretched"] == "tests 1.0"


def test_an_embedding_is_computed_once_and_only_where_it_is_needed():
    CALLS.clear()
    found = problem("narrow(a) @ original", embedding="stretched(by=2)")
    found.evaluate(SHAPE, halves())
    assert CALLS == []
    first = found.embed(SHAPE)
    assert found.embed(SHAPE) is first
    assert CALLS == ["capsule"]
    assert (first.space, first.original) == ("stretched", SHAPE)
    # Another problem with the same embedding shares it; other parameters are another embedding.
    assert problem("flat(a)", embedding="stretched(by=2)").embed(SHAPE) is first
    assert problem("flat(a)", embedding="stretched(by=3)").embed(SHAPE) is not first


def test_a_problem_keeps_no_shape_alive_that_it_embedded():
    found = problem("narrow(a)", embedding="stretched(by=2)")
    shape = Shape.from_mesh(SHAPE.geometry.vertices, SHAPE.geometry.triangles)
    found.embed(shape)
    assert len(pickle.dumps(shape)) < 1.1 * len(pickle.dumps(replace(shape)))
    shape = weakref.ref(shape)
    gc.collect()
    assert shape() is None


@pytest.mark.parametrize(
    ("text", "options", "kind", "message"),
    [
        (
            "narrow(a) @ mds",
            {},
            ExpressionError,
            "there is no space .mds. in .*; give the embedding .mds. too",
        ),
        (
            "narrow(a) @ strethced",
            {"embedding": "stretched"},
            ExpressionError,
            "unknown space 'strethced' in .*; did you mean 'stretched'",
        ),
        ("narrow(a)", {"space": "mds"}, UsageError, "unknown space 'mds'.*give the embedding too"),
        (
            "narrow(a)",
            {"embedding": "streched"},
            UsageError,
            "unknown embedding 'streched'; did you mean 'stretched'",
        ),
        (
            "narrow(a)",
            {"embedding": "stretched(bye=2)"},
            UsageError,
            "unknown parameter 'bye'; did you mean 'by'",
        ),
    ],
)
def test_what_is_wrong_is_named_before_a_shape_is_there(text, options, kind, message):
    with pytest.raises(kind, match=message):
        problem(text, **options)


def test_an_embedding_that_loses_elements_is_named():
    with pytest.raises(PluginError, match=r"'test:fewer' of tests 1\.0 must return a Shape of"):
        problem("narrow(a)", embedding="fewer").embed(SHAPE)
