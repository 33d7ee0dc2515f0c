"""The page of a batch as HTML: what failed, then a card for each result, outliers first.

It holds no script and loads nothing but the pictures beside it, ``report/*.png``: so it opens at
once for thousands of shapes, and travels with the folder of the batch.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from string import Template
from urllib.parse import quote

from moseg_core.batching.outcome import BatchResult, Outcome
from moseg_core.batching.report.describing import Description
from moseg_core.batching.report.outliers import FEWEST, MOST, Deviation, Likeness, compare_shapes
from moseg_core.components.discovery.contract import VERSION
from moseg_core.search.part_table import shown
from moseg_core.view.palette import part_colors

#: Lengths that are shown as a share of the diagonal.
_OF_DIAGONAL = ("length", "width", "height", "thickness", "boundary")
#: Characters of a message that the page shows.
_LONGEST = 300


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """A shape with a result, as the page shows it.

    Parameters
    ----------
    outcome : Outcome
    picture : str or None
        Path as seen from the page; None where it could not be drawn.
    likeness : Likeness or None
        None where it could not be measured, or there are too few shapes.
    """

    outcome: Outcome
    picture: str | None
    likeness: Likeness | None


def batch_page(
    result: BatchResult,
    descriptions: Mapping[str, Description],
    pictures: Mapping[str, str],
) -> bytes:
    """Write the page.

    Parameters
    ----------
    result : BatchResult
    descriptions : mapping of str to Description
        By the shapes' paths; those that could not be measured are left out.
    pictures : mapping of str to str
        Paths of the pictures as seen from the page, likewise.

    Returns
    -------
    bytes
        HTML, UTF-8; equal for equal arguments.
    """
    measured = list(descriptions)
    found = compare_shapes([descriptions[shape].rows for shape in measured])
    likeness = {} if found is None else dict(zip(measured, found, strict=True))
    specimens = [
        Specimen(outcome=outcome, picture=pictures.get(shape), likeness=likeness.get(shape))
        for shape, outcome in result.outcomes.items()
        if outcome.ok
    ]
    specimens.sort(key=_rank)
    counts = ", ".join(f"{count} {kind}" for kind, count in result.counts.items())
    left = result.total - len(result.outcomes)
    order = (
        "Those that are most unlike the others come first: the root mean square of how much cost"
        " and measures of the parts deviate from their medians, in usual deviations, each counted"
        f" {MOST:g} at most."
        if likeness
        else f"Those of the highest cost come first; with {FEWEST} shapes or more it would be those"
        f" that are most unlike the others."
    )
    page = Template(files(__package__).joinpath("page.html").read_text(encoding="utf-8"))
    return page.substitute(
        title=_text(f"Batch {result.folder.absolute().name}"),
        facts=_text(f"{result.total} shapes: {counts}" + (f", {left} left" if left else "")),
        legend=_legend(descriptions.values()),
        failures=_failures(result.failed),
        heading="Results",
        order=_text(order),
        cards="\n".join(map(_card, specimens)),
        footer=_text(f"Made by moseg {VERSION}."),
    ).encode()


def _rank(specimen: Specimen) -> tuple[float, float]:
    score = -1.0 if specimen.likeness is None else specimen.likeness.score
    cost = 0.0 if specimen.outcome.cost is None else specimen.outcome.cost
    return -score, -cost


def _legend(descriptions: Iterable[Description]) -> str:
    """Which colour is which part, where that is the same for all."""
    names = {tuple(str(row["part"]) for row in each.rows) for each in descriptions}
    if len(names) != 1:
        return ""
    (parts,) = names
    items = "".join(
        f'<li><i style="background: rgb({r}, {g}, {b})"></i><bdi>{_text(name)}</bdi></li>'
        for name, (r, g, b) in zip(parts, part_colors(len(parts)).tolist(), strict=True)
    )
    return f'<ul class="legend">{items}</ul>'


def _failures(failed: Sequence[Outcome]) -> str:
    if not failed:
        return ""
    rows = "".join(
        f"<tr><td><bdi>{_text(outcome.shape)}</bdi></td><td>{_text(outcome.kind)}</td>"
        f"<td>{_text(outcome.message)}</td></tr>"
        for outcome in failed
    )
    return (
        "<h2>Without a result</h2><div class='table'><table><thead><tr><th>shape</th>"
        f"<th>outcome</th><th>why</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )


def _card(specimen: Specimen) -> str:
    outcome = specimen.outcome
    name = _text(Path(outcome.shape).name)
    lines = []
    if specimen.picture is not None:
        lines.append(
            f'<img loading="lazy" src="{quote(specimen.picture)}" alt="{name} in its parts"'
            f' width="360" height="240">'
        )
    lines.append(f"<div><h3>{name}</h3>")
    cost = "" if outcome.cost is None else f"cost {shown(outcome.cost)}, "
    links = [f'<a href="{quote(file)}">{Path(file).suffix[1:]}</a>' for file in _linked(outcome)]
    lines.append(f'<p class="faint">{cost}{len(outcome.parts)} parts, {" ".join(links)}</p>')
    if specimen.likeness is not None:
        score = specimen.likeness.score
        lines.append(
            f'<meter min="0" max="{MOST:g}" value="{score:.3f}" title="unlike the others">'
            f"</meter><p>unlike the others: {score:.2f}</p>"
        )
        lines += [f"<p>{_words(deviation)}</p>" for deviation in specimen.likeness.deviations]
    lines += [f'<p class="warn">{_text(warning)}</p>' for warning in outcome.warnings]
    return f'<li class="card">{"".join(lines)}</div></li>'


def _linked(outcome: Outcome) -> list[str]:
    """Files of an outcome that its card links to: the result, and what can be looked at."""
    return [file for file in outcome.files if file.lower().endswith((".json", ".html", ".glb"))][:4]


def _words(deviation: Deviation) -> str:
    part = f"<bdi>{_text(deviation.part)}</bdi>: " if deviation.part else ""
    if deviation.measure == "present":
        return part + ("there, as on few others" if deviation.value else "not there")
    if deviation.measure in _OF_DIAGONAL:
        value, usual = (f"{100 * x:.3g} %" for x in (deviation.value, deviation.usual))
        return f"{part}{deviation.measure} {value} of the diagonal, usually {usual}"
    words = _text(deviation.measure.replace("_", " "))
    return f"{part}{words} {deviation.value:.3g}, usually {deviation.usual:.3g}"


def _text(text: str) -> str:
    """Text that is no markup, and no longer than anybody reads."""
    short = text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
    return html.escape(short.encode(errors="replace").decode())
