"""Draw what the words of ``moseg_objectives_basic`` mean: a part of low and one of high value.

Run it from anywhere::

    python tools/word_pictures.py                      # writes docs/images/words/NAME.png
    python tools/word_pictures.py --output elsewhere thin remote

For a word about one part, all parts of the sample shapes, as people labelled them, are measured,
and those of the least and the greatest value are shown. For the others :data:`SHOWN` says what.
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

import moseg_core as moseg

DESTINATION = Path(__file__).resolve().parent.parent / "docs" / "images" / "words"
SIZE = (480, 300)
COLOURS = 48
SAMPLES = ("hammer", "horse", "dove", "octopus", "bulldog")

#: Words about one part.
UNARY = (
    *("thin", "thick", "even_thickness", "central", "remote", "small", "large"),
    *("short_boundary", "creased_boundary", "separate"),
)

#: Of other words a call of low and one of high value: sample, labelling, expression.
SHOWN = {
    "is": [
        ("horse", "truth", f"is({x}, area=0.09+-0.03, thickness=0.07+-0.02)")
        for x in ("leg1", "body")
    ],
    "touching": [("horse", "truth", f"touching({x}, head)") for x in ("body", "leg3")],
    "apart": [("horse", "truth", f"apart({x})") for x in ("leg1, leg2", "head, body")],
    "above": [("horse", "truth", f'above({x}, up="y")') for x in ("head, leg1", "leg1, head")],
    "short_boundaries": [("hammer", x, "short_boundaries") for x in ("truth", "stripes")],
    "creased_boundaries": [("hammer", x, "creased_boundaries") for x in ("truth", "halves")],
    "separate_parts": [("hammer", x, "separate_parts") for x in ("truth", "halves")],
    "even_parts": [("octopus", x, "even_parts") for x in ("truth", "halves")],
}


class Shown(NamedTuple):
    """One half of a picture: a labelled sample, which labels are meant, what it comes to."""

    sample: str
    labelling: str
    meant: tuple[str, ...]
    value: float


@cache
def shape_of(sample: str) -> moseg.Shape:
    """A sample shape."""
    return moseg.load(moseg.sample_path(sample))


def labels_of(sample: str, labelling: str) -> moseg.Labelling:
    """The labelling that people gave a sample, or one that means nothing."""
    shape = shape_of(sample)
    truth = moseg.read_labels(moseg.sample_labels_path(sample), shape.n_elements)
    if labelling == "truth":
        return truth
    along = shape.unit_points[:, int(np.ptp(shape.unit_points, axis=0).argmax())]
    count = {"halves": 2, "stripes": 12}[labelling]
    order = np.argsort(np.argsort(along)) * count // shape.n_elements
    return moseg.Labelling(names=("one", "other"), labels=order % 2)


def value_of(sample: str, labelling: str, expression: str) -> float:
    """The value of an expression on a labelled sample."""
    found = labels_of(sample, labelling)
    return (
        moseg.Problem(found.names, expression).evaluate(shape_of(sample), found.labels).cost.value
    )


def low_and_high(word: str) -> list[Shown]:
    """What to show of a word."""
    if word in SHOWN:
        return [
            Shown(sample, labelling, _meant(expression), value_of(sample, labelling, expression))
            for sample, labelling, expression in SHOWN[word]
        ]
    all_parts = sorted(_all_parts(word), key=lambda shown: shown.value)
    return [all_parts[0], all_parts[-1]]


def _meant(expression: str) -> tuple[str, ...]:
    inside = expression.partition("(")[2].rstrip(")").split(", ")
    return tuple(word for word in inside if word and "=" not in word)


def _all_parts(word: str) -> Iterator[Shown]:
    for sample in SAMPLES:
        for name in labels_of(sample, "truth").names:
            yield Shown(sample, "truth", (name,), value_of(sample, "truth", f"{word}({name})"))


def picture(word: str) -> Image.Image:
    """The two halves beside each other."""
    whole = Image.new("RGB", (2 * SIZE[0], SIZE[1]))
    for k, shown in enumerate(low_and_high(word)):
        found = labels_of(shown.sample, shown.labelling)
        labels, names = np.asarray(found.labels), list(found.names)
        if shown.meant:
            kept = [names.index(name) for name in shown.meant]
            labels = np.select([labels == place for place in kept], range(len(kept)), len(kept))
            names = [*shown.meant, "others"]
        drawn = moseg.render_picture(
            shape_of(shown.sample).geometry,
            labels,
            names,
            title=f"{word}: {shown.value:.2f}",
            size=SIZE,
            up="y",
        )
        whole.paste(Image.open(io.BytesIO(drawn)).convert("RGB"), (k * SIZE[0], 0))
    return whole.quantize(COLOURS)


def main() -> None:
    """Write one picture for each word."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("words", nargs="*", metavar="WORD", help="all where none is given")
    parser.add_argument("--output", type=Path, default=DESTINATION, help="folder to write to")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    for word in arguments.words or (*UNARY, *SHOWN):
        picture(word).save(arguments.output / f"{word}.png", optimize=True)


if __name__ == "__main__":
    main()
