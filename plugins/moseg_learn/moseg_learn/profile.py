"""Profiles: typical value and spread of each measure of the parts of one kind.

Of the parts of a kind in all examples, ``typical = mean(x)`` and

    spread^2 = (sum (x - mean)^2 + n0 * pooled^2) / (n + n0),
    pooled = sqrt(mean over all kinds of (x - mean)^2) + 2 * floor,

with ``x`` the measure, or its logarithm where ratios count (``by_ratio`` of
``basic:likeness``). Few examples say little of how much a kind varies, so its spread is drawn to
what all kinds have in common, as heavily as ``n0 = 6`` parts would, and none is taken to be surer
than a floor for each measure. That is the posterior mean of a variance under a conjugate prior, as
in the moderated statistics of Smyth 2004, doi:10.2202/1544-6115.1027, with a prior that is fitted
by hand.

Where no kind has several parts, as in a single example without limbs, nothing is known of
spreads; then :data:`USUAL` stands in for what all kinds have in common.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from moseg_core import Target
from moseg_learn.pieces import Pieces

MEASURE = "basic:likeness"
"""The measure of a part that has all others by name."""

FloatArray = npt.NDArray[np.float64]

FLOORS: Mapping[str, float] = {
    "area": 0.15,
    "length": 0.1,
    "width": 0.1,
    "depth": 0.1,
    "spread": 0.1,
    "offcenter": 0.02,
    "thickness": 0.1,
    "unevenness": 0.05,
    "remoteness": 0.03,
    "nearest": 0.03,
    "farthest": 0.03,
    "boundary": 0.15,
    "crease": 0.1,
}
"""Of each measure half of what no spread falls below; logarithms where ratios count."""

USUAL: Mapping[str, float] = {
    "area": 0.35,
    "length": 0.2,
    "width": 0.2,
    "depth": 0.25,
    "spread": 0.1,
    "offcenter": 0.04,
    "thickness": 0.2,
    "unevenness": 0.1,
    "remoteness": 0.1,
    "nearest": 0.1,
    "farthest": 0.1,
    "boundary": 0.2,
    "crease": 0.1,
}
"""How much parts of one kind differ as a rule, in the same units."""

_NOTHING = 1e-6
"""Ratios to less than this mean nothing."""

Profile = dict[str, Target]
"""For each measure the typical value and the spread."""


def measures_of(pieces: Pieces) -> tuple[tuple[str, ...], FloatArray, frozenset[str]]:
    """All measures of all parts.

    Returns
    -------
    names : tuple of str
        Of the measures.
    values : (n, M) float
        A row for each part; NaN where the shape does not tell.
    by_ratio : frozenset of str
        The measures of which ratios count.

    Raises
    ------
    ShapeError
        A part has no extent.
    """
    found = [part.measure(MEASURE) for part in pieces.parts]
    return found[0]._fields, np.array(found, np.float64), frozenset(found[0].by_ratio)


def profiles_of(examples: Sequence[Pieces], *, prior: float, floor: float) -> dict[str, Profile]:
    """The profile of each kind.

    Parameters
    ----------
    examples : sequence of Pieces
    prior : float
        ``n0``, how many parts the common spread counts as.
    floor : float
        How many times :data:`FLOORS` is added to the common spread.

    Returns
    -------
    dict of str to Profile
        Kinds in alphabetical order. A measure that is not known of every part is left out, and of
        a kind one of whose parts has next to nothing of it, such as a depth, a measure of which
        ratios count.
    """
    tables = [measures_of(pieces) for pieces in examples]
    names, _, by_ratio = tables[0]
    kinds = np.array([kind for pieces in examples for kind in pieces.kinds])
    values = np.concatenate([rows for _, rows, _ in tables])
    known = ~np.isnan(values).any(axis=0)
    ratio = np.array([name in by_ratio for name in names])
    x = values.copy()
    x[:, ratio] = np.log(np.maximum(values[:, ratio], _NOTHING))
    off, several = np.zeros_like(x), np.zeros(len(x), np.bool_)
    for kind in np.unique(kinds):
        own = kinds == kind
        off[own] = x[own] - x[own].mean(axis=0)
        several[own] = own.sum() > 1
    floors = np.array([FLOORS[name] for name in names])
    if several.any():
        common = np.sqrt((off[several] ** 2).mean(axis=0))
    else:
        common = np.array([USUAL[name] for name in names])
    common = common + floor * floors
    found: dict[str, Profile] = {}
    for kind in sorted(set(kinds.tolist())):
        own = kinds == kind
        n = int(own.sum())
        spread = np.sqrt(((off[own] ** 2).sum(axis=0) + prior * common**2) / (n + prior))
        middle = x[own].mean(axis=0)
        found[kind] = {
            name: _target(middle[k], spread[k], bool(ratio[k]))
            for k, name in enumerate(names)
            if known[k] and not (ratio[k] and (values[own, k] <= _NOTHING).any())
        }
    return found


def _target(middle: float, spread: float, by_ratio: bool) -> Target:
    """A target of two digits of spread, and a value as exact as that makes sense."""
    if by_ratio:
        # z = ln(v / value) / ln(1 + spread / value) is 1 one spread of the logarithm away.
        value = math.exp(middle)
        spread = value * math.expm1(spread)
    else:
        value = middle
    digits = 1 - math.floor(math.log10(spread))
    rounded = round(value, digits)
    if by_ratio and rounded < 0.5 * value:  # a value far below its spread keeps two digits
        rounded = float(f"{value:.2g}")
    return Target(rounded, round(spread, digits))
