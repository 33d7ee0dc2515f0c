"""A discriminant: from labelled examples to the weights that tell kinds apart, as a table.

The weights of :mod:`moseg_learn.looks` are those of multinomial logistic regression with a ridge
(le Cessie and van Houwelingen 1992, doi:10.2307/2347628): with the quantities ``z`` standardised,
they make ::

    -sum_i b_i log p(kind of i | z_i)  +  1 / (2 m) * sum_k sum_x r_x w_kx^2

least, with a :data:`RIDGE` ``r_x`` for each quantity, over groups of elements ``i`` of ``m``
examples with weights ``b_i``, 1 together. Such a weight is the group's area, times the root of how
much less area its kind has than all: halfway between kinds by area, where an ear would not be worth
seeing, and kinds all alike. (Fisher's linear
discriminant with a shared and shrunk covariance has the same form, and was too sure of itself.)

**Calibration.** On a shape that was not among the examples, what was fitted is surer than it should
be. So each example is left out in turn, and the temperature ``T`` is found by which to divide
all scores for the mean of ``-log p`` of what was left out to be least (Guo, Pleiss, Sun and
Weinberger 2017, arXiv:1706.04599). What was fitted to all examples has seen one more, and errs
less: its scores are divided by ``T`` to the power of ``1 - 1/m``. A single example says nothing of
that, and :data:`ALONE` is taken. (By trial: of examples two, three and four in nineteen categories,
the exponents 1/2, 2/3 and 3/4 are about the best.)

The standardisation goes into weights and constants, and those are rounded: the table is all there
is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from moseg_core import Example, UsageError
from moseg_learn.looks import CONSTANT, KEYS, MEASURED, MOST, log_probabilities, quantities
from moseg_learn.neighbourhoods import FloatArray, Neighbourhoods

RIDGE = np.where(np.arange(len(KEYS)) < len(MEASURED), 0.5, 0.1)
"""What large weights cost, beside the mean of ``-log p`` over one example.

