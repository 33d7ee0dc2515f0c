"""Jobs on what parts are asked: objectives, measures and fields of all installed bundles.

Parts are those of random partitions of the mesh on about 2000 super-elements, as a search asks
about them, and each is new when it is asked: what it must find out first counts, whatever others
would have needed it too. An objective of several parts is asked about every two that follow each
other.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import moseg_core as moseg
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_sums, link_values
from moseg_core.components.labellings import Labellings
from moseg_core.components.memo import Memo
from moseg_core.components.parameters import Parameter
from moseg_core.components.protocols import Centers
from moseg_core.testing.check import Skip
from moseg_core.testing.fixtures.trial import required_values
from speed_jobs.records import Record, Request, repeated

PARTS, LABELLINGS = 6, 20


def objectives(request: Request) -> Iterator[Record]:
    """Microseconds for a call of each objective and measure, single and of many parts at once."""
    coarse, lookup = moseg.coarsen(moseg.load(request.mesh)), Lookup()
    labels = random_partitions(coarse)

    def record(what: str, asked: Callable[[], float]) -> Record:
        asked()
        runs = tuple(asked() for _ in range(request.repeat))
        return Record(job="objectives", what=what, unit="us", runs=runs)

    for component in moseg.registry().components("objective"):
        target = component.load()
        for title, parameters in parameters_of(component.id, target.parameters).items():

            def single(target=target, given=parameters) -> float:
                return asked_singly(target, given, coarse, labels, lookup)

            def together(target=target, given=parameters) -> float:
                return asked_together(target, given, coarse, labels, lookup)

            yield record(title, single)
            if target.traits.vectorized is not None:
                yield record(f"{title}, all parts at once", together)
    for component in moseg.registry().components("measure"):

        def measured(name: str = component.id) -> float:
            spent, calls = 0.0, 0
            for made in segmentations(coarse, labels, lookup):
                start = time.perf_counter()
                for part in made.parts:
                    part.measure(name)
                spent, calls = spent + time.perf_counter() - start, calls + PARTS
            return 1e6 * spent / calls

        yield record(f"measure {component.id}", measured)


def random_partitions(shape: moseg.Shape) -> np.ndarray:
    """(LABELLINGS, F) int32: partitions around random elements, no part empty."""
    rng, voronoi, found = np.random.default_rng(0), Voronoi(shape, PARTS), []
    while len(found) < LABELLINGS:
        places = shape.points[rng.choice(shape.n_elements, PARTS, replace=False)]
        vector = voronoi.encode(Centers(positions=places, weights=np.ones(PARTS)))
        labels = voronoi.labels(vector[None])[0]
        made = moseg.Segmentation.from_labels(shape, labels, PARTS)
        if not made.summary.empty(shape.input).any():
            found.append(labels)
    return np.array(found)


def segmentations(
    shape: moseg.Shape, labels: np.ndarray, lookup: Lookup
) -> Iterator[moseg.Segmentation]:
    """New ones, of which nothing is known."""
    for row in labels:
        memo = Memo(size=0)
        yield moseg.Segmentation.from_labels(shape, row, PARTS, lookup=lookup, memo=memo)


def parameters_of(name: str, declared: tuple[Parameter, ...]) -> dict[str, Mapping[str, Any]]:
    """By title, parameters to ask an objective with."""
    if name == "basic:is":
        targets = [each.name for each in declared if each.type is moseg.Target]
        every = dict.fromkeys(targets, moseg.Target(0.5, 0.2))
        return {
            f"{name}, of the area": {"area": moseg.Target(0.1, 0.1)},
            f"{name}, of {len(every)} measures": every,
        }
    if name == "learn:likely":
        given = moseg.load_recipe("fourleg").statement.given
        call = "likely(a, kind=torso, among=looks)"
        return {name: moseg.Problem(["a"], call, given=given).terms[0].parameters}
    try:
        return {name: required_values(declared)}
    except Skip as why:
        print(f"  left out: {name}, {why}")
        return {}


def asked_singly(
    target: Any,
    parameters: Mapping[str, Any],
    shape: moseg.Shape,
    labels: np.ndarray,
    lookup: Lookup,
) -> float:
    """Microseconds for a call about a part, two parts, or all."""
    spent, calls = 0.0, 0
    for made in segmentations(shape, labels, lookup):
        subjects: list[Any] = list(made.parts)
        if target.traits.arity == "nary":
            subjects = list(itertools.pairwise(subjects))
        elif target.traits.arity == "global":
            subjects = [made]
        start = time.perf_counter()
        for subject in subjects:
            target(subject, **parameters)
        spent, calls = spent + time.perf_counter() - start, calls + len(subjects)
    return 1e6 * spent / calls


def asked_together(
    target: Any,
    parameters: Mapping[str, Any],
    shape: moseg.Shape,
    labels: np.ndarray,
    lookup: Lookup,
) -> float:
    """Microseconds for one of the same calls, all made at once by the vectorised form."""
    members = {
        "unary": np.arange(PARTS),
        "nary": np.array(list(itertools.pairwise(range(PARTS)))),
        "global": np.arange(PARTS)[None],
    }[target.traits.arity]
    rows = np.repeat(np.arange(len(labels)), len(members))
    parts = np.tile(members, (len(labels), *[1] * (members.ndim - 1)))
    made = Labellings.of(shape, labels, PARTS, lookup)
    start = time.perf_counter()
    array = moseg.PartArray(_labellings=made, _rows=rows, _parts=parts)
    target.traits.vectorized(array, **parameters)
    return 1e6 * (time.perf_counter() - start) / len(rows)


def height(shape: moseg.Shape) -> np.ndarray:
    """A field that costs next to nothing, so that what is done with it is what takes time."""
    return shape.points[:, 2]


FIELDS = moseg.Registry(
    [
        moseg.Bundle(
            *("here", "here", "0", __name__),
            (
                moseg.Component(
                    "here", "here 0", moseg.FieldSpec(name="height", target=f"{__name__}:height")
                ),
            ),
        )
    ]
)


def fields(request: Request) -> Iterator[Record]:
    """What a part pays for a field and its boundary; once per shape, each field and the links."""
    shape = moseg.load(request.mesh)
    coarse = moseg.coarsen(shape)
    lookup, labels = Lookup(FIELDS), random_partitions(coarse)
    for what, question in {
        "part.field(name).mean": lambda part: part.field("here:height").mean,
        "part.boundary.length": lambda part: part.boundary.length,
        "part.boundary.mean(name)": lambda part: part.boundary.mean("here:height"),
    }.items():

        def ask(question: Callable[[moseg.Part], object] = question) -> None:
            for made in segmentations(coarse, labels, lookup):
                for part in made.parts:
                    question(part)

        runs = repeated(ask, request.repeat, scale=1e6 / labels.shape[0] / PARTS)
        yield Record(job="fields", what=f"{what}, a part", unit="us", runs=runs)
    found, _ = lookup.field("here:height"), shape.links
    once: dict[str, tuple[moseg.Shape, Callable[[moseg.Shape], object]]] = {
        f"links of {shape.n_elements} elements": (shape, lambda fresh: fresh.links),
        "links of the super-elements, from those": (coarse, lambda fresh: fresh.links),
        "sums of a field over super-elements": (coarse, lambda new: field_sums(new, found, {})),
        "a field along the links": (coarse, lambda fresh: link_values(fresh, found, {})),
    }
    for component in moseg.registry().components("field"):
        once[f"field {component.id}, {shape.n_elements} elements"] = (
            shape,
            lambda fresh, name=component.id: moseg.field_values(fresh, name),
        )
    for what, (level, compute) in once.items():
        runs = repeated(lambda s=level, f=compute: f(replace(s)), request.repeat, scale=1e3)
        yield Record(job="fields", what=f"{what}, once", unit="ms", runs=runs)
