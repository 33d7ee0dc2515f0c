"""Segmenting parts in their turn, and putting all levels into one result (Fig. 8).

The whole is segmented first. Each part whose label has a problem of its own is then taken out as a
shape of its own (:mod:`moseg_core.shape.subshape`) and segmented as if it had come from a file:
with its own unit coordinates, method and starts, and the same seed. So what is found on a part is
what :func:`moseg_core.segment` finds on it, and levels never go back on what was decided above
them.

A part that cannot be divided stays whole under its own name, with a warning that says why: it is
empty, it has fewer elements than there are labels for it, it lacks what a term or a constraint
needs, or the run was asked to stop before its turn.

The levels are merged by :class:`moseg_core.problem.hierarchy.Hierarchy`'s rules: labels are paths,
costs add up. History, method and warnings of a part bear its path in front: ``head: search``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Unpack, cast

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import Registry
from moseg_core.components.discovery.specs import ParameterizationSpec, SeederSpec
from moseg_core.components.protocols import Centers, Progress, Report, never_stop
from moseg_core.errors import MosegError, ShapeError, UsageError
from moseg_core.problem.hierarchy import Hierarchy, combined
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe
from moseg_core.problem.settings import OptionValues, SearchOptions
from moseg_core.problem.statement import joined
from moseg_core.search.alignment import Alignment
from moseg_core.search.described_run import digest_of, run_of
from moseg_core.search.pieces import PinsGiven, on_large_pieces
from moseg_core.search.request import prepare_components
from moseg_core.search.restarts import Listener
from moseg_core.search.result import Result
from moseg_core.search.segment import solve
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from moseg_core.types import IntArray


def segment_hierarchy(
    shape: Shape,
    task: Hierarchy | Recipe | Problem,
    *,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
    **options: Unpack[OptionValues],
) -> Result:
    """Segment a shape, then its parts, and so on.

    Parameters
    ----------
    shape : Shape
    task : Hierarchy, Recipe or Problem
        A plain problem is segmented as by :func:`moseg_core.segment`.
    start, freeze, pins
        As for :func:`moseg_core.segment`, about the first level only: by its labels.
    report : callable, optional
        As for :func:`moseg_core.segment`; the level stands in front of the stage.
    **options
        The fields of :class:`moseg_core.SearchOptions`, on every level in place of what the level's
        own options say. A seeder that takes centres, such as "given", is about the first level
        only, and so are parameters that name labels, such as "centers" of "voronoi". The seconds
        are shared: each level gets its part of what is left.

    Returns
    -------
    Result
        Its labels are the leaves' paths, its cost is the sum over all levels.

    Raises
    ------
    UsageError, ShapeError, PluginError
        As for :func:`moseg_core.segment`, with what was found on all levels as the error's
        ``result``. What is wrong with a single part is a warning.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> shape = moseg.load(moseg.sample_path("hammer"))
    >>> task = moseg.Hierarchy(moseg.Problem(["handle", "head"], "narrow(handle)"),
    ...                        {"head": moseg.Problem(["face", "claw"], "compact(face)")})
    >>> result = moseg.segment_hierarchy(shape, task, optimizer="pattern_search(max_evaluations=9)")
    >>> list(result.parts)
    ['handle', 'head/face', 'head/claw']
    """
    return solve_hierarchy(
        shape,
        as_hierarchy(task),
        SearchOptions.of(options),
        start=start,
        freeze=freeze,
        pins=pins,
        report=report,
    )


def solve_hierarchy(
    shape: Shape,
    hierarchy: Hierarchy,
    options: SearchOptions,
    *,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
) -> Result:
    """The same as :func:`segment_hierarchy`, with the options in one piece."""
    check_hierarchy(hierarchy, options)
    listener = Listener(report or never_stop)

    def search(part: Shape, rest: SearchOptions, its: PinsGiven) -> Result:
        descent = _Descent.of(hierarchy, rest, listener)
        whole = descent.search(part, hierarchy, "", start=start, freeze=freeze, pins=its)
        return descent.merged(whole, hierarchy)

    with run_of(shape, lambda: [hierarchy], options, start=start, freeze=freeze, pins=pins):
        return on_large_pieces(shape, options, search, pins)


def refine(
    result: Result,
    parts: Mapping[str, Problem | Hierarchy | Recipe],
    *,
    report: Report | None = None,
    **options: Unpack[OptionValues],
) -> Result:
    """Segment the parts of a result further.

    Parameters
    ----------
    result : Result
        Of one level.
    parts : mapping of str to Problem, Hierarchy or Recipe
        By label or glob of the result.
    report, **options
        As for :func:`segment_hierarchy`; the seed is the result's unless given.

    Returns
    -------
    Result
        The same as :func:`segment_hierarchy` finds if its first level is this result.

    Raises
    ------
    UsageError
        An unknown label, or a result of several levels.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> shape = moseg.load(moseg.sample_path("hammer"))
    >>> few = "pattern_search(max_evaluations=9)"
    >>> result = moseg.segment(
    ...     shape, moseg.Problem(["handle", "head"], "narrow(handle)"), optimizer=few)
    >>> ends = moseg.Problem(["a", "b"], "compact(a)")
    >>> list(moseg.refine(result, {"head": ends}, optimizer=few).parts)
    ['handle', 'head/a', 'head/b']
    """
    if isinstance(result.problem, Hierarchy):
        raise UsageError(
            "the result is of several levels; nest problems in the Hierarchy of a part instead"
        )
    hierarchy = Hierarchy(
        result.problem, {label: as_hierarchy(part) for label, part in parts.items()}
    )
    options.setdefault("seed", result.seed)
    search = SearchOptions.of(options)
    check_hierarchy(hierarchy, search)
    asked = {"parts of": digest_of(result.labels), **hierarchy.statement.document()}
    with run_of(result.shape, lambda: [hierarchy], search, asked=asked, start=result):
        return divided(result, hierarchy, search, Listener(report or never_stop))


def divided(
    result: Result, hierarchy: Hierarchy, options: SearchOptions, listener: Listener
) -> Result:
    """A result of the first level of a hierarchy, with the parts segmented that it divides."""
    descent = _Descent.of(hierarchy, options, listener)
    descent.left -= 1
    return descent.merged(result, hierarchy)


def check_hierarchy(hierarchy: Hierarchy, options: SearchOptions) -> None:
    """Check on every level what can be checked before a shape is there.

    Parameters
    ----------
    hierarchy : Hierarchy
    options : SearchOptions

    Raises
    ------
    UsageError, PluginError
        An unknown component or parameter, or a resolution too low for the labels of a level.
    """
    for path, level in hierarchy.levels():
        settled = _for_level(options, path, level.problem.registry).settled(level.search)
        prepare_components(level.problem, settled)
        settled.check_resolution(len(level.problem.labels), path)


def as_hierarchy(task: Hierarchy | Recipe | Problem) -> Hierarchy:
    """A task of any form as a hierarchy, of one level where no part is divided.

    Raises
    ------
    UsageError
        It is none of these.
    """
    if isinstance(task, Hierarchy):
        return task
    if isinstance(task, Recipe):
        return task.hierarchy()
    if isinstance(task, Problem):
        return Hierarchy(task)
    raise UsageError(f"a Hierarchy, Recipe or Problem is needed, not {task!r:.60}")


def _for_level(options: SearchOptions, path: str, registry: Registry) -> SearchOptions:
    """The options for one level: what is about places or labels of the whole is left out below it.

    A parameterization of which nothing else was said is then that of the level.
    """
    if path and isinstance(options.seeder, Choice):
        seeder = options.seeder.component("seeder", registry)
        if cast(SeederSpec, seeder.spec).takes_centers:
            options = replace(options, seeder=None)
    if path and isinstance(options.parameterization, Choice):
        chosen, given = options.parameterization, options.parameterization.parameters
        spec = cast(ParameterizationSpec, chosen.component("parameterization", registry).spec)
        rest = {key: value for key, value in given.items() if key not in spec.label_parameters}
        if len(rest) < len(given):
            options = replace(
                options, parameterization=replace(chosen, parameters=rest) if rest else None
            )
    return options


@dataclass(kw_only=True)
class _Descent:
    """A run over all levels: what they share, and what was found so far.

    Parameters
    ----------
    options : SearchOptions
    listener : Listener
    deadline : float or None
        On the clock of :func:`time.monotonic`.
    left : int
        Levels whose turn is yet to come.
    found : dict of str to Result
        Of each level searched, by path.
    whole : list of str
        Why parts were left whole.
    failure : MosegError or None
        What ended the run; the levels whose turn was to come are left whole.
    """

    options: SearchOptions
    listener: Listener
    deadline: float | None
    left: int
    found: dict[str, Result] = field(default_factory=dict)
    whole: list[str] = field(default_factory=list)
    failure: MosegError | None = None

    @classmethod
    def of(cls, hierarchy: Hierarchy, options: SearchOptions, listener: Listener) -> _Descent:
        """A run that has not begun."""
        seconds = options.max_seconds
        return cls(
            options=options,
            listener=listener,
            deadline=None if seconds is None else time.monotonic() + seconds,
            left=sum(1 for _ in hierarchy.levels()),
        )

    def search(self, shape: Shape, level: Hierarchy, path: str, **more: Any) -> Result:
        """Segment one level, in its share of the time that is left."""
        mine = _for_level(self.options, path, level.problem.registry)
        if self.deadline is not None:
            left = max(0.0, self.deadline - time.monotonic()) / max(1, self.left)
            mine = replace(mine, max_seconds=left)
        self.left -= 1
        try:
            return solve(
                shape,
                level.problem,
                mine,
                defaults=level.search,
                report=_located(self.listener, path),
                **more,
            )
        except MosegError as error:
            if error.result is None:
                raise
            self.failure = error
            found: Result = error.result
            return found

    def merged(self, result: Result, hierarchy: Hierarchy) -> Result:
        """The result of the first level with those of all parts put in its place.

        Raises
        ------
        MosegError
            It had ended the run; it carries the merged result.
        """
        found = self._merged(result, hierarchy)
        if self.failure is not None:
            self.failure.result = replace(found, reason="failed")
            raise self.failure
        return found

    def _merged(self, result: Result, hierarchy: Hierarchy) -> Result:
        tree = self.descend(result, hierarchy, "")
        warnings = [
            f"{path}: {warning}" if path else warning
            for path, level in self.found.items()
            for warning in level.warnings
        ] + self.whole
        if len(self.found) == 1:
            return replace(result, warnings=tuple(warnings))
        levels = self.found
        return Result(
            shape=result.shape,
            problem=tree.hierarchy,
            labels=tree.leaves.astype(np.int32),
            evaluation=combined({path: level.evaluation for path, level in levels.items()}),
            centers=tree.centers,
            history=dict(_prefixed(levels, lambda level: level.history)),
            method=dict(_prefixed(levels, lambda level: level.method)),
            seed=result.seed,
            versions=dict(sorted(pair for r in levels.values() for pair in r.versions.items())),
            reason=joint_reason([level.reason for level in levels.values()]),
            dimension=(
                sum(level.dimension[0] for level in levels.values()),
                sum(level.dimension[1] for level in levels.values()),
            ),
            warnings=tuple(warnings),
            levels=dict(levels),
        )

    def descend(self, result: Result, level: Hierarchy, path: str) -> _Tree:
        """Segment the parts of a level that was segmented, and theirs."""
        self.found[path] = result
        labels = level.problem.labels
        parts: dict[str, _Tree] = {}
        members = [np.flatnonzero(result.labels == k) for k in range(len(labels))]
        for label, child in level.children.items():
            elements = members[labels.index(label)]
            inner = joined(path, label)
            later = self.left - sum(1 for _ in child.levels())
            try:
                part = self.part(result, elements, label, child)
                divided = self.search(part, child, inner)
            except MosegError as error:
                if not isinstance(error, (ShapeError, UsageError)):
                    self.failure = error
                self.left = later
                self.whole.append(f"part '{inner}' is left whole: {error}")
                continue
            parts[label] = self.descend(divided, child, inner)
        return _Tree.of(result, level, parts, members)

    def part(self, result: Result, elements: IntArray, label: str, child: Hierarchy) -> Shape:
        """A part as a shape that its problem can be solved on, or an error that says why not."""
        if self.failure is not None:
            raise UsageError("the run failed before its turn")
        if self.listener.stopped:
            raise UsageError("the run was interrupted before its turn")
        if label in result.evaluation.empty:
            raise ShapeError("it is empty")
        if len(elements) < len(child.problem.labels):
            raise ShapeError(
                f"it has {len(elements)} {result.shape.geometry.noun}s, too few for"
                f" {len(child.problem.labels)} labels"
            )
        part = subshape(result.shape, elements, name=joined(result.shape.name, label))
        child.problem.check(child.problem.embed(part))
        return part


@dataclass(frozen=True, eq=False, kw_only=True)
class _Tree:
    """A level with all that is below it: the labels of its elements, and centres by leaf.

    Parameters
    ----------
    hierarchy : Hierarchy
        Without the parts that were left whole.
    leaves : (k,) int
        Index into the hierarchy's labels for every element of the level's shape.
    centers : Centers
        Of the leaves, in their order.
    """

    hierarchy: Hierarchy
    leaves: IntArray
    centers: Centers

    @classmethod
    def of(
        cls,
        result: Result,
        level: Hierarchy,
        parts: Mapping[str, _Tree],
        members: Sequence[IntArray],
    ) -> _Tree:
        """A level's result with those of its divided parts."""
        leaves = np.empty(result.shape.n_elements, np.int64)
        found: list[Centers] = []
        first = 0
        for k, label in enumerate(level.problem.labels):
            if label in parts:
                part = parts[label]
                leaves[members[k]] = first + part.leaves
                found.append(part.centers)
                first += len(part.hierarchy.labels)
            else:
                leaves[members[k]] = first
                found.append(result.centers.of(k))
                first += 1
        kept = {label: part.hierarchy for label, part in parts.items()}
        return cls(
            hierarchy=replace(level, parts=kept),
            leaves=leaves,
            centers=Centers.joined(found),
        )


def _prefixed(
    levels: Mapping[str, Result], of: Callable[[Result], Mapping[str, Any]]
) -> Iterator[tuple[str, Any]]:
    """What is kept by name on every level, the names with the path in front."""
    for path, level in levels.items():
        for name, value in of(level).items():
            yield (f"{path}: {name}" if path else name), value


def joint_reason(reasons: Sequence[str]) -> str:
    """Why the whole run ended: what cut it short before what any level met."""
    for short in ("failed", "interrupted", "seconds"):
        if short in reasons:
            return short
    return next((reason for reason in reasons if reason != "converged"), "converged")


def _located(report: Report, path: str) -> Report:
    """Reports that tell which level they are about."""

    def report_with_path(progress: Progress) -> bool:
        if path:
            progress = replace(progress, stage=f"{path}: {progress.stage}")
        return report(progress)

    return report_with_path
