"""The objective ``likely``: a part lies where the shape looks as parts of its kind do.

Measures of a whole part (``basic:is``) say what it should be like, and a part of the right size and
thickness may still lie in the wrong place. How likely each element is to bear the label
(:mod:`moseg_learn.looks`) says where; together both agree better with people than either alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from moseg_core import Part, PartArray, Table, objective
from moseg_learn.looks import FIELDS, MOST, Looks
from moseg_learn.neighbourhoods import FloatArray


def fields_of(given: Mapping[str, Any]) -> tuple[str, ...]:
    """Ids of the fields that are read, after a look at what was given, before the search.

    Raises
    ------
    UsageError
        The kind is not in the table, or the table has a quantity that there is not.

    Examples
    --------
    >>> fields_of({"kind": "leg", "among": {"leg": {"thickness": -3}, "body": {}}})[0]
    'basic:log_thickness'
    """
    if "among" in given:
        Looks.read(given["among"]).kind(given.get("kind", ""))
    return (*FIELDS, "learn:unlikeliness")


def all_likely(parts: PartArray, *, kind: str, among: Table) -> FloatArray:
    """:func:`likely` of several parts, (k,) float."""
    means = parts.field("learn:unlikeliness", kind=kind, among=among).mean
    return np.clip(means, 0.0, MOST)


@objective(
    range=(0, MOST),
    requires=("surface", "adjacency"),
    invariant_to=("rigid", "scale", "reflection", "order"),
    fields=fields_of,
    mean_of=lambda given: ("learn:unlikeliness", given),
    vectorized=all_likely,
)
def likely(part: Part, *, kind: str, among: Table) -> float:
    """The mean over the part of ``-log p``, how unlikely it is that it is of a kind.

    Parameters
    ----------
    part : Part
    kind : str
        What the part is: a kind in the table.
    among : Table
        The weights of each kind, learned from examples or written by hand
        (:mod:`moseg_learn.looks`).

    Returns
    -------
    float
        0 where all of it is certain to be of the kind, 0.7 where that is as likely as not, 6.9
        where it is out of the question; 0 is best.

    Notes
    -----
    A refiner may go by what it says of each place, as ``graph_cut(data=2)`` does.

    With one term for each part, weighted by areas, it is the unary energy of Kalogerakis, Hertzmann
    and Singh 2010, doi:10.1145/1778765.1778839; a mean of each part, it says as much of an ear
    as of a torso.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> looks = moseg.Table({"head": {"width_within_30": 9, "constant": 6}, "handle": {}})
    >>> parts = moseg.Segmentation.from_labels(hammer, truth.labels, 2).parts
    >>> head = parts[truth.names.index("head")]
    >>> likely(head, kind="head", among=looks) < likely(head, kind="handle", among=looks)
    True
    """
    mean = part.field("learn:unlikeliness", kind=kind, among=among).mean
    return min(max(mean, 0.0), MOST)
