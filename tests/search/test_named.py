"""Lookups by names that people type."""

from __future__ import annotations

import pickle

import pytest

from moseg_core.search.named import Named

PARTS = Named({"head": 1, "handle": 2}, kind="part")


def test_a_wrong_name_is_told_the_nearest_or_all_there_are():
    with pytest.raises(KeyError) as caught:
        PARTS["hed"]
    assert str(caught.value) == "unknown part 'hed'; did you mean 'head'?"
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    with pytest.raises(KeyError, match="unknown part '7'; known: handle, head"):
        PARTS[7]


def test_else_it_is_a_mapping():
    assert dict(PARTS) == {"head": 1, "handle": 2} == PARTS
    assert (PARTS.get("hed"), PARTS.get("hed", 9), "hed" in PARTS, len(PARTS)) == (
        None,
        9,
        False,
        2,
    )
    assert pickle.loads(pickle.dumps(PARTS)) == PARTS
    with pytest.raises(TypeError):
        PARTS["arm"] = 3
