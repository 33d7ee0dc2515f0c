"""Names: whether parts are called what they are, and what is taken for what.

The measures of the benchmark look at regions and never at their names. With names on both sides
one can ask more simply: on what share of the surface does the right name stand? That is the label
accuracy of Kalogerakis, Hertzmann and Singh 2010, doi:10.1145/1778765.1778839, by area. The
confusion table says where the rest went.

Instances of one kind are alike: ``leg1`` and ``leg2`` both count as ``leg``, on either side. And
two people seldom choose the same words, so that names of the found labelling may be translated
into those of the truth before they are compared (:func:`renamed`). What bears no label, -1, on
either side is left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from moseg_core.agreement.overlap import labelled, sums
from moseg_core.errors import UsageError, unknown
from moseg_core.types import FloatArray, IntArray


def fold(name: str) -> str:
    """A name without its instance number: ``leg3`` is a ``leg``.

    Of a path every name is folded: the ``shin`` of ``leg3`` is the ``shin`` of a ``leg``.

    Examples
    --------
    >>> fold("leg3"), fold("3"), fold("leg3/shin")
    ('leg', '3', 'leg/shin')
    """
    return "/".join(word.rstrip("0123456789") or word for word in name.split("/"))


def renamed(names: Sequence[str], rename: Mapping[str, str]) -> list[str]:
    """Names folded, and translated where a translation is given.

    Parameters
    ----------
    names : sequence of str
        Of the found labelling.
    rename : mapping of str to str
        For names of the found labelling those of the truth. A name is looked up as it stands
        first, so that ``leg1`` may become something else than other legs, then folded. All at
        once: ``{"a": "b", "b": "a"}`` exchanges two names.

    Returns
    -------
    list of str
        One for each of `names`.

    Raises
    ------
    UsageError
        A translation of a name that is none of `names`, folded or not.

    Examples
    --------
    >>> renamed(["leg1", "leg2", "body"], {"leg": "limb", "leg1": "arm1"})
    ['arm', 'limb', 'body']
    >>> renamed(["leg1", "leg2", "body"], {"lag": "limb"})
    Traceback (most recent call last):
    ...
    moseg_core.errors.UsageError: unknown label to rename 'lag'; did you mean 'leg'?
    """
    known = {*names, *map(fold, names)}
    for name in rename:
        if name not in known:
            raise UsageError(unknown("label to rename", name, known))
    return [fold(rename.get(name, rename.get(fold(name), name))) for name in names]


def named_right(
    labels: IntArray,
    names: Sequence[str],
    truth: IntArray,
    truth_names: Sequence[str],
    areas: FloatArray,
    *,
    rename: Mapping[str, str] | None = None,
) -> float:
    """Share of the area that bears the right name, instance numbers folded.

    Parameters
    ----------
    labels, truth : (F,) int
        -1 for an element without a label.
    names, truth_names : sequence of str
        Names of the labels; ``leg1`` and ``leg2`` both count as ``leg``.
    areas : (F,) float
    rename : mapping of str to str, optional
        For names in `names` those to compare with the truth, as for :func:`renamed`.

    Returns
    -------
    float
        0 to 1, of the area that has a label on both sides; 1 is best.

    Raises
    ------
    UsageError
        A translation of a name that is none of `names`; no element has a label on both sides.

    Examples
    --------
    >>> import numpy as np
    >>> labels, truth, areas = np.array([0, 1]), np.array([0, 1]), np.array([3.0, 1.0])
    >>> named_right(labels, ["leg1", "leg2"], truth, ["leg2", "body"], areas)
    0.75
    >>> named_right(labels, ["leg1", "leg2"], truth, ["leg2", "body"], areas,
    ...             rename={"leg2": "body"})
    1.0
    """
    labels, truth, areas = _known(labels, truth, areas)
    given = np.array(renamed(names, rename or {}))[labels]
    wanted = np.array([fold(name) for name in truth_names])[truth]
    return float(areas[given == wanted].sum() / areas.sum())


@dataclass(frozen=True, eq=False)
class Confusion:
    """What bears which name, by what it is.

    Parameters
    ----------
    true_names : tuple of str
        Rows: the folded names of the truth, sorted.
    given_names : tuple of str
        Columns: the folded and translated names of the found labelling, sorted.
    areas : (T, G) float, model units squared
        Area that is the one and is called the other.
    """

    true_names: tuple[str, ...]
    given_names: tuple[str, ...]
    areas: FloatArray


def confusion(
    labels: IntArray,
    names: Sequence[str],
    truth: IntArray,
    truth_names: Sequence[str],
    areas: FloatArray,
    *,
    rename: Mapping[str, str] | None = None,
) -> Confusion:
    """Areas by true and given name.

    Parameters
    ----------
    labels, names, truth, truth_names, areas, rename
        As for :func:`named_right`. Names that no element bears have a row or column of zeros.

    Returns
    -------
    Confusion
        Its areas sum to that of the shape which has a label on both sides, those under equal names
        to what is named right.

    Raises
    ------
    UsageError
        A translation of a name that is none of `names`; no element has a label on both sides.

    Examples
    --------
    >>> import numpy as np
    >>> table = confusion(np.array([0, 1, 1]), ["head", "body"],
    ...                   np.array([0, 0, 1]), ["head", "tail"], np.array([3.0, 1.0, 2.0]))
    >>> table.true_names, table.given_names
    (('head', 'tail'), ('body', 'head'))
    >>> table.areas.tolist()
    [[1.0, 3.0], [2.0, 0.0]]
    """
    rows, row = _sorted_names([fold(name) for name in truth_names])
    columns, column = _sorted_names(renamed(names, rename or {}))
    labels, truth, areas = _known(labels, truth, areas)
    cell = row[truth] * len(columns) + column[labels]
    summed = sums(cell, areas, len(rows) * len(columns))
    return Confusion(rows, columns, summed.reshape(len(rows), len(columns)))


def _known(
    labels: IntArray, truth: IntArray, areas: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Those of the elements that have a label on both sides."""
    known = labelled(labels, truth)
    if not areas[known].any():
        raise UsageError("nothing has a label in both labellings; there is nothing to compare")
    return labels[known], truth[known], areas[known]


def _sorted_names(names: Sequence[str]) -> tuple[tuple[str, ...], IntArray]:
    """The distinct names, sorted, and for each label its place among them."""
    distinct = tuple(sorted(set(names)))
    return distinct, np.array([distinct.index(name) for name in names], np.int64)
