"""What an example writes is shown with it: pictures as pictures, pages of results as they are.

An example is told a folder on its command line and writes files there. After each block of code
sphinx-gallery asks its scrapers for what there is to see (its documentation, "Write a custom image
scraper"). Pictures are copied to where it wants them; a page ``x.html`` is copied beside the site
and embedded as a frame.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
#: Where examples write, a folder for each.
WRITTEN = ROOT / "build" / "gallery"
#: Pages of results; the site has them under the same names (``html_extra_path``).
PAGES = WRITTEN / "pages"

_FRAME = """\
.. raw:: html

    <iframe class="result-page" src="../results/{name}" title="{title}" loading="lazy"></iframe>
"""


def folder_of_examples(gallery_conf: dict[str, Any], script_vars: dict[str, Any]) -> list[str]:
    """The command line of an example: an empty folder of its own."""
    folder = WRITTEN / Path(script_vars["src_file"]).stem
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return [str(folder)]


def show_files(
    block: tuple[str, str, int], block_vars: dict[str, Any], gallery_conf: dict[str, Any]
) -> str:
    """Text that shows what an example has written and no block before showed."""
    from sphinx_gallery.scrapers import figure_rst

    folder = WRITTEN / Path(block_vars["src_file"]).stem
    shown = block_vars.setdefault("files_that_are_shown", set())
    pictures, frames = [], []
    for path in sorted(folder.glob("*.*")):
        if path in shown:
            continue
        if path.suffix == ".png":
            picture = next(block_vars["image_path_iterator"])
            shutil.copy(path, picture)
            pictures.append(picture)
            shown.add(path)
        elif path.suffix == ".html":
            name = f"{folder.name}-{path.name}"
            (PAGES / "results").mkdir(parents=True, exist_ok=True)
            shutil.copy(path, PAGES / "results" / name)
            frames.append(_FRAME.format(name=name, title=f"The result of {folder.name}, in 3D"))
            shown.add(path)
    return figure_rst(pictures, gallery_conf["src_dir"]) + "\n".join(frames)


def _get_sg_image_scraper() -> Any:
    """What sphinx-gallery asks of a module that is named as a scraper."""
    return show_files
