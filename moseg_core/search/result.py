"""What a run returns: the labels, what they cost term by term, and how they were found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import Evaluation
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.incumbents import Incumbent
from moseg_core.search.named import Named
from moseg_core.search.part_measures import measure_parts
from moseg_core.search.part_table import PartTable
from moseg_core.search.showing import framed, open_page
from moseg_core.shape.shape import Shape
from moseg_core.types import Int32Array, IntArray, frozen

if TYPE_CHECKING:
    from moseg_core.clipping.clip import Clipped
    from moseg_core.shape.geometry import Geometry

REFINE = "refine"
"""The stage of the history in which a refiner moves boundaries."""

#: Below this share of the area a part is worth a warning.
_SLIVER = 0.005


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """A labelled segmentation.

    Parameters
    ----------
    shape : Shape
        As the user gave it.
    problem : Problem or Hierarchy
        A hierarchy where parts were segmented in their turn; its labels are then paths.
    labels : (F,) int32
        Index into ``problem.labels`` for every input face, in file order.
    evaluation : Evaluation
        Cost by term and part, of these labels.
    centers : Centers
        One centre per label, or as many as the parameterization has, in units of
        :attr:`partitioned`: of the partition that the search has found, also where boundaries were
        moved afterwards (:attr:`refined`). Those of a hierarchy's leaves belong to different
        partitions, each to that of its own level: its weight compares with those of its siblings
        only.
    dimension : (int, int)
        How many numbers the search had to find, and how many describe the segmentation; they
        differ where constraints give some from others.
    history : mapping of str to tuple of dict
        For each stage a record per round or iteration.
    incumbents : tuple of Incumbent
        How the search came to its result: the best candidate at some moments, from the start of
        the search that won to the end. Empty where it is not known, and of a hierarchy: its levels
        have theirs.
    method : mapping of str to str
        Parameterization, seeder, labeler, optimizer and refiner as chosen, and the settings.
    seed : int
    versions : mapping of str to str
        For the id of every component used the distribution that it came from.
    reason : str
        Why the search ended: "converged", the limit that it met, "interrupted" or "failed".
    warnings : tuple of str
    clipped : Clipped or None
        The surface with its boundaries cut below mesh resolution
        (:func:`moseg_core.search.clipped_result.clip`).
    levels : mapping of str to Result
        For a hierarchy the result of each level by its path, "" for the whole; else empty.
    """

    shape: Shape
    problem: Problem | Hierarchy
    labels: Int32Array
    evaluation: Evaluation
    centers: Centers
    history: Mapping[str, tuple[dict[str, float], ...]]
    method: Mapping[str, str]
    seed: int
    versions: Mapping[str, str]
    reason: str
    dimension: tuple[int, int] = (0, 0)
    incumbents: tuple[Incumbent, ...] = ()
    warnings: tuple[str, ...] = ()
    clipped: Clipped | None = None
    levels: Mapping[str, Result] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for array in (self.labels, self.centers.positions, self.centers.weights):
            frozen(array)
        if self.centers.parts is not None:
            frozen(self.centers.parts)
        object.__setattr__(self, "levels", Named(self.levels, kind="level"))

    def __repr__(self) -> str:
        names = ", ".join(self.problem.labels)
        return f"Result({self.shape.name}: {names}; cost {self.cost:.6g}, {self.reason})"

    def _page(self) -> bytes:
        """The page of the result, by what writes ``.html``: pictures stand above this room."""
        component = self.problem.registry.by_suffix("writer", ".html")
        write = component.load()
        with component.guard():
            page: bytes = write(self)
        return page

    def _repr_html_(self) -> str:
        """The page of the result in a frame: what a notebook shows of it."""
        return framed(self._page())

    def show(self) -> Path:
        """Open the page of the result in the browser.

        Returns
        -------
        Path
            The file that was written for it, in the system's folder for temporary files; a file
            to keep is made by ``moseg.save(result, "hammer.html")``.

        Raises
        ------
        MosegError
            The file cannot be written.

        Examples
        --------
        >>> result.show()  # doctest: +SKIP
        """
        return open_page(self._page())[0]

    @property
    def cost(self) -> float:
        """Value of the aggregate objective."""
        return self.evaluation.cost.value

    @property
    def refined(self) -> bool:
        """Whether a refiner has moved boundaries, so that they are not where the centres say."""
        return any(stage.rpartition(": ")[2] == REFINE for stage in self.history)

    @property
    def partitioned(self) -> Shape:
        """The shape that the partition is of: `shape`, or what the embedding made of it."""
        return self.problem.embed(self.shape)

    @property
    def surface(self) -> tuple[Geometry, Int32Array | IntArray]:
        """What to show: a geometry and a label for each element, clipped where it was."""
        if self.clipped is None:
            return self.shape.geometry, self.labels
        return self.clipped.mesh, self.clipped.labels

    @cached_property
    def segmentation(self) -> Segmentation:
        """The labelled shape."""
        return Segmentation.from_labels(
            self.shape,
            self.labels,
            len(self.problem.labels),
            lookup=Lookup(self.problem.registry),
        )

    @cached_property
    def parts(self) -> Mapping[str, Part]:
        """Each part by its label: ``result.parts["handle"].to_mesh()``."""
        parts = zip(self.problem.labels, self.segmentation.parts, strict=True)
        return Named(dict(parts), kind="part")

    def table(self) -> PartTable:
        """Measures of all parts, in the shape's units: a row for each part.

        Returns
        -------
        PartTable
            ``pandas.DataFrame(result.table().rows)``, ``result.table().to_csv()``. The columns are
            explained in ``docs/measuring.md``.

        Raises
        ------
        PluginError
            A measure of a bundle fails.
        """
        return measure_parts(
            self.segmentation,
            self.problem.labels,
            source=self.problem.registry,
            evaluation=self.evaluation,
            centers=self.centers,
        )


def end_warnings(reason: str) -> tuple[str, ...]:
    """What a user should know of a search that did not end by itself."""
    if reason == "converged":
        return ()
    if reason == "interrupted":
        return ("the run was interrupted; this is the best that it had found",)
    if reason == "failed":
        return ("the run failed; this is the best that it had found",)
    return (f"the search ended on its limit ({reason}); a longer one may find better",)


def find_warnings(
    evaluation: Evaluation, segmentation: Segmentation, labels: tuple[str, ...], reason: str
) -> tuple[str, ...]:
    """What a user should know before trusting a result."""
    found = list(end_warnings(reason))
    found += [
        f"part '{name}' is empty; terms about it are left out of the cost"
        for name in evaluation.empty
    ]
    if evaluation.broken_pins:
        found.append(f"{evaluation.broken_pins} pinned elements bear another label than theirs")
    for term in evaluation.terms:
        for call in term.at_worst:
            about = f" for {', '.join(call.labels)}" if call.labels else ""
            found.append(f"{term.objective} is at its worst value, {call.value:g}{about}")
    for name, part in zip(labels, segmentation.parts, strict=True):
        if name not in evaluation.empty and part.area < _SLIVER * part.shape.area:
            share = 100 * part.area / part.shape.area
            found.append(f"part '{name}' has only {share:.2g} % of the area")
        if part.n_elements and part.n_components > 1:
            found.append(f"part '{name}' is in {part.n_components} pieces")
    return tuple(found)
