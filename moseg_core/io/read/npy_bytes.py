"""NumPy's ``.npy`` format, of which a header says what the bytes behind it are.

The header is read without trusting it (:mod:`moseg_core.io.read.npy_header`), and what it says is
checked against the bytes that are there before an array is made: their number is that of the shape,
which takes no memory to compute. Objects, which would have to be unpickled, are refused.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from moseg_core.io.read.npy_header import parse_npy_header


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
    >>> import io
    >>> file = io.BytesIO()
    >>> np.save(file, np.arange(3))
    >>> array_from_bytes(file.getvalue()).tolist()
    [0, 1, 2]
    >>> array_from_bytes(file.getvalue()[:-1])
    Traceback (most recent call last):
        ...
    ValueError: does not hold what an array of shape (3,) takes; it is cut off
    """
    try:
        header = parse_npy_header(data)
    except ValueError as error:
        raise ValueError(f"is not an .npy file ({error}); save it anew") from error
    shape, dtype = header.shape, header.dtype
    if dtype.kind not in "biufU" or not dtype.itemsize:
        raise ValueError(f"holds {dtype!s:.80}, not numbers; save it anew")
    count = math.prod(shape)
    if count * dtype.itemsize != len(data) - header.size or max(shape, default=0) > len(data):
        raise ValueError(f"does not hold what an array of shape {shape!s:.80} takes; it is cut off")
    flat = np.frombuffer(data, dtype, count, header.size)
    return flat.reshape(shape, order="F" if header.by_columns else "C")
