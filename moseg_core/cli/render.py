"""``moseg render``: a picture of a shape and of labels from anywhere."""

from __future__ import annotations

import re
from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.cli.flags import ShapeFlags
from moseg_core.cli.reading import limits_of, named_labels, read_label_property, read_shape
from moseg_core.cli.saving import check_distinct
from moseg_core.cli.waiting import waiting
from moseg_core.errors import UsageError
from moseg_core.io import read_labels, write_file
from moseg_core.io.whole_file import check_destination
from moseg_core.view.picture import checked_size, draw_parts
from moseg_core.view.point_bodies import drawable
from moseg_core.view.upright import find_standing
from moseg_core.view.views import read_views


def run_render(
    path: Path,
    result: Path,
    *,
    out: Path,
    views: str,
    size: str,
    transparent: bool,
    legend: bool,
    title: str | None,
    label_property: str | None,
    reading: ShapeFlags,
) -> None:
    """Check what can be checked, read, draw, and say which way was taken for up."""
    if out.suffix.lower() != ".png":
        asked = f"'{out.suffix}'" if out.suffix else "a file without a suffix"
        raise UsageError(f"a picture is written as .png, not {asked}")
    check_destination(out)
    check_distinct([out], read=[path, result], what="the picture")
    if path.suffix.lower() == ".json":
        raise UsageError(
            f"'{path}' has labels but no shape; give the shape first: moseg render SHAPE {path}"
            f" -o {out}"
        )
    chosen, pixels = read_views(views), read_size(size)
    shape = read_shape(path, reading)
    labelling = read_labels(
        result,
        shape,
        label_property=read_label_property(label_property),
        limits=limits_of(reading),
    )
    for note in labelling.notes:
        message(note)
    labels, names = named_labels(labelling)
    geometry = drawable(shape.geometry)
    standing = find_standing(geometry, shape.up)
    with waiting("drawing"):
        picture = draw_parts(
            geometry,
            labels,
            names,
            title=(shape.name if title is None else title) if legend else "",
            size=pixels,
            areas=None if shape.has_surface else shape.areas,
            standing=standing,
            views=chosen,
            transparent=transparent,
            legend=legend,
        )
    write_file(out, picture)
    if standing.guessed:
        message(f"{standing.said}; --up says otherwise")
    message(f"wrote {out}")


def read_size(text: str) -> tuple[int, int]:
    """Width and height in pixels from a text such as ``900x400``.

    Raises
    ------
    UsageError
        Another form, or a size that cannot be drawn.

    Examples
    --------
    >>> read_size("900x400")
    (900, 400)
    """
    match = re.fullmatch(r"(\d{1,6})\s*[xX*,]\s*(\d{1,6})", text.strip())
    if match is None:
        raise UsageError(f"--size '{text}' is not understood; write --size 900x400")
    return checked_size((int(match[1]), int(match[2])))