Of quantities that are measured more than of those that compare places with the rest of their shape:
the former differ more from shape to shape. (By trial, each of 95 models in nineteen categories left
out in turn: 86.1 % of the area right place by place; the latter alone 85.7, both at 0.3 85.6, the
former alone 84.2, and 80.9 without positions and normals.)
"""

ALONE = 1.0
"""The temperature where there is one example: the best of 1, 1.5, 2, 3 on nineteen categories."""

_DIGITS = 4
_STEPS = 100


@dataclass(frozen=True, eq=False)
class Sample:
    """What is known of an example: quantities of its groups, and which kinds they are of.

    Parameters
    ----------
    values : (K, 116) float
        In the order of :data:`moseg_learn.looks.KEYS`.
    shares : (K, n) float
        Of the area of the shape, what each group has of each kind; 1 together.
    """

    values: FloatArray
    shares: FloatArray

    @classmethod
    def of(cls, example: Example, kinds: Sequence[str]) -> Sample:
        """From an example; its names are kinds."""
        shape, groups = example.shape, Neighbourhoods.of(example.shape).groups
        members = np.arange(shape.n_elements) if groups.members is None else groups.members
        place = np.array([kinds.index(name) if name in kinds else -1 for name in example.names])
        known = example.labels >= 0  # nothing is learned where nobody has said what it is
        cell = (members * len(kinds) + place[example.labels])[known]
        shares: FloatArray = np.bincount(
            cell, (shape.areas / shape.area)[known], groups.n_elements * len(kinds)
        ).astype(np.float64)
        return cls(quantities(shape), shares.reshape(-1, len(kinds)))


def fit_looks(examples: Sequence[Example]) -> dict[str, dict[str, float]]:
    """The looks of each kind of part, from examples.

    Parameters
    ----------
    examples : sequence of Example
        Their names are kinds: ``leg``, not ``leg1`` to ``leg4``. One is enough; from two on it is
        known how sure one can be.

    Returns
    -------
    dict of str to dict of str to float
        For each kind, in alphabetical order, the weight of each quantity and the ``constant``: what
        :class:`moseg_core.Table` and :mod:`moseg_learn.looks` take.

    Raises
    ------
    UsageError
        No example.
    ShapeError
        A shape is no surface, or it is not known which of its elements touch.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> truth = moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)
    >>> looks = fit_looks([moseg.Example(hammer, truth.labels, truth.names)])
    >>> list(looks), looks["head"]["width_within_30"] > looks["handle"]["width_within_30"]
    (['handle', 'head'], True)
    """
    if not examples:
        raise UsageError("there is nothing to learn from; give at least one example")
    kinds = sorted({name for example in examples for name in example.borne})
    samples = [Sample.of(example, kinds) for example in examples]
    looks = fitted(samples)
    temperature = temperature_of(samples) if len(samples) > 1 else ALONE
    return _written(kinds, looks, temperature, samples)


def fitted(samples: Sequence[Sample]) -> tuple[FloatArray, FloatArray]:
    """Weights of each kind and constants, for quantities in their own units.

    Parameters
    ----------
    samples : sequence of Sample

    Returns
    -------
    weights : (n, 116) float
    constants : (n,) float
        Minus infinity for a kind that none of the samples has.
    """
    values = np.concatenate([sample.values for sample in samples])
    shares = np.concatenate([sample.shares for sample in samples])
    area, own = shares.sum(axis=1), shares.sum(axis=0)
    middle = np.average(values, axis=0, weights=area)
    scale = np.sqrt(np.average((values - middle) ** 2, axis=0, weights=area))
    scale = np.where(scale > 1e-9, scale, 1.0)
    there = own > 0
    wanted = shares[:, there] * np.sqrt(own.sum() / own[there])
    wanted /= wanted.sum()
    standard = np.column_stack([(values - middle) / scale, np.ones(len(values))])
    solution = _solved(standard, wanted, RIDGE / len(samples))
    weights, constants = np.zeros((len(own), len(scale))), np.full(len(own), -np.inf)
    weights[there] = solution[:, :-1] / scale
    constants[there] = solution[:, -1] - weights[there] @ middle
    return weights, constants


def _solved(standard: FloatArray, wanted: FloatArray, costs: FloatArray) -> FloatArray:
    """(n, d) float: coefficients of each kind, the last of them the constant.

    Parameters
    ----------
    standard : (K, d) float
        Standardised quantities, and a column of ones.
    wanted : (K, n) float
        How much each group should be of each kind, 1 together.
    costs : (d - 1,) float
        What large coefficients cost; constants cost nothing.
    """
    size, total = (wanted.shape[1], standard.shape[1]), wanted.sum(axis=1, keepdims=True)
    ridge = np.append(costs, 0.0)

    def loss(flat: FloatArray) -> tuple[float, FloatArray]:
        coefficients = flat.reshape(size)
        logs = log_probabilities(standard @ coefficients.T)
        slope = (total * np.exp(logs) - wanted).T @ standard + ridge * coefficients
        value = (ridge * coefficients**2).sum() / 2.0 - (wanted * logs).sum()
        return float(value), slope.ravel()

    found = optimize.minimize(
        loss, np.zeros(size).ravel(), jac=True, method="L-BFGS-B", options={"maxiter": _STEPS}
    )
    coefficients: FloatArray = found.x.reshape(size)
    coefficients -= coefficients.mean(axis=0)
    return coefficients


def temperature_of(samples: Sequence[Sample]) -> float:
    """By what to divide scores that are fitted to samples, so that of others they say how likely.

    Parameters
    ----------
    samples : sequence of Sample
        Two or more.

    Returns
    -------
    float
        Above 1 where the fit is surer than it should be.
    """
    judged = []
    for k, left_out in enumerate(samples):
        weights, constants = fitted([*samples[:k], *samples[k + 1 :]])
        known = np.isfinite(constants)
        if left_out.shares[:, known].any():
            scores = left_out.values @ weights[known].T + constants[known]
            judged.append((scores, left_out.shares[:, known]))
    if not judged:
        return ALONE

    def unlikeliness(log_temperature: float) -> float:
        divisor = np.exp(log_temperature)
        return sum(
            float((shares * np.minimum(-log_probabilities(scores / divisor), MOST)).sum())
            for scores, shares in judged
        )

    found = optimize.minimize_scalar(
        unlikeliness, bounds=(np.log(0.5), np.log(20.0)), method="bounded"
    )
    return float(np.exp(found.x * (1.0 - 1.0 / len(samples))))


def _written(
    kinds: Sequence[str],
    looks: tuple[FloatArray, FloatArray],
    temperature: float,
    samples: Sequence[Sample],
) -> dict[str, dict[str, float]]:
    """The table: at the mean of the quantities, rounding weights changes no score."""
    weights, constants = (each / temperature for each in looks)
    areas = np.concatenate([sample.shares.sum(axis=1) for sample in samples])
    middle = np.average(
        np.concatenate([sample.values for sample in samples]), axis=0, weights=areas
    )
    table = {}
    for kind, own, constant in zip(kinds, weights, constants, strict=True):
        rounded = [_rounded(weight) for weight in own.tolist()]
        shift = float(constant + own @ middle - np.array(rounded) @ middle)
        table[kind] = {**dict(zip(KEYS, rounded, strict=True)), CONSTANT: round(shift, 3)}
    return table


def _rounded(number: float) -> float:
    """To :data:`_DIGITS` digits, and none beyond the fourth decimal."""
    return round(float(f"{number:.{_DIGITS}g}"), 4)
