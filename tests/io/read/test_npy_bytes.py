"""The bytes of ``.npy`` files: whatever a header says, it is checked before there is an array."""

from __future__ import annotations

import io

import numpy as np
import pytest

from moseg_core.io.read.npy_bytes import array_from_bytes


def npy(header: str, data: bytes = b"", *, version: int = 2) -> bytes:
    """A file with a header as it is given."""
    encoded = header.encode("latin1") + b"\n"
    length = len(encoded).to_bytes(2 if version == 1 else 4, "little")
    return b"\x93NUMPY" + bytes([version, 0]) + length + encoded + data


def header(shape: str, descr: str = "'<i8'") -> str:
    return f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}"


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize(
    "array", [np.arange(6).reshape(2, 3), np.array(["a", "bc"]), np.zeros((0, 4)), np.array(5.0)]
)
def test_arrays_are_read_back(array, order):
    stream = io.BytesIO()
    np.save(stream, np.asarray(array, order=order))
    found = array_from_bytes(stream.getvalue())
    assert found.dtype == array.dtype
    np.testing.assert_array_equal(found, array)


@pytest.mark.parametrize(
    "bad",
    {
        "of bools": header("(True, False)"),
        "of one bool": header("(True,)"),
        "2^64": header(f"({2**64},)"),
        "2^64 and none": header(f"({2**64}, 0)"),
        "5,000 digits": header(f"({'9' * 5000},)"),
        "negative": header("(-1, -1)"),
        "of floats": header("(1e300,)"),
        "65 axes": header("(" + "1, " * 65 + ")"),
        "33 axes": header("(" + "1, " * 33 + ")"),
        "minus signs": header("(" + "-" * 4000 + "1,)"),
        "nested": "(" * 3000 + ")" * 3000,
        "nested dtype": header("(1,)", "[" * 500 + "'<i8'" + "]" * 500),
        "an object": header("(1,)", "'|O'"),
        "no bytes": header("(10,)", "'<U0'"),
        "void": header("(10,)", "'|V0'"),
        "fields": header("(1,)", "[('a', '<i8')]"),
        "huge texts": header("(1,)", "'<U1000000000'"),
        "no such dtype": header("(1,)", "'<q99'"),
        "a call": header("(1,)", "__import__('os')"),
        "a set": "{1, 2}",
        "a list of axes": header("[1]"),
        "empty": "",
        "a NUL": "\0",
        "a name": "x",
        "escapes": header("(1,)", "'\\x1b[2J'"),
    }.values(),
)
@pytest.mark.parametrize("version", [1, 2])
def test_a_header_that_makes_no_sense_is_refused_in_a_few_words(bad, version):
    with pytest.raises(ValueError, match=r"^(is|has|holds|does) ") as caught:
        array_from_bytes(npy(bad, bytes(8), version=version))
    assert type(caught.value) is ValueError
    assert len(str(caught.value)) < 250


@pytest.mark.parametrize("data", [b"", b"\x93NUMPY", b"\x93NUMPY\x09\x00", b"PK\x03\x04", b"\xff"])
def test_what_is_no_such_file_is_refused(data):
    with pytest.raises(ValueError, match=r"^is not an \.npy file \("):
        array_from_bytes(data)
