"""Draw results for the pages: ``results.png``, ``mend.png`` and ``words.png`` in ``docs/images``.

Run it from anywhere; it takes some minutes::

    python tools/results_picture.py

Each shape is searched as it says here, with seed 0; whoever reads the pictures can make the same
results. The second row is that of the page ``docs/how_to/mend.md``, the third picture that of
``docs/how_to/words.md``.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image

import moseg_core as moseg

IMAGES = Path(__file__).resolve().parent.parent / "docs" / "images"
SIZE = (420, 420)
COLOURS = 128

#: For each sample the recipe that it is cut by.
RECIPES = {"octopus": "octopus", "horse": "fourleg", "hammer": "hammer", "dove": "bird"}

#: A bulldog in words that get better; and how it is searched.
LABELS = ["body", "head", "leg1", "leg2", "leg3", "leg4"]
_SIZES = (
    "is(body, area=0.35+-0.1) + is(head, area=0.3+-0.1) + is(leg*, area=0.09+-0.03)"
    " + touching(body, head, leg*) + apart(head, leg*)"
)
_CREASES = f"{_SIZES} + 15*separate_parts + 30*even_parts"
_BELOW = _CREASES + "".join(f' + 3*above(body, leg{k}, up="y", margin=0.3)' for k in range(1, 5))
MENDED = {
    "sizes": (_SIZES, "kmeans"),
    "and creases": (_CREASES, "sized_evolution"),
    "and below the body": (_BELOW, "sized_evolution"),
}


#: A dove in words.
DOVE = (
    "is(body, area=0.4+-0.15) + is(tail, area=0.1+-0.05) + is(wing*, area=0.25+-0.07)"
    " + flat(wing*) + touching(body, tail, wing*) + 15*separate_parts + 30*even_parts"
)


def tile(sample: str, labels: np.ndarray, count: int, caption: str) -> Image.Image:
    """One side of a labelled sample, under a caption."""
    drawn = moseg.render_picture(
        moseg.load(moseg.sample_path(sample)).geometry,
        labels,
        [str(k) for k in range(count)],
        title=caption,
        size=SIZE,
        up="y",
        views=["main"],
        legend=False,
    )
    return Image.open(io.BytesIO(drawn)).convert("RGB")


def write_row(name: str, tiles: list[Image.Image]) -> None:
    """Write tiles beside each other."""
    row = Image.new("RGB", (sum(tile.width for tile in tiles), SIZE[1]), "white")
    for place, one in enumerate(tiles):
        row.paste(one, (place * one.width, 0))
    row.quantize(COLOURS).save(IMAGES / name, optimize=True)


def by_recipe(sample: str) -> Image.Image:
    """A sample, cut by its recipe."""
    shape = moseg.load(moseg.sample_path(sample))
    workers = moseg.available_workers()
    result = moseg.segment_variants(shape, RECIPES[sample], seed=0, workers=workers)
    return tile(sample, result.labels, len(result.problem.labels), sample)


def in_words(caption: str) -> Image.Image:
    """The bulldog, cut by some of the words."""
    words, seeder = MENDED[caption]
    result = moseg.segment(
        moseg.load(moseg.sample_path("bulldog")),
        moseg.Problem(LABELS, words),
        seeder=seeder,
        seed=0,
        workers=moseg.available_workers(),
    )
    return tile("bulldog", result.labels, len(LABELS), caption)


def write_words() -> None:
    """Write the dove, cut by its words, from both sides."""
    shape = moseg.load(moseg.sample_path("dove"))
    problem = moseg.Problem(["body", "tail", "wing1", "wing2"], DOVE)
    result = moseg.segment(shape, problem, seed=0, workers=moseg.available_workers())
    drawn = moseg.render_picture(
        shape.geometry, result.labels, problem.labels, size=(900, 400), up="y"
    )
    Image.open(io.BytesIO(drawn)).quantize(COLOURS).save(IMAGES / "words.png", optimize=True)


def main() -> None:
    """Write all pictures."""
    write_row("results.png", [by_recipe(sample) for sample in RECIPES])
    write_row("mend.png", [in_words(caption) for caption in MENDED])
    write_words()


if __name__ == "__main__":
    main()
