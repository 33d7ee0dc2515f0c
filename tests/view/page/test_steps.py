"""The steps of a search for a page: labels on the way, and how they are packed."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from moseg_core.view.page import steps as module
from moseg_core.view.page.content import PageContent
from moseg_core.view.page.document import page_document
from moseg_core.view.page.steps import Step, packed_changes, runs, search_steps
from tests import shapes
from tests.results import result_on

TEE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")
PROBLEM = Problem(["stem", "bar"], "3*narrow(stem) + perpendicular(stem, bar)")


@pytest.fixture(scope="module")
def found():
    return segment(TEE, PROBLEM, restarts=1, optimizer="pattern_search(threshold=0.02)")


def applied(base, packed):
    """Labels from a base and what is different: the reader's part, as ``steps.js`` has it."""
    labels, numbers, value, shift = base.copy(), [], 0, 0
    for byte in packed:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(value)
            value = shift = 0
    place = 0
    for skipped, length, label in zip(*[iter(numbers)] * 3, strict=True):
        place += skipped
        labels[place : place + length] = label
        place += length
    return labels


LABELS = arrays.arrays(np.int64, 700, elements=st.integers(0, 300))


@given(LABELS, LABELS, st.integers(1, 90))
def test_runs_lead_from_one_labelling_to_the_other(base, labels, length):
    labels = np.repeat(labels, length)[: len(base)]
    assert applied(base, runs(base, labels)).tolist() == labels.tolist()
    assert runs(base, base) == b""


def test_each_step_has_the_partition_of_its_centres(found):
    steps = search_steps(found).before
    assert len(steps) == len(found.incumbents) - 1
    voronoi = Voronoi(TEE, 2)
    for step, incumbent in zip(steps, found.incumbents, strict=False):
        alone = voronoi.labels(voronoi.encode(incumbent.centers)[None])[0]
        assert step.labels.tolist() == alone.tolist()
        assert step.places.tolist() == incumbent.centers.positions.tolist()
        assert step.parts.tolist() == [0, 1]
        assert (step.stage, step.evaluations) == (incumbent.stage, incumbent.evaluations)
    assert (steps[0].labels != found.labels).any()  # it has come some way


def test_a_page_leads_back_from_the_result_to_the_start(found):
    document = page_document(PageContent.of_result(found))
    end = np.frombuffer(base64.b64decode(document["geometry"]["labels"]["data"]), "<u1")
    before = search_steps(found).before
    labels = end.astype(np.int64)
    for said, step in zip(document["steps"][-2::-1], before[::-1], strict=True):
        labels = applied(labels, base64.b64decode(said["changes"]))
        polygon = TEE.geometry.triangle_polygon
        assert labels.tolist() == step.labels[polygon].tolist()
        assert said["cost"] == step.cost.value
    last = document["steps"][-1]
    assert (last["stage"], last["changes"], last["refined"]) == ("end", "", False)


def test_a_large_shape_is_partitioned_on_super_elements(found, monkeypatch):
    exact = search_steps(found).before
    monkeypatch.setattr(module, "_MOST_ELEMENTS", TEE.n_elements // 2)
    coarse = search_steps(found).before
    same = np.mean([a.labels == b.labels for a, b in zip(exact, coarse, strict=True)])
    assert 0.8 < same < 1.0


def test_small_pieces_have_the_label_of_the_nearest_part():
    x, y, z = TEE.points[0]
    speck = np.array([[x, y, z], [x + 0.01, y, z], [x, y + 0.01, z]]), [(0, 1, 2)]
    both = shapes.joined(shapes.jitter(shapes.tee(), 5), speck)
    shape = Shape.from_mesh(*both, name="specked")
    with_it = segment(shape, PROBLEM, restarts=1, ignore_pieces_below=0.001)
    for step in search_steps(with_it).before:
        assert step.labels[-1] == step.labels[0]


def test_centres_of_an_embedding_are_shown_on_the_shape_as_it_is():
    rod = Shape.from_mesh(*shapes.bent_capsule(9, 8), name="rod")
    ends = Problem(["one", "two"], "narrow(one)", embedding="mds")
    found = segment(rod, ends, restarts=1, optimizer="pattern_search(max_evaluations=30)")
    places = search_steps(found).before[0].places
    away = np.linalg.norm(rod.points[None] - places[:, None], axis=2).min(axis=1)
    assert away.tolist() == [0.0, 0.0]


def test_there_are_none_where_nothing_is_known(box, found):
    assert search_steps(result_on(box)) is None
    assert "steps" not in page_document(PageContent.of_result(result_on(box)))
    assert search_steps(replace(found, problem=Hierarchy(found.problem))) is None
    elsewhere = replace(found, method={**found.method, "parameterization": "acme:slices"})
    assert search_steps(elsewhere) is None


def test_steps_are_left_out_where_they_would_take_too_much():
    rng = np.random.default_rng(1)
    labels = rng.integers(0, 3, (20, 500))
    steps = [
        Step(
            stage="search",
            evaluations=2**k,
            cost=Cost(0, 1.0),
            labels=row,
            places=np.zeros((3, 3)),
            parts=np.arange(3),
        )
        for k, row in enumerate(labels)
    ]
    every = packed_changes(steps, np.arange(500), labels[0])
    assert len(every) == 20
    size = sum(len(text) for _, text in every)
    few = packed_changes(steps, np.arange(500), labels[0], most_bytes=size // 3)
    assert 2 <= len(few) < 10
    assert few[0][0] is steps[0]
    assert len(packed_changes(steps, np.arange(500), labels[0], most_bytes=10)) == 1
    assert packed_changes([], np.arange(500), labels[0]) == []
