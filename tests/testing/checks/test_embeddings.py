"""Each check of embeddings fails for the component that is broken that way, and no other."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import EmbeddingSpec
from tests.testing.broken.embeddings import BROKEN
from tests.testing.outcomes import assert_fails_only, failures


@pytest.mark.parametrize("id", BROKEN)
def test_it_fails_this_check_and_no_other(id):
    assert_fails_only(id, BROKEN[id])


def test_faces_may_be_turned_inward():
    target = "tests.testing.broken.embeddings:ByTheOutside"
    assert_fails_only("embedding-isometry", EmbeddingSpec(name="broken", target=target))


@pytest.mark.parametrize("target", ["tests.testing.broken.embeddings:Stretched"])
def test_what_is_sound_passes(target):
    assert failures(EmbeddingSpec(name="own", target=target)) == {}
