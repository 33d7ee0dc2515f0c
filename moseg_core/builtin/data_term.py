"""The data term of a minimum cut: what a problem says of places, element by element.

Most objectives judge a part as a whole. Some are the mean over the part of a field that says how
well the label fits each place (``mean_of`` of :func:`moseg_core.objective`), such as how unlikely
it is that it is part of a leg: a map of the surface. An element `e` of area `A` then costs under a
label

    A(e) / D^2 * sum of w f(e),

summed over the terms that the label stands in, `w` a term's weight, `f` its field and `D` the
diagonal of the bounding box. With the lengths of what is cut that is the energy of Kalogerakis,
Hertzmann and Singh 2010, doi:10.1145/1778765.1778839, Sec. 3, where ``f`` is ``-log p``.

The mean over a part says as much of an ear as of a torso; here both count by area, as it is places
that are judged. A label of which no term speaks costs what the others cost in the mean, so that
nothing is said for or against it.

:mod:`moseg_core.builtin.graph_cut` adds this to what it cuts.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_values
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray


class PlaceTerm(NamedTuple):
    """A term of a problem that says of each place how well some labels fit.

    Parameters
    ----------
    weight : float
        The term's, with its sign.
    labels : tuple of int
        Those that it is about.
    field : str
        Its id; low where the labels fit, if the weight is positive.
    parameters : mapping of str to value
        The field's.
    """

    weight: float
    labels: tuple[int, ...]
    field: str
    parameters: Mapping[str, Any]


def place_terms(problem: Problem) -> tuple[PlaceTerm, ...]:
    """The terms of a problem that are means of fields.

    Raises
    ------
    UsageError
        A call's parameters do not go together.
    PluginError
        An objective fails to say which field it is the mean of.

    Examples
    --------
    >>> from moseg_core import Part, objective
    >>> @objective(range=(0, 1), mean_of=lambda given: ("basic:thickness", {}))
    ... def thin(part: Part) -> float:
    ...     return part.field("basic:thickness").mean
    >>> problem = Problem(["leg", "top"], "2*thin(leg) + compact(top)", objectives={"thin": thin})
    >>> place_terms(problem)
    (PlaceTerm(weight=2.0, labels=(0,), field='basic:thickness', parameters={}),)
    """
    found = []
    for term in problem.terms:
        averaged = term.averaged_field
        if averaged is not None:
            labels = tuple(label for call in term.calls for label in call)
            found.append(PlaceTerm(term.weight, labels, *averaged))
    return tuple(found)


def place_costs(problem: Problem, shape: Shape, elements: IntArray) -> FloatArray:
    """What elements cost under each label by the terms of a problem that speak of places.

    Parameters
    ----------
    problem : Problem
    shape : Shape
    elements : (k,) int
        Numbers of elements of the shape.

    Returns
    -------
    (k, n) float
        For a unit of area or volume; 0 everywhere where the problem has no such terms. As large
        as the fields are, and negative where these are.

    Raises
    ------
    ShapeError
        A field needs what the shape does not have.
    MosegError
        See :func:`place_terms` and :func:`~moseg_core.field_values`.
    """
    costs = np.zeros((len(elements), len(problem.labels)))
    spoken_of = np.zeros(len(problem.labels), np.bool_)
    lookup = Lookup(problem.registry)
    for term in place_terms(problem):
        values = field_values(shape, term.field, lookup=lookup, **term.parameters)
        costs[:, term.labels] += term.weight * values[elements, None]
        spoken_of[list(term.labels)] = True
    if spoken_of.any():
        costs[:, ~spoken_of] = costs[:, spoken_of].mean(axis=1, keepdims=True)
    return costs
