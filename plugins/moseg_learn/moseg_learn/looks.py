"""Looks: how likely each element is to bear a label, from what it and its surroundings are like.

A table of *looks* has for each kind of part a table of weights, a number for each of 116 quantities
``x`` of an element (:data:`KEYS`). 58 are measured: four of its own, thickness, remoteness, its
logarithm and concavity; its six of :mod:`moseg_learn.position`; and the twelve of
:mod:`moseg_learn.surroundings` within 4, 8, 16 and 30 % of the diagonal. As many compare these
with the rest of the shape: with the mean and the standard deviation of ``x`` over its surface ::

    relative x = z / sqrt(1 + z^2),   z = (x - mean) / deviation

is -1 where there is far less than is usual on this shape, 0 at the mean, 1 where there is far more.
A leg of a stout animal is as thick as the body of a lean one, and thin beside its own.

With the ``constant`` they make the score of the kind, ``s_k = c_k + sum w_k x``, and the scores
make probabilities (the multinomial logistic model, Cox 1966, of which Hastie, Tibshirani and
Friedman 2009, doi:10.1007/978-0-387-84858-7, Sec. 4.4, tell)::

    p_k = exp(s_k) / sum_j exp(s_j)

So a weight says how the odds of a kind change with the quantity: with ``thickness = 3``, whose
logarithm counts, they are eight times as good where the shape is twice as thick.
:mod:`moseg_learn.discriminant` finds the weights from examples; they can be written by
hand as well, and what is left out counts as 0.

What is measured of groups of elements (:mod:`moseg_learn.neighbourhoods`) makes the scores of
groups, and the scores, not the probabilities, are carried over to the elements.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from moseg_core import Shape, Table, UsageError, field_values, unknown
from moseg_learn.neighbourhoods import FloatArray, Neighbourhoods
from moseg_learn.position import POSITIONS, positions
from moseg_learn.surroundings import QUANTITIES, around

RADII = (0.04, 0.08, 0.16, 0.3)
"""Within which distances surroundings are looked at, in diagonals."""

FIELDS = ("basic:log_thickness", "basic:remoteness", "basic:concavity")
"""Ids of the fields that looks are made of, beside surroundings."""

CONSTANT = "constant"

MEASURED = (
    *("thickness", "remoteness", "log_remoteness", "concavity"),
    *POSITIONS,
    *(f"{name}_within_{round(100 * radius)}" for radius in RADII for name in QUANTITIES),
)
"""The quantities of an element that are measured; ``thickness`` is its logarithm."""

KEYS = (*MEASURED, *(f"relative_{name}" for name in MEASURED))
"""The quantities that a look has weights for."""

_ALIKE = 1e-3
"""What deviations are at least: where a quantity varies less over a shape, that is chance."""

MOST = math.log(1000.0)
"""How unlikely anything is at most: as if one in a thousand were so."""


@dataclass(frozen=True, eq=False)
class Looks:
    """Weights of each kind, read from a table.

    Parameters
    ----------
    kinds : tuple of str
    weights : (n, 116) float
        In the order of :data:`KEYS`.
    constants : (n,) float
    """

    kinds: tuple[str, ...]
    weights: FloatArray
    constants: FloatArray

    @classmethod
    def read(cls, among: Mapping[str, object]) -> Looks:
        """From a table of tables.

        Raises
        ------
        UsageError
            Not a table of numbers for each kind; a quantity that there is not, with the nearest.

        Examples
        --------
        >>> Looks.read({"leg": {"thickness": -3, "constant": 1}, "body": {}}).kinds
        ('leg', 'body')
        """
        return _read_once(among) if isinstance(among, Table) else _read(among)

    def kind(self, name: str) -> int:
        """The number of a kind.

        Raises
        ------
        UsageError
            There is none of the name; with the nearest.
        """
        if name not in self.kinds:
            raise UsageError(unknown("kind among the looks", name, self.kinds))
        return self.kinds.index(name)

    def unlikeliness(self, shape: Shape) -> FloatArray:
        """(F, n) float: ``-log p`` of each kind at each element, :data:`MOST` at most."""
        hoods = Neighbourhoods.of(shape)
        scores = hoods.on_elements(quantities(shape) @ self.weights.T + self.constants)
        return np.minimum(-log_probabilities(scores), MOST)


@lru_cache(maxsize=16)
def _read_once(among: Table) -> Looks:
    """See :meth:`Looks.read`; each term of a recipe, on each level, asks for the same table."""
    return _read(among)


def _read(among: Mapping[str, object]) -> Looks:
    """See :meth:`Looks.read`."""
    weights = np.zeros((len(among), len(KEYS) + 1))
    place = {key: k for k, key in enumerate((*KEYS, CONSTANT))}
    for row, (kind, own) in enumerate(among.items()):
        if not isinstance(own, Mapping):
            raise UsageError(f"the looks of '{kind}' must be a table of weights, not {own!r}")
        for key, weight in own.items():
            if key not in place:
                raise UsageError(f"in the looks of '{kind}': {unknown('quantity', key, place)}")
            if isinstance(weight, bool) or not isinstance(weight, (int, float)):
                raise UsageError(
                    f"in the looks of '{kind}': the weight '{key}' must be a number, not {weight!r}"
                )
            weights[row, place[key]] = weight
    return Looks(tuple(among), weights[:, :-1], weights[:, -1])


def unlikeliness(shape: Shape, *, kind: str = "", among: Table | None = None) -> FloatArray:
    """How unlikely it is that an element bears a label of a kind: ``-log p``.

    Parameters
    ----------
    shape : Shape
        A surface of which is known which elements touch.
    kind : str
        One of those in the table.
    among : Table
        The weights of each kind, see :mod:`moseg_learn.looks`. Without it nothing is known, and
        nothing unlikely; but all that scores are made of is measured, as before a search.

    Returns
    -------
    (F,) float
        0 where it is certain, 0.7 where it is as likely as not, and 6.9, ``-log 0.001``, where it
        is less likely than that; the natural logarithm. 0 is best.

    Raises
    ------
    UsageError
        A kind that is not in the table, a quantity that there is not.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> looks = moseg.Table({"head": {"width_within_30": 9, "constant": 6}, "handle": {}})
    >>> head = moseg.field_values(hammer, "learn:unlikeliness", kind="head", among=looks)
    >>> bool(0 <= head.min() < 0.2 and 1 < head.max() < 7)
    True
    """
    if among is None:
        quantities(shape)  # kept with the shape, for all processes of a search
        return np.zeros(shape.n_elements)
    looks = Looks.read(among)
    chosen = looks.kind(kind)
    key = ("learn looks", among)
    if key not in shape.made_from:
        shape.made_from[key] = looks.unlikeliness(shape)
    kept: FloatArray = shape.made_from[key]
    return kept[:, chosen]


def quantities(shape: Shape) -> FloatArray:
    """The quantities of each group of elements of a shape, computed once and kept with it.

    Parameters
    ----------
    shape : Shape
        As the user gave it.

    Returns
    -------
    (K, 116) float
        In the order of :data:`KEYS`.

    Raises
    ------
    ShapeError
        The shape lacks what the fields need.
    """
    key = ("learn quantities",)
    if key not in shape.made_from:
        thickness, remoteness, concavity = (field_values(shape, name) for name in FIELDS)
        own = np.stack([thickness, remoteness, np.log(remoteness), concavity], axis=1)
        means = Neighbourhoods.of(shape).of_elements(own)
        surroundings = (around(shape, radius) for radius in RADII)
        measured = np.hstack([means, positions(shape), *surroundings])
        shape.made_from[key] = np.hstack([measured, beside_the_rest(shape, measured)])
    kept: FloatArray = shape.made_from[key]
    return kept


def beside_the_rest(shape: Shape, measured: FloatArray) -> FloatArray:
    """Quantities of groups, compared with those of the whole shape.

    Parameters
    ----------
    shape : Shape
    measured : (K, d) float

    Returns
    -------
    (K, d) float
        -1 to 1; 0 at the mean over the surface.
    """
    areas = Neighbourhoods.of(shape).areas
    off = measured - np.average(measured, axis=0, weights=areas)
    deviation = np.sqrt(np.average(off**2, axis=0, weights=areas))
    z = off / np.maximum(deviation, _ALIKE)
    relative: FloatArray = z / np.sqrt(1.0 + z**2)
    return relative


def log_probabilities(scores: FloatArray) -> FloatArray:
    """(..., n) float: logarithms of the probabilities that scores stand for.

    Examples
    --------
    >>> np.exp(log_probabilities(np.array([[0.0, 0.0], [1000.0, 0.0]]))).tolist()
    [[0.5, 0.5], [1.0, 0.0]]
    """
    above = scores - scores.max(axis=-1, keepdims=True)
    found: FloatArray = above - np.log(np.exp(above).sum(axis=-1, keepdims=True))
    return found
