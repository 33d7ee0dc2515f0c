"""Headers of .npy files: those that numpy writes, and none that it would choke on."""

from __future__ import annotations

import io

import numpy as np
import pytest

from moseg_core.io.read.npy_header import parse_npy_header


def saved(array) -> bytes:
    file = io.BytesIO()
    np.save(file, array, allow_pickle=True)
    return file.getvalue()


def headed(text: str, version: int = 1) -> bytes:
    length = len(text).to_bytes(2 if version == 1 else 4, "little")
    return b"\x93NUMPY" + bytes((version, 0)) + length + text.encode()


@pytest.mark.parametrize(
    "array",
    [
        np.zeros(()), np.zeros(3), np.zeros((3, 4), order="F"), np.zeros((0, 3)),
        np.ones((2, 2, 2), bool), np.array(["ab", "c"]), np.zeros(2, ">i2"),
        np.zeros(2, "datetime64[ns]"), np.array([None]),
    ],
)  # fmt: skip
def test_what_numpy_writes_is_understood(array):
    data = saved(array)
    header = parse_npy_header(data)
    assert (header.shape, header.dtype) == (array.shape, array.dtype)
    assert header.by_columns == (array.flags.fnc)
    assert data[header.size :] == data[len(data) - len(data[header.size :]) :]


@pytest.mark.parametrize("version", [1, 2, 3])
def test_all_versions_and_other_quotes(version):
    text = """{"descr":"<f8","fortran_order":False,"shape":(3L,4)}"""
    assert parse_npy_header(headed(text, version)).shape == (3, 4)


FORM = "{{'descr': {}, 'fortran_order': False, 'shape': {}, }}"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (FORM.format("'<f8'", "(True, True)"), "no shape of whole numbers"),
        (FORM.format("'<f8'", "(3 4)"), "no shape of whole numbers"),
        (FORM.format("'<f8'", "(" + " " * 9000 + ", )"), "no shape of whole numbers"),
        (FORM.format("'<f8'", "(-3,)"), "no shape of whole numbers"),
        (FORM.format("'<f8'", f"({2**64},)"), "its shape is (18446744073709551616)"),
        (FORM.format("'<f8'", "(" + "1, " * 65 + ")"), "its shape has 65 axes"),
        (FORM.format("'<x9'", "(3,)"), "type '<x9'"),
        (FORM.format("'<f8" + "(" * 500 + "'", "(3,)"), "of the type '<f8((("),
        (FORM.format("[('a', '<f8')]", "(3,)"), "records, not numbers"),
        (FORM.format("-" * 4000 + "'<f8'", "(3,)"), "no type of its numbers"),
        ("{'descr': '<f8', 'shape': (3,)}", "no order of its axes"),
        ("[3]", "no dictionary"),
        (FORM + " " * 10_001, "bytes long"),
    ],
)
def test_headers_that_are_refused_in_a_few_words(text, says):
    with pytest.raises(ValueError, match=r"^it") as caught:
        parse_npy_header(headed(text))
    assert says in str(caught.value)
    assert len(str(caught.value)) < 100


@pytest.mark.parametrize("data", [b"", b"\x93NUMPY", b"\x93NUMPY\x09\0\x01\0{}", b"PK\3\4" * 9])
def test_what_does_not_begin_as_such_a_file(data):
    with pytest.raises(ValueError, match=r"^it"):
        parse_npy_header(data)
