"""Each check of invariances fails for the component that is broken that way, and no other."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.testing.checks.invariances import moved, reflected, retessellated, scaled
from moseg_core.testing.fixtures.shapes import lump, reordered
from tests.testing.broken.invariances import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


@pytest.mark.parametrize("target", ["tests.testing.odd:share", "tests.testing.odd:four"])
def test_what_is_sound_passes(target):
    assert failures(ObjectiveSpec(name="own", target=target)) == {}


@pytest.mark.parametrize(
    ("change", "size"),
    [(moved, 1.0), (scaled, 7.3), (reflected, 1.0), (reordered, 1.0), (retessellated, 1.0)],
)
def test_changed_shapes_are_the_same_surface(change, size):
    shape = lump()
    other, source = change(shape)
    source = np.arange(shape.n_elements) if source is None else source
    areas = np.bincount(source, other.areas, shape.n_elements)
    assert areas == pytest.approx(size**2 * shape.areas)
    assert other.volume == pytest.approx(size**3 * shape.volume)
    assert other.fingerprint != shape.fingerprint
