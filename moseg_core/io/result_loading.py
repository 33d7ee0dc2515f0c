"""From a saved result back to a result: with its shape, which the file does not hold.

A ``.json`` says which shape it is of: the path from which that was read, as it was given then, its
name, and the fingerprint of its geometry. The shape is looked for at that path and, as files travel
together, by its name beside the result and in folders that the user names. Whatever is found counts
only if it has the fingerprint: labels laid onto another shape would be nonsense that looks like a
result.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from moseg_core.components.discovery.registry import Registry, registry
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.files import load
from moseg_core.io.result_json import SavedResult, read_result
from moseg_core.problem.full_names import meant_by_result, statement_in_full
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.alignment import Template
from moseg_core.search.part_measures import measure_parts
from moseg_core.search.part_table import PartTable
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape


def load_result(
    path: str | os.PathLike[str],
    shape: Shape | None = None,
    *,
    problem: Problem | Hierarchy | None = None,
    source: Registry | None = None,
) -> Result:
    """Read a saved result, ``.json``, as the result that it was.

    Parameters
    ----------
    path : path-like
    shape : Shape, optional
        The shape that was segmented, read as it was then; by default it is looked for
        (:func:`find_shape`) and read without options.
    problem : Problem or Hierarchy, optional
        The problem, where it has objectives or constraints of your own, which no file can hold; by
        default that of the file, its names looked up among what is installed.
    source : Registry, optional
        Where to look for readers and components.

    Returns
    -------
    Result
        Cost and terms are those of the file, not evaluated anew. Saved again it gives the same
        bytes, but for the path of the shape where it was found elsewhere. What the file does not
        hold is not there: clipped boundaries, the results of single levels.

    Raises
    ------
    UsageError
        The file is no result; or its problem names what is not installed, or is another than
        `problem`.
    ShapeError
        The shape is not found, or is another.

    Examples
    --------
    >>> result = moseg.load_result("hammer.json")  # doctest: +SKIP
    >>> result.table().to_csv()  # doctest: +SKIP
    """
    path = Path(path)
    saved = read_result(path)
    if shape is None:
        shape = find_shape(saved, path, source=source)
    check_shape(saved, path, shape)
    if problem is None:
        problem = _stated(saved, registry() if source is None else source)
    if problem.labels != saved.names:
        raise UsageError(
            f"'{path}' has the labels {', '.join(saved.names)}, the problem that is given"
            f" {', '.join(problem.labels)}"
        )
    return Result(
        shape=shape,
        problem=problem,
        labels=saved.labels.astype(np.int32),
        evaluation=saved.evaluation,
        centers=saved.centers,
        history={
            stage: tuple(
                # What is no finite number has no word in JSON.
                {key: np.nan if value is None else value for key, value in record.items()}
                for record in records
            )
            for stage, records in saved.history.items()
        },
        method=saved.method,
        seed=saved.seed,
        versions=saved.versions,
        reason=saved.reason,
        dimension=saved.dimension,
        incumbents=saved.incumbents,
        warnings=saved.warnings,
    )


def measure_saved(saved: SavedResult, shape: Shape) -> PartTable:
    """The parts of a saved result; its problem is not looked at, nor what that needs.

    Parameters
    ----------
    saved : SavedResult
    shape : Shape
        Its shape (:func:`check_shape`).

    Raises
    ------
    PluginError
        A measure of a bundle fails.
    """
    return measure_parts(
        Segmentation.from_labels(shape, saved.labels, len(saved.names)),
        saved.names,
        source=registry(),
        evaluation=saved.evaluation,
        centers=saved.centers,
    )


def load_template(path: Path) -> Template:
    """What a saved result of one level says of other shapes, for searches that start from it.

    Raises
    ------
    UsageError
        It is no result; it is of several levels; or its problem names what is not installed.
    ShapeError
        Its shape is not found.
    """
    shape = find_shape(read_result(path), path, remedy=f"put it beside '{path.name}'")
    return Template.of(load_result(path, shape))


def _stated(saved: SavedResult, source: Registry) -> Problem | Hierarchy:
    """The problem that a result states, with the names that it meant."""
    meaning = meant_by_result(saved.versions, source)
    try:
        task = Hierarchy.of(statement_in_full(saved.statement, meaning), registry=source)
    except UsageError as error:
        raise UsageError(
            f"{error} (of objectives of your own give the problem: load_result(path, problem=...))"
        ) from error
    return task if task.children else task.problem


def find_shape(
    saved: SavedResult,
    path: Path,
    *,
    folders: Sequence[Path] = (),
    read: Callable[[Path], Shape] | None = None,
    source: Registry | None = None,
    remedy: str = "say where it is: --shapes FOLDER, or load_result(path, shape=...)",
) -> Shape:
    """The shape of a saved result: at the path that it says, beside it, or in certain folders.

    Parameters
    ----------
    saved : SavedResult
    path : Path
        Of the result.
    folders : sequence of Path
        Where else to look for a file of its name.
    read : callable, optional
        What reads a file; :func:`moseg_core.load` by default.
    source : Registry, optional
        Where to look for readers.
    remedy : str
        What to do where it is not found, for the message.

    Returns
    -------
    Shape
        With the fingerprint that the result says.

    Raises
    ------
    ShapeError
        There is no such file, or only of other shapes.
    """
    others = []
    for file in _candidates(saved, path, folders, registry() if source is None else source):
        try:
            shape = load(file, source=source) if read is None else read(file)
        except (ShapeError, UsageError) as error:
            others.append(str(error))
            continue
        try:
            return _as_it_was(saved, path, shape)
        except ShapeError:
            others.append(f"'{file}' is another, or was read with other options")
    where = f": {'; '.join(others[:3])}" if others else ""
    raise ShapeError(
        f"the shape of '{path}', '{_file_name(saved)}' of {saved.shape['elements']} elements, is"
        f" not found{where}; {remedy}"
    )


def check_shape(saved: SavedResult, path: Path, shape: Shape) -> None:
    """Refuse a shape that a result is not of.

    Raises
    ------
    ShapeError
        Its geometry is not the one that was segmented.
    """
    if shape.fingerprint != saved.shape["fingerprint"]:
        raise ShapeError(
            f"'{path}' is a result on '{_file_name(saved)}' of {saved.shape['elements']} elements,"
            f" and '{shape.name}' of {shape.n_elements} has another geometry; give the shape that"
            f" was segmented, read with the same options (--voxels, --pitch)"
        )


def _as_it_was(saved: SavedResult, path: Path, shape: Shape) -> Shape:
    """The shape, of a voxel grid the surface where that was segmented."""
    if shape.solid and shape.n_elements != saved.shape["elements"]:
        shape = shape.with_elements("surface")
    check_shape(saved, path, shape)
    return shape


def _file_name(saved: SavedResult) -> str:
    """What the shape's file is called; older results know its name without the suffix."""
    # As on either system: a result may come from another.
    return str(saved.shape.get("file") or saved.shape["name"]).replace("\\", "/").split("/")[-1]


def _candidates(
    saved: SavedResult, path: Path, folders: Sequence[Path], source: Registry
) -> Iterator[Path]:
    """Files that may hold the shape of a result, the likeliest first, each once."""
    recorded, name = saved.shape.get("file"), _file_name(saved)
    likely = [Path(recorded), path.parent / recorded] if recorded else []
    for folder in (path.parent, *folders):
        likely.append(folder / name)
        wanted = {saved.shape["name"].lower() + suffix for suffix in source.suffixes("reader")}
        likely += sorted(file for file in _entries(folder) if file.name.lower() in wanted)
    seen = set()
    for file in likely:
        # Of a name that no file can have Path.is_file would raise.
        if os.path.isfile(file) and (real := file.resolve()) not in seen:
            seen.add(real)
            yield file


def _entries(folder: Path) -> list[Path]:
    """What is in a folder; nothing where that may not be looked at."""
    try:
        return list(folder.iterdir())
    except OSError:
        return []
