"""Sample shapes whose true parts are known: a hammer, a horse, a bulldog, a dove, an octopus.

They serve to try moseg out, and to measure how well a segmentation finds parts that a person would
name. Each is one closed, outward-oriented triangle mesh without holes or handles, made by
``tools/make_samples.py`` from smooth solids that flow into one another.

===========  ======  ===========  ==================================================
sample       faces   units        parts
===========  ======  ===========  ==================================================
``bulldog``  10,566  metres       ``head``, ``body``, ``leg1``, ``leg2``, ``leg3``, ``leg4``
``dove``     11,502  millimetres  ``body``, ``wing1``, ``wing2``, ``tail``
``hammer``   8,410   millimetres  ``handle``, ``head``
``horse``    9,670   metres       ``head``, ``body``, ``leg1``, ``leg2``, ``leg3``, ``leg4``
``octopus``  10,798  millimetres  ``head``, ``arm1`` to ``arm8``
===========  ======  ===========  ==================================================

The true labels come from the construction and from no algorithm: a face belongs to the part whose
own solid, taken without the others, has the smallest signed distance at the centroid of the face.

- The hammer lies on its side, and the end of the handle that shows beyond the eye counts as head.
- The horse walks towards +x with y up; its neck and mane count as head, its tail as body, and the
  legs are left fore, right fore, left hind and right hind.
- The bulldog stands the same way, with the legs in the same order. Its mesh is its own mirror
  image in the plane z = 0, exactly, and so are the parts: each face has an image, and ``leg2`` and
  ``leg4`` are the images of ``leg1`` and ``leg3``.
- The dove glides towards +x with its wings spread, and is symmetric in the same way: ``wing2``, on
  the right, is the image of ``wing1``. Its head counts as body.
- The octopus stretches out eight arms of the same length, each bent in its own way; some pass above
  others, and none touch. Its mantle counts as head.

A sample is two files: ``<name>.ply`` and ``<name>.txt``, which holds a line with a label and then a
line with its faces, numbered from 1, for each part. This module only says where they are; reading
them is the business of :mod:`moseg_core.io`.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from moseg_core.errors import UsageError, unknown

__all__ = ["SAMPLES", "sample_labels_path", "sample_path"]

SAMPLES: tuple[str, ...] = ("bulldog", "dove", "hammer", "horse", "octopus")
"""The names of the samples."""


def sample_path(name: str) -> Path:
    """Where the mesh of a sample is.

    Parameters
    ----------
    name : str
        One of :data:`SAMPLES`.

    Returns
    -------
    Path
        A binary PLY file.

    Raises
    ------
    UsageError
        There is no such sample.

    Examples
    --------
    >>> sample_path("hammer").name
    'hammer.ply'
    >>> sample_path("hammr")
    Traceback (most recent call last):
    ...
    moseg_core.errors.UsageError: unknown sample 'hammr'; did you mean 'hammer'?
    """
    return _file(name, ".ply")


def sample_labels_path(name: str) -> Path:
    """Where the true part labels of a sample are.

    Parameters
    ----------
    name : str
        One of :data:`SAMPLES`.

    Returns
    -------
    Path
        A text file of named labels, one label for each face of :func:`sample_path`.

    Raises
    ------
    UsageError
        There is no such sample.

    Examples
    --------
    >>> sample_labels_path("horse").read_text().splitlines()[::2]
    ['head', 'body', 'leg1', 'leg2', 'leg3', 'leg4']
    """
    return _file(name, ".txt")


def _file(name: str, suffix: str) -> Path:
    """Find the file of a sample with this suffix."""
    if name not in SAMPLES:
        raise UsageError(unknown("sample", name, SAMPLES))
    return Path(str(files(__name__) / f"{name}{suffix}"))
