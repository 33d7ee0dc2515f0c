"""Learning: from shapes whose parts are labelled to a recipe for others of their kind.

A person who cannot say what the parts of a shape are like can show some. An :class:`Example` is a
shape with a named label for each of its elements, or for some. A *learner* makes a recipe of
several: a function ``f(examples, **parameters)`` that returns a
:class:`~moseg_core.problem.recipe.Recipe`, which a bundle brings through the hook
``moseg_learners``. What comes out is a recipe like any other: a text that its owner can read,
change and send.

What all learners promise is checked by :mod:`moseg_core.testing.checks.learners`: the same examples
in any order give the same recipe, which has every label that the examples bear.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.discovery.registry import Registry, registry
from moseg_core.errors import REPORT, PluginError, ShapeError, UsageError
from moseg_core.problem.recipe import Recipe
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.shape import Shape
from moseg_core.types import UNLABELLED, frozen

USUAL = "profiles"
"""The learner that is meant where none is named."""


@dataclass(frozen=True, eq=False)
class Example:
    """A shape whose parts somebody has labelled.

    Parameters
    ----------
    shape : Shape
    labels : (F,) array_like of int
        For each element of the shape the number of its label, from 0; -1 where nobody has said what
        it is, and nothing is learned of it.
    names : sequence of str
        ``names[k]`` is the name of label ``k``; distinct. One that no element bears says nothing.

    Raises
    ------
    ShapeError
        Not one label for each element, a label without a name, or no element with a label.
    UsageError
        A name that is empty, or given twice.

    Examples
    --------
    >>> tile = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    >>> Example(tile, [0, 1], ["left", "right"])
    Example(shape: left, right)
    """

    shape: Shape
    labels: npt.NDArray[np.int64]
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        names = tuple(self.names)
        for name in names:
            if not isinstance(name, str) or not name:
                raise UsageError(f"the name of a label is a text, not {name!r}")
            if names.count(name) > 1:
                raise UsageError(f"label '{name}' is named twice; labels have distinct names")
        checked = checked_labels(self.shape, self.labels, len(names), unlabelled=True)
        labels = np.array(checked, dtype=np.int64)
        if (labels == UNLABELLED).all():
            raise ShapeError(f"'{self.shape.name}': no {self.shape.noun} has a label")
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "labels", frozen(labels))

    @property
    def borne(self) -> tuple[str, ...]:
        """The names that some element bears, in their order."""
        labels = self.labels[self.labels != UNLABELLED]
        return tuple(self.names[k] for k in np.unique(labels).tolist())

    def __repr__(self) -> str:
        return f"Example({self.shape.name}: {', '.join(self.borne)})"


def learn(
    examples: Iterable[Example],
    *,
    learner: str | Mapping[str, Any] | Choice = USUAL,
    source: Registry | None = None,
) -> Recipe:
    """Make a recipe of examples.

    Parameters
    ----------
    examples : iterable of Example
        One or more; their order does not matter.
    learner : str, mapping or Choice
        By name and with parameters, as other components are chosen: ``"profiles(likely=0)"``.
    source : Registry, optional
        Where to look for it; everything installed by default.

    Returns
    -------
    Recipe
        :meth:`~moseg_core.Recipe.toml` is its text.

    Raises
    ------
    UsageError
        No example, an unknown learner or parameter; or examples that the learner cannot use.
    ShapeError
        A shape lacks what the learner measures.
    PluginError
        The learner fails, or returns no recipe.

    Examples
    --------
    >>> recipe = learn([Example(cat, labels, names)])  # doctest: +SKIP
    >>> Path("cat.toml").write_text(recipe.toml())  # doctest: +SKIP
    """
    given = tuple(examples)
    if not given:
        raise UsageError("there is nothing to learn from; give at least one example")
    for example in given:
        if not isinstance(example, Example):
            raise UsageError(f"an example is an Example(shape, labels, names), not {example!r:.60}")
    prepared = prepare(
        Choice.read(learner, "learner"), "learner", registry() if source is None else source
    )
    with prepared.guard():
        recipe = prepared.factory(given, **prepared.parameters)
    if not isinstance(recipe, Recipe):
        raise PluginError(
            f"{prepared.who} returned a {type(recipe).__name__}, not a Recipe; {REPORT}"
        )
    return recipe
