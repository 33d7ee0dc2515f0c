"""Problems within problems: parts that are segmented in their turn (Fig. 8).

The paper segments "by multiple objectives hierarchically: first segment to maximize planar
symmetry of parts, then by convex components, and then integrate the result". A
:class:`Hierarchy` states such a task: a problem for the whole, and for some of its labels another
hierarchy, for the part of that label alone. So a tree of problems; the *leaves* are the labels of
the result, called by their *path*: ``body``, ``head/ear1``, ``head/ear2``.

Every level is a problem of its own. Its expression knows its own labels, by their short names, and
looks at its own shape, the part with its cuts capped (:mod:`moseg_core.shape.subshape`). The cost
of a segmentation is the sum over all levels, each counted once; weights in front of a whole level
are written into its expression. How it is solved is in :mod:`moseg_core.search.levels`.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Registry
from moseg_core.errors import UsageError, unknown
from moseg_core.problem.aggregate import CallValue, Evaluation, TermValue
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import CHOSEN_KINDS, Method, SearchOptions, check_method
from moseg_core.problem.statement import SEPARATOR, Statement, joined
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from moseg_core.types import IntArray

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """A problem, and problems for some of its parts.

    Parameters
    ----------
    problem : Problem
        For the whole.
    parts : mapping of str to Problem or Hierarchy
        For parts of it, by label or glob: ``{"leg*": Problem(["upper", "lower"], ...)}``. A label
        goes before a glob, an earlier glob before a later one. The others stay whole.
    search : Method
        How the problem for the whole is solved; that of a part has its own.

    Raises
    ------
    UsageError
        A label that the problem does not have, or a glob that matches none of its labels.

    Examples
    --------
    >>> task = Hierarchy(Problem(["head", "body"], "narrow(body)"),
    ...                  {"head": Problem(["ear1", "ear2", "skull"], "narrow(ear*)")})
    >>> task.labels
    ('head/ear1', 'head/ear2', 'head/skull', 'body')
    """

    problem: Problem
    parts: Mapping[str, Problem | Hierarchy] = field(default_factory=dict)
    search: Method = field(default_factory=Method)

    def __post_init__(self) -> None:
        if not isinstance(self.problem, Problem):
            raise UsageError(f"a hierarchy is made of problems, not of {self.problem!r:.60}")
        check_method(self.search, "a hierarchy's search")
        found = expand_parts(self.parts.items(), self.problem.labels)
        for label, part in found.items():
            if not isinstance(part, Problem | Hierarchy):
                raise UsageError(
                    f"part '{label}' is divided by a Problem or a Hierarchy, not by {part!r:.60}"
                )
        object.__setattr__(self, "parts", found)

    def __repr__(self) -> str:
        return f"Hierarchy({', '.join(self.labels)})"

    @classmethod
    def of(cls, statement: Statement, *, registry: Registry | None = None) -> Hierarchy:
        """The problems that a statement asks for, with all names looked up.

        Parameters
        ----------
        statement : Statement
        registry : Registry, optional
            Where to look; everything installed by default.

        Raises
        ------
        UsageError, PluginError
            See :class:`moseg_core.Problem`; the labels have counts that stand for several label
            sets (:func:`moseg_core.problem.variants.closed_statements`).
        """
        statement = statement.written_out()
        parts = {label: cls.of(part, registry=registry) for label, part in statement.parts}
        return cls(Problem.of(statement, registry=registry), parts, statement.search)

    @cached_property
    def statement(self) -> Statement:
        """What was asked for, on all levels."""
        parts = tuple((label, child.statement) for label, child in self.children.items())
        return replace(self.problem.statement, search=self.search, parts=parts)

    @cached_property
    def children(self) -> Mapping[str, Hierarchy]:
        """The parts that are divided, in the order of the problem's labels."""
        return {
            label: part if isinstance(part, Hierarchy) else Hierarchy(part)
            for label, part in self.parts.items()
        }

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The leaves' paths: the labels of a result, those of one part side by side."""
        paths: list[str] = []
        for label in self.problem.labels:
            child = self.children.get(label)
            paths += [label] if child is None else [joined(label, leaf) for leaf in child.labels]
        return tuple(paths)

    @cached_property
    def owners(self) -> IntArray:
        """(n,) int: for each leaf the label of the whole that it belongs to."""
        sizes = [
            len(self.children[label].labels) if label in self.children else 1
            for label in self.problem.labels
        ]
        return np.repeat(np.arange(len(sizes)), sizes)

    def first_leaf(self, path: str) -> int:
        """Index of the leaf of a path, or of the first leaf below it.

        Raises
        ------
        UsageError
            There is none.

        Examples
        --------
        >>> ends = Problem(["c", "d"], "flat(c)")
        >>> task = Hierarchy(Problem(["a", "b"], "narrow(a)"), {"b": ends})
        >>> task.first_leaf("b"), task.first_leaf("b/d")
        (1, 2)
        """
        for k, leaf in enumerate(self.labels):
            if leaf == path or leaf.startswith(path + SEPARATOR):
                return k
        raise UsageError(unknown("label", path, self.labels))

    @property
    def registry(self) -> Registry:
        """Where installed components are looked up."""
        return self.problem.registry

    @property
    def versions(self) -> dict[str, str]:
        """Of each component on any level, by id, the distribution and its version.

        Those that the problems name, and those that search where the request names no others.

        Raises
        ------
        UsageError
            A level is to be searched by a component that is not installed.

        Examples
        --------
        >>> task = Hierarchy(Problem(["a"], "narrow(a)"))
        >>> [name for name in task.versions if name.startswith("core:")]
        ['core:hungarian', 'core:kmeans', 'core:pattern_search', 'core:voronoi']
        """
        named: dict[str, str] = {}
        for _, level in self.levels():
            named |= level.problem.versions
            settled = SearchOptions().settled(level.search)
            for kind in CHOSEN_KINDS:
                if (choice := getattr(settled, kind)) is None:
                    continue
                component = level.registry.find(kind, choice.name)
                named[component.id] = component.distribution
        return dict(sorted(named.items()))

    def levels(self, path: str = "") -> Iterator[tuple[str, Hierarchy]]:
        """Every level with its path, "" for the whole; a part after what it is a part of."""
        yield path, self
        for label, child in self.children.items():
            yield from child.levels(joined(path, label))

    def embed(self, shape: Shape) -> Shape:
        """The shape in which the partition of the whole is found (Sec. 9)."""
        return self.problem.embed(shape)

    def check(self, shape: Shape) -> None:
        """Refuse a shape that the problem for the whole cannot be solved on.

        Raises
        ------
        ShapeError
            See :meth:`moseg_core.Problem.check`.
        """
        self.problem.check(shape)

    def without(self, label: str) -> Hierarchy:
        """The same, with one part of the whole left whole."""
        return replace(self, parts={k: part for k, part in self.children.items() if k != label})

    def fitted(self, names: Iterable[str]) -> Hierarchy:
        """The hierarchy whose leaves are among certain names: what bears its own name is whole.

        Parameters
        ----------
        names : iterable of str
            Paths. Where one is the path of a divided part, that part is left whole.

        Examples
        --------
        >>> ears = Problem(["ear1", "ear2"], "narrow(ear*)")
        >>> Hierarchy(Problem(["a", "b"], "narrow(a)"), {"*": ears}).fitted(["b"]).labels
        ('a/ear1', 'a/ear2', 'b')
        """
        paths = set(names)
        parts = {
            label: child.fitted(
                name.removeprefix(label + SEPARATOR)
                for name in paths
                if name.startswith(label + SEPARATOR)
            )
            for label, child in self.children.items()
            if label not in paths
        }
        return replace(self, parts=parts)

    def evaluate(self, shape: Shape, labels: npt.ArrayLike) -> Evaluation:
        """Cost and terms of any labelling, on all levels.

        Parameters
        ----------
        shape : Shape
        labels : (F,) array_like of int
            Index into :attr:`labels` for every element.

        Returns
        -------
        Evaluation
            The sum over all levels (:func:`combined`). Of a part with fewer elements than its
            problem has labels every term is left out, and all its leaves count as empty.

        Raises
        ------
        ShapeError
            The labels do not fit the shape, or a part lacks what a term needs.

        Examples
        --------
        >>> strip = Shape.from_mesh([[x, y, 0] for x in range(4) for y in (0, 1)],
        ...                         [[0, 2, 3, 1], [2, 4, 5, 3], [4, 6, 7, 5]])
        >>> task = Hierarchy(Problem(["a", "b"], "flat(a)"), {"b": Problem(["c", "d"], "flat(d)")})
        >>> [term.text for term in task.evaluate(strip, [0, 1, 2]).terms]
        ['flat(a)', 'b: flat(d)']
        """
        leaves = checked_labels(shape, labels, len(self.labels)).astype(np.int64)
        return combined(dict(self._evaluations(shape, leaves, "")))

    def _evaluations(
        self, shape: Shape, leaves: IntArray, path: str
    ) -> Iterator[tuple[str, Evaluation]]:
        whole = self.owners[leaves]
        yield path, self.problem.evaluate(shape, whole)
        for label, child in self.children.items():
            owner = self.problem.labels.index(label)
            elements = np.flatnonzero(whole == owner)
            inner = joined(path, label)
            if len(elements) < len(child.problem.labels):
                yield from ((p, absent(level.problem)) for p, level in child.levels(inner))
                continue
            part = subshape(shape, elements, name=joined(shape.name, label))
            first = int(np.searchsorted(self.owners, owner))
            yield from child._evaluations(part, leaves[elements] - first, inner)


