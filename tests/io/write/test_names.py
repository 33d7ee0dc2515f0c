"""Labels as file names: safe whatever somebody called a part, readable, all different."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.write.names import LONGEST, safe_file_name, safe_file_names

# Texts that are likely to hold what is dangerous, beside any others.
HOSTILE = st.text(
    st.sampled_from("aB1 ./\\:*?\"<>|-_+~$`;&'\n\t\0\u202e\u200f\u2066\ufeff\u0301é\ud800¹")
)
LABELS = st.one_of(HOSTILE, st.text(), st.sampled_from(["con", "LPT1", "aux.x", "COM¹", "nul "]))


@given(LABELS)
def test_a_name_leads_nowhere_and_hides_nothing(label):
    name = safe_file_name(label)
    assert 0 < len(name.encode()) <= LONGEST
    assert not set(name) & set("/\\:*?\"<>|~$`;&'%{}() ")
    assert {unicodedata.category(c)[0] for c in set(name) - set("_-.+")} <= set("LMN")
    assert name[0] not in ".-"
    assert name[-1] not in ".-"
    stem = unicodedata.normalize("NFKC", name.partition(".")[0]).lower()
    assert stem not in {"con", "prn", "aux", "nul", "com1", "lpt1"}
    assert safe_file_name(name) == name


@given(st.lists(LABELS, max_size=6))
def test_names_differ_where_capitals_do_not_count(labels):
    names = safe_file_names(labels)
    assert len(names) == len(labels)
    assert len({unicodedata.normalize("NFKC", name).casefold() for name in names}) == len(names)
    assert all(safe_file_name(name) == name or len(name.encode()) > LONGEST for name in names)


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("head", "head"),
        ("head/ear1", "head-ear1"),
        ("Flügel links", "Flügel_links"),
        ("../../x", "x"),
        ("C:\\temp", "C-temp"),
        ("<script>alert(1)</script>", "script-alert-1-script"),
        ("con", "_con"),
        ("Con.tool", "_Con.tool"),
        ("console", "console"),
        ("..", "part"),
        ("", "part"),
        ("a\u202egpj.exe", "a-gpj.exe"),
        ("x" * 10_000, "x" * LONGEST),
        ("頭" * 100, "頭" * (LONGEST // 3)),
    ],
)
def test_names_are_readable(label, name):
    assert safe_file_name(label) == name


def test_labels_of_one_name_get_numbers():
    assert safe_file_names(["a?", "a", "A", "a-2"]) == ("a-3", "a", "A-4", "a-2")
    long = ["x" * 200, "x" * 300]
    assert safe_file_names(long) == ("x" * LONGEST, "x" * LONGEST + "-2")
