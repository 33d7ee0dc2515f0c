"""Pages of the API: every name of the public face, in the room where it is defined.

``moseg_core/__init__.pyi`` has a line for each public name with the module that defines it, and
``moseg_core.__getattr__`` imports by that list. So a list made from it is complete by
construction. A page ``generated/ROOM.rst`` is written for each room, with an ``autosummary`` that
makes a page for each name; ``generated/index.rst`` lists the rooms.
"""

from __future__ import annotations

import importlib
import inspect
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

DOCS = Path(__file__).resolve().parents[1]
STUB = DOCS.parent / "moseg_core" / "__init__.pyi"

#: Rooms in the order of the site, with what they are called there.
ROOMS = {
    "samples": "Shapes to try",
    "io": "Files",
    "shape": "Shapes",
    "problem": "Problems and recipes",
    "search": "Searching",
    "batching": "Many shapes",
    "clipping": "Boundaries below the mesh's resolution",
    "components": "Components and their authors",
    "language": "Values in expressions",
    "view": "Pictures",
    "errors": "Errors",
    "untrusted": "Text for a terminal",
}
#: Public packages beside the face.
PACKAGES = {"agreement": "Agreement of labellings", "testing": "Checks of components"}


def names_by_room() -> dict[str, list[str]]:
    """Of each room its public names, in alphabetical order.

    Raises
    ------
    KeyError
        A room has public names and no title above.
    """
    found = re.findall(r"^from moseg_core\.(\w+)\S* import (\w+) as \2$", STUB.read_text(), re.M)
    rooms: dict[str, list[str]] = {room: [] for room in ROOMS}
    for room, name in found:
        rooms[room].append(name)
    return {room: sorted(names, key=str.lower) for room, names in rooms.items() if names}


def page(title: str, module: str, names: list[str], said: str = "") -> str:
    """The text of a page that lists names of a module."""
    lines = "".join(f"   {name}\n" for name in names)
    return (
        f"{title}\n{'=' * len(title)}\n\n{said}\n\n.. currentmodule:: {module}\n\n"
        f".. autosummary::\n   :toctree: api\n   :nosignatures:\n\n{lines}"
    )


def write_pages(app: Sphinx, config: Config) -> None:
    """Write a page for each room; those that are as they were keep their time."""
    folder = DOCS / "generated"
    folder.mkdir(exist_ok=True)
    pages = {
        room: page(ROOMS[room], "moseg_core", names) for room, names in names_by_room().items()
    }
    for package, title in PACKAGES.items():
        module = importlib.import_module(f"moseg_core.{package}")
        said = (inspect.getdoc(module) or "").partition("\n")[0]
        pages[package] = page(title, module.__name__, sorted(module.__all__, key=str.lower), said)
    listed = "".join(f"   {room}\n" for room in pages)
    pages["index"] = f"Python\n======\n\n.. toctree::\n   :maxdepth: 1\n\n{listed}"
    for name, text in pages.items():
        path = folder / f"{name}.rst"
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for files."""
    app.connect("config-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
