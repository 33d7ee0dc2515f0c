"""Links that leave the folder ``docs`` lead to something on the site.

Pages link to files beside the folder as a reader of the checkout needs it,
``[the bundle's page](../plugins/moseg_recipes_shapes/README.md)``. Some such files are pages of the
site too (:data:`COPIES`), copied to ``docs/generated`` with their links made to fit. Others have a
page of their own here under another name (:data:`INSTEAD`). Any other link out of the folder is
left alone, so that MyST complains of it.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

DOCS = Path(__file__).resolve().parents[1]
ROOT = DOCS.parent

#: Files of the project that are pages of the site, under these names.
COPIES = {
    "CHANGELOG.md": "generated/changes.md",
    "CONTRIBUTING.md": "generated/contributing.md",
    "plugins/moseg_recipes_shapes/README.md": "generated/recipes_shapes.md",
}
#: Files and folders that have a page of their own.
INSTEAD = {
    "README.md": "index.md",
    "examples": "gallery/index.rst",
    "docs/authors/tutorial/README.md": "authors/tutorial.md",
}

_LINK = re.compile(r"(?<=\]\()(?!\w+:|#|/)([^)#\s]+)")


def led_home(text: str, file: str) -> str:
    """The text of a Markdown file with links that fit the site.

    Parameters
    ----------
    text : str
    file : str
        Where the file is, from the root of the project.
    """

    def led(found: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(file), found[1]))
        page = COPIES.get(target) or INSTEAD.get(target)
        if page is not None:
            return f"/{page}"
        if target.startswith("docs/") and not file.startswith("docs/"):
            return "/" + target.removeprefix("docs/")
        return found[1]

    return _LINK.sub(led, text)


def write_copies(app: Sphinx, config: Config) -> None:
    """Write the copies; those that are as they were keep their time."""
    for file, page in COPIES.items():
        text = led_home((ROOT / file).read_text(), file)
        path = DOCS / page
        path.parent.mkdir(exist_ok=True)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def lead_home(app: Sphinx, page: str, source: list[str]) -> None:
    """Make the links of a page fit."""
    if app.env.doc2path(page).suffix == ".md":
        source[0] = led_home(source[0], f"docs/{page}.md")


def setup(app: Sphinx) -> dict[str, bool]:
    """Write copies before Sphinx looks for files; change links when it reads them."""
    app.connect("config-inited", write_copies)
    app.connect("source-read", lead_home)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
