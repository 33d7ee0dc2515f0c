"""Draw ``docs/images/results.png``: samples as moseg cuts them, in a row.

Run it from anywhere::

    python tools/results_picture.py

Each shape is searched with the recipe that is named in :data:`RECIPES`, and seed 0; whoever reads
the picture can make the same result.
"""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import moseg_core as moseg
from moseg_core.view.palette import part_colors
from moseg_core.view.picture import draw_two_sides

DESTINATION = Path(__file__).resolve().parent.parent / "docs" / "images" / "results.png"
SIZE = (840, 420)
COLOURS = 128

#: For each sample the recipe that it is cut by.
RECIPES = {"octopus": "octopus", "horse": "fourleg", "hammer": "hammer", "dove": "bird"}


def picture(sample: str) -> Image.Image:
    """One side of a sample, over its name."""

    def caption(draw: ImageDraw.ImageDraw, /, *, size: tuple[int, int], pad: int) -> int:
        font = ImageFont.load_default(size=22)
        draw.text((size[0] / 4, size[1] - pad), sample, fill="#444", font=font, anchor="ms")
        return size[1] - 4 * pad

    shape = moseg.load(moseg.sample_path(sample))
    result = moseg.segment_variants(
        shape, RECIPES[sample], seed=0, workers=moseg.available_workers()
    )
    drawn = draw_two_sides(
        shape.geometry,
        result.labels,
        result.labels,
        part_colors(len(result.problem.labels)),
        legend=caption,
        title="",
        size=SIZE,
    )
    return Image.open(io.BytesIO(drawn)).convert("RGB").crop((0, 0, SIZE[0] // 2, SIZE[1]))


def main() -> None:
    """Write the picture."""
    tiles = [picture(sample) for sample in RECIPES]
    row = Image.new("RGB", (sum(tile.width for tile in tiles), SIZE[1]), "white")
    for place, tile in enumerate(tiles):
        row.paste(tile, (place * tile.width, 0))
    row.quantize(COLOURS).save(DESTINATION, optimize=True)


if __name__ == "__main__":
    main()
