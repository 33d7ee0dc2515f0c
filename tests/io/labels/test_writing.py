"""Labels to .seg and .txt, and back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import UsageError
from moseg_core.io.labels import encode_named_labels, encode_seg, read_labels, save_labels


@given(
    labels=st.lists(st.integers(-1, 2**40), min_size=1, max_size=50).filter(lambda k: max(k) >= 0)
)
def test_seg_round_trip(labels, as_file):
    found = read_labels(as_file("x.seg", encode_seg(np.array(labels))), len(labels))
    assert found.labels.tolist() == labels
    assert found.labels.dtype == np.int64
    assert found.names is None


NAMES = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S", "Zs")), min_size=1)


@given(data=st.data(), names=st.lists(NAMES, min_size=1, max_size=6, unique=True))
def test_named_round_trip(data, names, as_file):
    index = st.integers(-1, len(names) - 1)
    labels = data.draw(st.lists(index, min_size=1, max_size=40).filter(lambda k: max(k) >= 0))
    try:
        contents = encode_named_labels(labels, names)
    except UsageError:
        # Only for names that could be mistaken, for example a number or one with outer blanks.
        assert any(name != name.strip() or name.lstrip("+-")[:1].isdigit() for name in names)
        return
    found = read_labels(as_file("x.txt", contents), len(labels))
    assert found.labels.tolist() == labels
    assert found.names == tuple(names)


@pytest.mark.parametrize(
    ("labels", "names", "message"),
    [
        ([0, 2], ["a", "b"], "label 2 has no name; there are 2 names"),
        ([0, -2], ["a"], "labels count from 0; element 1 has -2"),
        ([[0]], ["a"], "labels must be a row of integers"),
        ([0.5], ["a"], "labels must be a row of integers"),
        ([0], ["a", "b", "a"], "the label name 'a' is repeated"),
        ([0], [""], "the label name '' cannot be written"),
        ([0], [" a"], "the label name ' a' cannot be written"),
        ([0], ["a\nb"], r"the label name 'a\\nb' cannot be written"),
        ([0], ["12"], "the label name '12' cannot be written"),
        ([0], ["3 legs"], "the label name '3 legs' cannot be written"),
    ],
)
def test_labels_that_cannot_be_written(labels, names, message):
    with pytest.raises(UsageError, match=message):
        encode_named_labels(labels, names)


def test_names_may_begin_with_a_digit_that_is_no_number(as_file):
    contents = encode_named_labels([0, 1], ["1st leg", "-x"])
    assert read_labels(as_file("x.txt", contents), 2).names == ("1st leg", "-x")


def test_labels_are_saved_by_suffix(tmp_path):
    save_labels([1, 0, 1], tmp_path / "x.SEG")
    assert (tmp_path / "x.SEG").read_bytes() == b"1\n0\n1\n"
    save_labels([1, 0, 1], str(tmp_path / "x.txt"), names=["a", "b"])
    found = read_labels(tmp_path / "x.txt", 3)
    assert (found.names[found.labels[0]], found.names[found.labels[1]]) == ("b", "a")


@pytest.mark.parametrize(
    ("name", "message"),
    [("x.txt", "needs names"), ("x.json", "as .txt or .seg, not '.json'"), ("x", "not 'x'")],
)
def test_labels_that_cannot_be_saved_are_refused(tmp_path, name, message):
    with pytest.raises(UsageError, match=message):
        save_labels([0, 1], tmp_path / name)
    assert list(tmp_path.iterdir()) == []
