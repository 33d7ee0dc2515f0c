"""Each objective with a vectorised form: what a problem says, which asks that, against its own."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core import Problem, Segmentation, Shape, Target, coarsen, registry

PARAMETERS = {
    "is": {name: Target(0.3, 0.2) for name in ("area", "length", "width", "depth", "spread")}
    | {name: Target(1.2, 0.5) for name in ("offcenter", "remoteness", "nearest", "farthest")}
    | {name: Target(0.1, 0.2) for name in ("thickness", "unevenness", "boundary", "crease")},
    "area_fraction": {"min": 0.3, "max": 0.4},
    "above": {"up": "x", "margin": 0.3},
}
"""By name; in another test the contract kit gives others."""

VECTORIZED = {
    component.spec.name: component.load()
    for component in registry().components("objective")
    if component.bundle == "basic" and component.load().traits.vectorized is not None
}

OF_SURFACES = {"thickness", "unevenness", "crease"}
"""Parameters that read fields which a solid of cells does not have."""

ROUNDED = {"short_boundary", "short_boundaries", "creased_boundaries"}
"""Those that add up in another order, or take numpy's roots; all others agree to the last bit."""

CALLS = {"unary": "*", "nary": "c, a", "global": ""}


def test_most_cheap_objectives_have_one():
    cheap = {"is", "small", "large", "thin", "thick", "central", "remote", "above", "separate"}
    assert cheap <= set(VECTORIZED)
    assert {"narrow", "flat", "compact", "similar_proportions"} <= set(VECTORIZED)


@pytest.fixture(scope="module")
def levels(make):
    """Of a mesh the elements and super-elements, and a solid of cells."""
    vertices, faces = make.ball(3)
    vertices = vertices * [1.0, 0.7, 0.5] + 0.1 * np.sin(3 * vertices[:, [1, 2, 0]])
    mesh = Shape.from_mesh(vertices, faces)
    return [mesh, coarsen(mesh, 100), Shape.from_voxels(np.ones((6, 5, 4), bool), pitch=0.25)]


@given(st.data())
@settings(max_examples=12, deadline=None)
def test_a_vectorised_form_says_what_the_objective_says(levels, data):
    level = data.draw(st.sampled_from(levels))
    rng = np.random.default_rng(data.draw(st.integers(0, 99)))
    middles = level.points[rng.choice(level.n_elements, 3, replace=False)]
    labels = np.linalg.norm(level.points[:, None] - middles, axis=2).argmin(axis=1)
    found = Segmentation.from_labels(level, labels, 3)
    a, b, c = found.parts
    given_to = {"unary": [a, b, c], "nary": [(c, a)], "global": [found]}
    for name, objective in VECTORIZED.items():
        traits, given = objective.traits, PARAMETERS.get(name, {})
        if "surface" in traits.requires and level.input.solid:
            continue
        if level.input.solid:
            given = {key: value for key, value in given.items() if key not in OF_SURFACES}
        said = "".join(f", {key}={value}" for key, value in given.items())
        text = f"{name}({CALLS[traits.arity]}{said})" if CALLS[traits.arity] else name
        term = Problem(["a", "b", "c"], text).evaluate(level, labels).terms[0]
        expected = [objective(subject, **given) for subject in given_to[traits.arity]]
        values = [call.value for call in term.calls]
        if name in ROUNDED:
            assert values == pytest.approx(expected, rel=1e-12, abs=1e-15), name
        else:
            assert values == expected, name
