"""Tables: what they hold, what is refused, and that equal ones are keys of the same."""

from __future__ import annotations

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import UsageError
from moseg_core.language import Table, Target
from moseg_core.language.table import named_table

TEXTS = st.text(min_size=1, max_size=5)
WORDS = TEXTS.filter(lambda text: "+-" not in text and "±" not in text)
TARGETS = st.builds(Target, st.floats(-9, 9), st.floats(1e-9, 9))
NUMBERS = st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.booleans()
TABLES = st.recursive(
    st.dictionaries(TEXTS, NUMBERS | WORDS | TARGETS, max_size=3),
    lambda inner: st.dictionaries(TEXTS, inner, max_size=3),
    max_leaves=5,
).map(Table)


@given(TABLES)
def test_plain_data_and_copies_are_the_same_table(table):
    for same in (Table(table.document()), pickle.loads(pickle.dumps(table)), Table(table)):
        assert same == table
        assert hash(same) == hash(table)
        assert {table: 1}[same] == 1


def test_an_entry_is_what_was_given():
    table = Table({"a": 1, "b": 0.5, "c": True, "d": "word", "e": "0.06±0.02", "f": {"g": "-1+-2"}})
    assert dict(table) == {
        "a": 1,
        "b": 0.5,
        "c": True,
        "d": "word",
        "e": Target(0.06, 0.02),
        "f": Table({"g": Target(-1, 2)}),
    }
    assert [type(value) for value in table.values()][:4] == [int, float, bool, str]
    assert "c" in table
    assert len(table) == 6


@pytest.mark.parametrize(
    "other", [{"a": 1.0}, {"a": True}, {"a": "1"}, {"a": 1, "b": 2}, {"a": {}}]
)
def test_what_is_written_otherwise_is_another_table(other):
    assert Table({"a": 1}) != Table(other)


def test_the_order_of_names_does_not_count():
    one, other = Table({"a": 1, "b": 2}), Table({"b": 2, "a": 1})
    assert one == other
    assert list(one) == ["a", "b"]


def test_a_table_cannot_be_changed():
    mine = {"a": {"b": 1}}
    table = Table(mine)
    mine["a"]["b"] = 2
    assert table["a"]["b"] == 1
    with pytest.raises(TypeError):
        table["a"] = 3


@pytest.mark.parametrize(
    ("entries", "says"),
    [
        ({"leg": {"area": [1, 2]}}, r"'leg\.area' .* a number, a text or a table, not \[1, 2\]"),
        ({"area": None}, "'area' .* not None"),
        ({"area": float("nan")}, "'area' .* must be finite, not nan"),
        ({"area": "0.06+-"}, r"'area' .* no target: expected the spread .* write 0\.06\+-0\.02"),
        ({"area": "1+-0"}, "the spread of a target must be positive"),
        ({"area": "about ± much"}, "'area' .* no target"),
        ({"leg": {3: 1}}, "names in a table are texts, not 3 in table 'leg'"),
        ({"": 1}, "names in a table are texts, not ''"),
    ],
)
def test_other_entries_are_refused_by_their_path(entries, says):
    with pytest.raises(UsageError, match=says):
        Table(entries)


def test_a_table_is_found_by_its_name_or_path():
    leg = Table({"area": "0.06+-0.02"})
    tables = Table({"leg": leg, "looks": {"leg": {"bias": 1}, "arm": {}}})
    assert named_table(tables, "leg") is leg
    assert named_table(tables, "looks.leg") == Table({"bias": 1})


@pytest.mark.parametrize(
    ("tables", "name", "says"),
    [
        ({"leg": {}, "arm": {}}, "lge", "unknown table 'lge'; did you mean 'leg'"),
        ({"looks": {"leg": {}}}, "looks.lge", "did you mean 'looks.leg'"),
        ({"leg": {}, "arm": {}}, "zzz", "known: arm, leg"),
        ({}, "leg", r"there is no table 'leg'; write one into the recipe: \[given\.leg\]"),
        ({"leg": {"area": 1}}, "leg.area", "unknown table 'leg.area'"),
        ({"leg": {}}, 3.0, r"the name of a table is a word, not 3\.0; write given=leg"),
        ({"leg": {}}, None, "the name of a table is a word, not None"),
    ],
)
def test_an_unknown_table_is_named_with_the_nearest(tables, name, says):
    with pytest.raises(UsageError, match=says):
        named_table(Table(tables), name)
