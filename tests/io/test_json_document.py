"""JSON from anybody: what is too deep or too large is refused before it is parsed."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.json_document import parse_json, read_json_file

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda below: st.lists(below) | st.dictionaries(st.text(), below),
)


@given(VALUES)
def test_documents_are_read(value):
    assert parse_json(json.dumps(value).encode()) == value


@pytest.mark.parametrize(
    "data",
    [
        101 * b"[" + 101 * b"]",
        100_000 * b"[",
        101 * b'{"a":' + b"1" + 101 * b"}",
        101 * b'[{"a":',
        b'{"a": "' + b"[" * 200 + b'", "b": ' + b"[" * 101 + b"]" * 101 + b"}",
        b'"\\\\" ' + b"[" * 200,
    ],
)
def test_what_is_nested_too_deep_is_refused(data):
    with pytest.raises(ValueError, match="nested more than 100 deep"):
        parse_json(data)


@pytest.mark.parametrize(
    "data", [100 * b"[" + 100 * b"]", b'"' + 500 * b"[" + b'"', b'["\\"' + 200 * b"[" + b'"]']
)
def test_what_is_not_is_read(data):
    parse_json(data)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        b"[1,]",
        b'"',
        b"\xff",
        b"9" * 5000,
        b"\x00",
        b"]" * 1000,
        b"[" * 50,
        b"{1}",
        b"\xff\xfe[",
    ],
)
def test_what_is_no_json_is_a_value_error(data):
    with pytest.raises(ValueError, match=r"."):
        parse_json(data)


def test_a_device_is_no_document(tmp_path):
    with pytest.raises(OSError, match="it is a device"):
        read_json_file(tmp_path / "/dev/zero")
