"""Examples from files: ``SHAPE=LABELS``, or a shape that bears its labels itself.

Labels are read in all forms that moseg reads labellings in; a shape bears its own where it is a
``.ply`` with labels, an ``.obj`` of groups, an ``.stl`` of solids or a ``.glb`` of nodes. Files
that number labels without naming them, ``.seg`` above all, need the names said. Nothing is learned
of elements without a label.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from moseg_core import Example, ShapeError, UsageError, load, read_labels

OWN = (".ply", ".obj", ".stl", ".glb", ".gltf")
"""Suffixes of shapes that may bear labels."""


def read_example(
    word: str,
    *,
    names: Sequence[str] | None = None,
    adjacency: str = "auto",
    label_property: Sequence[str] = (),
    tell: Callable[[str], None] | None = None,
) -> Example:
    """The example that a word of the command line stands for.

    Parameters
    ----------
    word : str
        ``a.off=a_labels.txt``, or ``a.ply``.
    names : sequence of str, optional
        What labels are called in files that have numbers only.
    adjacency : {"auto", "knn", "none"}
        Which elements touch: see :meth:`moseg_core.Shape.with_adjacency`.
    label_property : sequence of str
        Names of the property that holds the labels: see :func:`moseg_core.read_labels`.
    tell : callable, optional
        Called with each line that is to be said of how the labels were read.

    Raises
    ------
    UsageError
        A file that does not exist, or labels without names.
    ShapeError
        A file cannot be read, or the labels do not fit the shape.
    """
    path, labels = split_word(word)
    for file in (path, labels):
        if not os.path.exists(file):
            raise UsageError(f"example '{word}': there is no file '{file}'")
    shape = load(path).with_adjacency(adjacency)
    try:
        labelling = read_labels(labels, shape, label_property=label_property)
    except (ShapeError, UsageError) as error:
        raise type(error)(f"example '{word}': {error}") from error
    if tell is not None:
        for note in labelling.notes:
            tell(note)
    called = labelling.names
    if called is None:
        if names is None:
            raise UsageError(
                f"example '{word}': '{labels.name}' numbers its labels and does not name them;"
                f" say what they are called, from 0 on: --names body,leg"
            )
        called = tuple(names)
    if int(labelling.labels.max()) >= len(called):
        raise UsageError(
            f"example '{word}': '{labels.name}' has the label {labelling.labels.max()}, but there"
            f" are {len(called)} names: {', '.join(called)}"
        )
    return Example(shape, labelling.labels, called)


def split_word(word: str) -> tuple[Path, Path]:
    """The files of shape and labels of a word; the same where the shape bears its labels.

    Raises
    ------
    UsageError
        No labels are named for a shape of a format that has none.

    Examples
    --------
    >>> [path.name for path in split_word("cat.off=cat_labels.txt")]
    ['cat.off', 'cat_labels.txt']
    >>> split_word("cat.off")
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: example 'cat.off' has no labels; write cat.off=LABELS
    """
    whole = Path(word)
    # A file may have the sign in its name.
    if "=" in word and not (whole.suffix.lower() in OWN and os.path.exists(whole)):
        shape, _, labels = word.rpartition("=")
        if not shape or not labels:
            raise UsageError(f"example '{word}' is not understood; write SHAPE=LABELS")
        return Path(shape), Path(labels)
    if whole.suffix.lower() not in OWN:
        raise UsageError(f"example '{word}' has no labels; write {word}=LABELS")
    return whole, whole
