"""NumPy's ``.npy`` format, of which a header says what the bytes behind it are.

The header is a Python literal that numpy evaluates (``numpy/lib/format.py``): a dictionary with the
dtype, the order and the shape. What is in a file may be anything, so the evaluation is guarded, and
what comes out is checked against the bytes that are there before an array is made: their number is
that of the shape, which takes no memory to compute. Objects, which would have to be unpickled, are
refused.
"""

from __future__ import annotations

import io
import math
import tokenize
import warnings

import numpy as np
import numpy.typing as npt

_MOST_AXES = 32
# What numpy raises over headers that are none, or nested, or as long as to overflow a parser.
_DAMAGED = (
    *(ValueError, TypeError, SyntaxError, KeyError, IndexError, AttributeError),
    *(ArithmeticError, RecursionError, MemoryError, tokenize.TokenError),
)


def array_from_bytes(data: bytes) -> npt.NDArray[np.generic]:
    """The array that the bytes of an ``.npy`` file hold; a view of them, which cannot be written.

    Parameters
    ----------
    data : bytes
        All of the file.

    Returns
    -------
    array of bool, numbers or texts
        Of at most 32 axes.

    Raises
    ------
    ValueError
        What is wrong, as the rest of a sentence of which the file is the subject.

    Examples
    --------
    >>> file = io.BytesIO()
    >>> np.save(file, np.arange(3))
    >>> array_from_bytes(file.getvalue()).tolist()
    [0, 1, 2]
    >>> array_from_bytes(file.getvalue()[:-1])
    Traceback (most recent call last):
        ...
    ValueError: does not hold what an array of shape (3,) takes; it is cut off
    """
    stream = io.BytesIO(data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of damaged headers, which are refused below
            major = np.lib.format.read_magic(stream)[0]
            read_header = (
                np.lib.format.read_array_header_1_0
                if major == 1
                else np.lib.format.read_array_header_2_0
            )
            shape, by_columns, dtype = read_header(stream)
    except _DAMAGED as error:
        said = " ".join(str(error).split())[:80] or "its header is nested too deep"
        raise ValueError(f"is not an .npy file ({said}); save it anew") from error
    # A bool is an int to Python, and to numpy's check of the header.
    if len(shape) > _MOST_AXES or not all(type(n) is int and n >= 0 for n in shape):
        raise ValueError(f"has a header with the shape {shape!s:.80}; save it anew")
    if dtype.kind not in "biufU" or not dtype.itemsize:
        raise ValueError(f"holds {dtype!s:.80}, not numbers; save it anew")
    count, start = math.prod(shape), stream.tell()
    if count * dtype.itemsize != len(data) - start or max(shape, default=0) > len(data):
        raise ValueError(f"does not hold what an array of shape {shape!s:.80} takes; it is cut off")
    flat = np.frombuffer(data, dtype, count, start)
    return flat.reshape(shape, order="F" if by_columns else "C")
