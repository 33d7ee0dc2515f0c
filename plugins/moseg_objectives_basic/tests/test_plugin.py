from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter

import moseg_objectives_basic.convexity as convexity
import moseg_objectives_basic.surface_distance as surface
import numpy as np
import pytest
from moseg_objectives_basic import plugin

from moseg_core import Problem, Segmentation, Shape, registry
from moseg_core.components.protocols import Objective

SECTION_10 = {
    "narrow": "unary",
    "flat": "unary",
    "compact": "unary",
    "planar_symmetric": "unary",
    "ellipsoidal": "unary",
    "perpendicular": "nary",
    "similar_proportions": "nary",
    "convex_parts": "global",
}
SECTION_3 = {
    "axial_symmetric": "unary",
    "rotational_symmetric": "unary",
    "convex": "unary",
    "area_fraction": "unary",
    "parallel": "nary",
    "coaxial": "nary",
    "similar": "nary",
}
WORDS = {
    "is": "unary",
    "thin": "unary",
    "thick": "unary",
    "even_thickness": "unary",
    "central": "unary",
    "remote": "unary",
    "small": "unary",
    "large": "unary",
    "short_boundary": "unary",
    "creased_boundary": "unary",
    "separate": "unary",
    "above": "nary",
    "touching": "nary",
    "apart": "nary",
    "short_boundaries": "global",
    "creased_boundaries": "global",
    "separate_parts": "global",
    "even_parts": "global",
}
SIZES = ("area", "length", "width", "depth", "spread", "thickness", "unevenness", "boundary")
PLACES = ("offcenter", "remoteness", "nearest", "farthest", "crease")
PARAMETERS = {
    "rotational_symmetric": {"n": 2},
    "area_fraction": {"min": 0.0, "max": 1.0},
    "above": {"up": "z", "margin": 0.1},
    "is": dict.fromkeys((*SIZES, *PLACES)),
}
#: Objectives that do not declare an invariance, and which: heights have a direction, the first part
#: is not like the others, distances and bends between elements hang on these, and squares of a
#: field on how finely it is sampled.
VARIANT = {
    "above": {"rigid", "reflection", "labels"},
    "touching": {"tessellation", "labels"},
    "central": {"tessellation"},
    "remote": {"tessellation"},
    "creased_boundary": {"tessellation"},
    "creased_boundaries": {"tessellation"},
    "separate": {"tessellation"},
    "separate_parts": {"tessellation"},
    "even_parts": {"tessellation"},
    "is": {"tessellation"},
}


def test_nothing_heavy_is_imported():
    code = (
        "import sys, json, moseg_objectives_basic.plugin as p;"
        "p.moseg_objectives(), p.moseg_measures(), p.moseg_fields(), p.moseg_recipes();"
        "print(json.dumps(sorted(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(run.stdout)}
    assert "moseg_objectives_basic" in loaded
    heavy = {"numpy", "scipy", "igl", "manifold3d", "numba", "trimesh", "PIL"}
    assert not loaded & heavy


def test_bundle_is_found_whole():
    bundle = next(b for b in registry().bundles if b.name == "basic")
    assert bundle.problem is None
    offered = [*plugin.moseg_objectives(), *plugin.moseg_measures(), *plugin.moseg_fields()]
    offered += plugin.moseg_recipes()
    assert {c.spec for c in bundle.components} == set(offered)
    for component in bundle.components:
        assert component.load() is not None
        assert component.spec.summary


def test_objectives_are_those_of_sections_3_and_10_and_the_words():
    found = {}
    for spec in plugin.moseg_objectives():
        target = registry().find("objective", f"basic:{spec.name}").load()
        assert isinstance(target, Objective)
        assert target.__name__.rstrip("_") == spec.name  # `is` is a word of Python
        assert {p.name: p.default for p in target.parameters} == PARAMETERS.get(spec.name, {})
        low, high = target.traits.range
        assert low == 0 < high
        everything = {"rigid", "scale", "reflection", "order", "tessellation"}
        several = set() if target.traits.arity == "unary" else {"labels"}
        assert target.traits.invariant_to == (everything | several) - VARIANT.get(spec.name, set())
        found[spec.name] = target.traits.arity
    assert found == SECTION_10 | SECTION_3 | WORDS


def test_what_the_objectives_need():
    needs = {
        spec.name: registry().find("objective", f"basic:{spec.name}").load().traits.requires
        for spec in plugin.moseg_objectives()
    }
    assert needs.pop("convex_parts") == {"volume"}
    by_needs = {
        frozenset({"surface"}): {
            *("planar_symmetric", "axial_symmetric", "rotational_symmetric", "convex"),
            *("thin", "thick", "even_thickness", "even_parts"),
        },
        frozenset({"adjacency"}): {
            *("central", "remote", "touching", "apart", "short_boundary", "short_boundaries"),
        },
        frozenset({"surface", "adjacency"}): {
            *("creased_boundary", "creased_boundaries", "separate", "separate_parts"),
        },
    }
    for what, names in by_needs.items():
        assert {name for name, needed in needs.items() if needed == what} == names


@pytest.fixture
def calls(monkeypatch):
    """How often each measure is computed for each part."""
    counts = Counter()

    def count(module, name):
        original = getattr(module, name)

        def counted(part):
            counts[name, part.membership] += 1
            return original(part)

        monkeypatch.setattr(module, name, counted)

    count(surface, "surface_samples")
    count(surface, "surface_tree")
    count(convexity, "hull_volume")
    return counts


def test_measures_are_shared(make, calls):
    vertices, faces = make.ball(2)
    shape = Shape.from_mesh(vertices * [3, 2, 1], faces)
    labels = (shape.points[:, 0] > 0.4).astype(int)
    expression = (
        "planar_symmetric(a, b) + ellipsoidal(a, b) + 2*planar_symmetric(a) + ellipsoidal(b)"
        " + convex_parts + 3*convex_parts"
    )
    found = Problem(["a", "b"], expression).evaluate(shape, labels)
    assert np.isfinite(found.cost.value)
    names = ("surface_samples", "surface_tree", "hull_volume")
    parts = Segmentation.from_labels(shape, labels, 2).parts
    assert calls == {(name, part.membership): 1 for name in names for part in parts}


def test_cheap_objectives_measure_no_surface(make, calls):
    shape = Shape.from_mesh(*make.box(3, 2, 1))
    problem = Problem(["a", "b"], "narrow(a, b) + flat(a) + compact(b) + perpendicular(a, b)")
    problem.evaluate(shape, [0, 0, 0, 1, 1, 1])
    assert not calls
