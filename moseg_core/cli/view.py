"""``moseg view``: a labelled shape as a page to turn it in, from whatever bears its labels."""

from __future__ import annotations

import os
from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.cli.flags import ShapeFlags
from moseg_core.cli.reading import limits_of, named_labels, read_label_property, read_shape
from moseg_core.errors import ShapeError, UsageError
from moseg_core.io import read_labels, read_result, write_file
from moseg_core.io.files import instead_of
from moseg_core.io.labels.reading import bearing_suffixes
from moseg_core.io.result_json import is_result
from moseg_core.io.result_loading import find_shape, load_result
from moseg_core.io.whole_file import check_destination
from moseg_core.search.showing import open_page
from moseg_core.shape.shape import Shape
from moseg_core.view.page.content import PageContent, middle_places
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html
from moseg_core.view.page.steps import SearchSteps, search_steps


def run_view(
    source: Path,
    labels: Path | None,
    *,
    label_property: str | None,
    reading: ShapeFlags,
    out: Path | None,
    browser: bool,
) -> None:
    """Read shape and labels, and write the page, or open it."""
    if out is not None:
        if out.suffix.lower() != ".html":
            asked = f"'{out.suffix}'" if out.suffix else "a file without a suffix"
            raise UsageError(f"a page is written as .html, not {asked}")
        check_destination(out)
    for path in (source, labels):
        if path is not None and not os.path.exists(path):
            raise UsageError(f"'{path}' does not exist{instead_of(path)}")
    if labels is None and source.suffix.lower() == ".json":
        shape, labels = _shape_of(source, reading), source
    else:
        shape = read_shape(source, reading)
        labels = _bearing(source) if labels is None else labels
    for note in shape.notes:
        message(f"{shape.name}: {note}")
    page = page_html(page_document(_content(shape, labels, label_property, reading)))
    if out is not None:
        write_file(out, page)
        message(f"wrote {out}")
        return
    path, opened = open_page(page, browser=browser)
    message(f"wrote {path}" + ("" if opened or not browser else "; open it in a browser"))


def _content(
    shape: Shape, path: Path, label_property: str | None, reading: ShapeFlags
) -> PageContent:
    """What there is to show of the labels in a file: of a result its cost as well."""
    asked = read_label_property(label_property)
    labelling = read_labels(path, shape, label_property=asked, limits=limits_of(reading))
    for note in labelling.notes:
        message(note)
    labels, names = named_labels(labelling, before="label ")
    saved = read_result(path) if is_result(path) else None
    if saved is not None and saved.shape.get("fingerprint") != shape.fingerprint:
        message(f"warning: {path} is a result of another shape, '{saved.shape.get('name')}'")
    return PageContent(
        shape=shape,
        labels=labels,
        names=names,
        search=None if saved is None else _search(path, shape),
        evaluation=None if saved is None else saved.evaluation,
        warnings=() if saved is None else saved.warnings,
        centers=None
        if saved is not None and saved.statement.parts
        else middle_places(shape, labels, len(names)),
    )


def _search(path: Path, shape: Shape) -> SearchSteps | None:
    """How the search went whose result a file is, where that is known."""
    try:
        return search_steps(load_result(path, shape))
    except (UsageError, ShapeError):  # objectives that are not installed, or another shape
        return None


def _bearing(source: Path) -> Path:
    """A shape given alone, which is to bear its labels.

    Raises
    ------
    UsageError
        No such file does.
    """
    if not source.name.lower().endswith(bearing_suffixes()):
        raise UsageError(
            f"'{source}' is a shape and bears no labels; name what does after it:"
            f" moseg view {source} RESULT"
        )
    return source


def _shape_of(result: Path, reading: ShapeFlags) -> Shape:
    """The shape of a result, where that says it is or beside it.

    Raises
    ------
    ShapeError
        There is none.
    """
    tried: list[Path] = []

    def read(file: Path) -> Shape:
        tried.append(file)
        return read_shape(file, reading)

    remedy = f"name it first: moseg view SHAPE {result}"
    shape = find_shape(read_result(result), result, read=read, remedy=remedy)
    message(f"'{result.name}' is a result of '{tried[-1]}'")
    return shape