def expand_parts(given: Iterable[tuple[str, T]], labels: Sequence[str]) -> dict[str, T]:
    """What is given for labels and globs, by label, in the order of the labels.

    Raises
    ------
    UsageError
        An unknown label, with the nearest, or a glob that matches none.

    Examples
    --------
    >>> expand_parts([("leg*", 1), ("leg2", 2)], ["head", "leg1", "leg2"])
    {'leg1': 1, 'leg2': 2}
    """
    found: dict[str, T] = {}
    exact: set[str] = set()
    for key, value in given:
        if "*" in key:
            matched = [label for label in labels if fnmatch.fnmatchcase(label, key)]
            if not matched:
                raise UsageError(f"parts: '{key}' matches none of the labels {', '.join(labels)}")
            for label in matched:
                found.setdefault(label, value)
        elif key not in labels:
            raise UsageError(f"parts: {unknown('label', key, labels)}")
        else:
            exact.add(key)
            found[key] = value
    return {label: found[label] for label in labels if label in found}


def combined(levels: Mapping[str, Evaluation]) -> Evaluation:
    """The evaluations of several levels as one: costs and counts add up.

    Parameters
    ----------
    levels : mapping of str to Evaluation
        By path, "" for the whole.

    Returns
    -------
    Evaluation
        Its terms are those of all levels, with the path in front, ``head: narrow(ear*)``, and
        labels as paths.
    """
    return Evaluation(
        cost=Cost(
            sum(level.cost.empty for level in levels.values()),
            sum(level.cost.value for level in levels.values()),
        ),
        terms=tuple(
            _located(term, path) if path else term
            for path, level in levels.items()
            for term in level.terms
        ),
        empty=tuple(joined(path, name) for path, level in levels.items() for name in level.empty),
        broken_pins=sum(level.broken_pins for level in levels.values()),
    )


def _located(term: TermValue, path: str) -> TermValue:
    """A term of a part, with the path of the part."""
    calls = tuple(
        replace(call, labels=tuple(joined(path, label) for label in call.labels))
        for call in term.calls
    )
    return replace(term, text=f"{path}: {term.text}", calls=calls)


def absent(problem: Problem) -> Evaluation:
    """A problem's evaluation where there is no part to divide: all empty, all left out."""
    return Evaluation(
        cost=Cost(len(problem.labels), 0.0),
        terms=tuple(
            TermValue(
                text=term.term.call,
                objective=term.id,
                weight=term.weight,
                calls=tuple(
                    CallValue(labels=tuple(problem.labels[k] for k in call), value=None)
                    for call in term.calls
                ),
                worst=term.objective.traits.range[1 if term.weight > 0 else 0],
            )
            for term in problem.terms
        ),
        empty=problem.labels,
    )
