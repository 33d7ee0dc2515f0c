"""The data of a page as plain data: what ``tools/viewer`` reads.

Everything that is said in words or numbers is made here, what is drawn is packed by
:mod:`moseg_core.view.page.packing`; the page itself only arranges it. What a part costs is the sum
of the terms that look at it alone, and its share of those that look at several; a term of the whole
shape belongs to no part.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from moseg_core.problem.aggregate import Evaluation
from moseg_core.search.incumbents import Incumbent
from moseg_core.types import IntArray
from moseg_core.view.camera import standing_axes
from moseg_core.view.legend import one_line
from moseg_core.view.page.content import PageContent
from moseg_core.view.page.packing import MOST_POINTS, MOST_TRIANGLES, Packed, packed
from moseg_core.view.page.steps import SearchSteps, Step, packed_changes
from moseg_core.view.palette import part_colors
from moseg_core.view.upright import standing_of

FORMAT = "moseg-page/1"
"""What the data say they are."""

#: What elements without a label are shown as.
UNLABELLED_NAME, _UNLABELLED_COLOR = "unlabelled", "#aab2bf"

#: Points or triangles that the first view is chosen by: more change nothing that is seen.
_LOOKED_AT = 100_000


def page_document(
    content: PageContent,
    *,
    most_triangles: int = MOST_TRIANGLES,
    most_points: int = MOST_POINTS,
) -> dict[str, Any]:
    """The data of a page.

    Parameters
    ----------
    content : PageContent
    most_triangles, most_points : int
        How many are drawn; the page says where those are fewer than there are.

    Returns
    -------
    dict
        Numbers, texts, lists and dicts; a function of the content alone.
    """
    shape, labels = content.shape, content.labels
    parts = _parts(content)
    surface, drawn_labels, elements = shape.geometry, labels, None
    if content.clipped is not None:
        surface, elements = content.clipped.mesh, content.clipped.source
        drawn_labels = content.clipped.labels.astype(np.int64)
    shown = packed(
        surface,
        np.where(drawn_labels < 0, len(content.names), drawn_labels),
        elements=elements,
        most_triangles=most_triangles,
        most_points=most_points,
    )
    stride = -(-len(shown.corners) // _LOOKED_AT)
    corners = shown.corners[::stride]
    standing = standing_of(corners, shape.up)
    right, up, front = standing_axes(corners, standing.up).tolist()
    noun = "triangle" if len(surface.triangles) else "point"
    notes = [one_line(warning) for warning in content.warnings]
    if shown.drawn < shown.known:
        notes.append(
            f"The page draws {shown.drawn:,} of {shown.known:,} {noun}s, so that it turns smoothly;"
            f" areas and costs are those of all."
        )
        unseen = set(np.unique(labels[labels >= 0]).tolist()) - set(shown.labels.tolist())
        if unseen:
            names = ", ".join(one_line(content.names[k])[:40] for k in sorted(unseen))
            notes.append(f"Too small to be seen among them: {names}.")
    evaluation = content.evaluation
    return {
        "format": FORMAT,
        "name": one_line(shape.name),
        "noun": shape.noun,
        "elements": shape.n_elements,
        "measure": "volume" if shape.solid else "area",
        "total": float(shape.areas.sum()),
        "cost": None if evaluation is None else evaluation.cost.value,
        "notes": notes,
        "parts": parts,
        "order": _worst_first(parts),
        "terms": [] if evaluation is None else _terms(evaluation),
        "steerable": content.centers is not None,
        "view": {"right": right, "up": up, "front": front, "said": standing.said},
        "geometry": shown.document,
        **({} if content.search is None else {"steps": _steps(content.search, shown)}),
    }


def _steps(search: SearchSteps, shown: Packed) -> list[dict[str, Any]]:
    """From the start to the result, whose labels are those of the geometry."""
    end = {"centers": [], "changes": "", "refined": search.refined}
    return [
        {
            **_step(step),
            "centers": [
                {"part": part, "at": place}
                for part, place in zip(step.parts.tolist(), step.places.tolist(), strict=True)
            ],
            "changes": changes,
        }
        for step, changes in packed_changes(search.before, shown.elements, shown.labels)
    ] + [{**_step(search.last), **end}]


def _step(step: Step | Incumbent) -> dict[str, Any]:
    return {
        "stage": step.stage,
        "evaluations": step.evaluations,
        "cost": step.cost.value,
        "empty": step.cost.empty,
    }


def _parts(content: PageContent) -> list[dict[str, Any]]:
    """For each label, and for what has none, how large it is and what it costs."""
    shape, names = content.shape, content.names
    kinds: IntArray = np.where(content.labels < 0, len(names), content.labels)
    areas = np.bincount(kinds, shape.areas, len(names) + 1)
    counts = np.bincount(kinds, minlength=len(names) + 1)
    colors = ["#" + color.tobytes().hex() for color in part_colors(len(names))]
    costs = {} if content.evaluation is None else _costs(content.evaluation)
    details = {} if content.evaluation is None else content.evaluation.disagreements
    total = float(areas.sum())
    parts = []
    for k, (name, color) in enumerate(
        zip([*names, UNLABELLED_NAME], [*colors, _UNLABELLED_COLOR], strict=True)
    ):
        labelled = k < len(names)
        if not labelled and counts[k] == 0:
            continue
        terms = costs.get(name, []) if labelled else []
        detail = details.get((name,)) if labelled else None
        center = None if content.centers is None or not labelled else content.centers[k]
        parts.append(
            {
                "name": name,
                "color": color,
                "elements": int(counts[k]),
                "area": float(areas[k]),
                "share": float(areas[k]) / total if total > 0.0 else 0.0,
                "cost": _own(terms) if terms else None,
                "terms": sorted(terms, key=lambda term: -(term["cost"] or 0.0)),
                "detail": None if detail is None else str(detail),
                "center": None if center is None or not np.isfinite(center).all() else [*center],
                "unlabelled": not labelled,
            }
        )
    return parts


def _costs(evaluation: Evaluation) -> dict[str, list[dict[str, Any]]]:
    """For each label the terms that look at its part."""
    found: dict[str, list[dict[str, Any]]] = {}
    for term in evaluation.terms:
        for call in term.calls:
            for label in dict.fromkeys(call.labels):
                found.setdefault(label, []).append(
                    {
                        "name": _short(term.text),
                        "others": [other for other in call.labels if other != label],
                        "value": call.value,
                        "cost": None if call.value is None else term.weight * call.value,
                    }
                )
    return found


def _own(terms: list[dict[str, Any]]) -> float:
    """What a part costs: of a term about several parts an equal share."""
    return float(sum((term["cost"] or 0.0) / (1 + len(term["others"])) for term in terms))


def _worst_first(parts: list[dict[str, Any]]) -> list[int]:
    """The parts by what they cost, where that is known, then by size; those without a part last."""

    def rank(k: int) -> tuple[bool, bool, float, float]:
        part = parts[k]
        cost = part["cost"]
        return part["unlabelled"], part["elements"] == 0, -(cost or 0.0), -part["area"]

    return sorted(range(len(parts)), key=rank)


def _terms(evaluation: Evaluation) -> list[dict[str, Any]]:
    """What each term adds to the cost, most first."""
    terms = [
        {"text": term.text, "weight": term.weight, "value": term.value, "cost": term.weighted}
        for term in evaluation.terms
    ]
    return sorted(terms, key=lambda term: -float(str(term["cost"])))


def _short(text: str) -> str:
    """The objective of a term, and where it is evaluated.

    Examples
    --------
    >>> _short("narrow(leg*) @ mds"), _short("convex_parts")
    ('narrow @ mds', 'convex_parts')
    """
    name, parenthesis, rest = text.partition("(")
    return name + rest.rpartition(")")[2] if parenthesis else name
