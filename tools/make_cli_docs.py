"""Make ``docs/cli.md``: every command with its options, as ``moseg COMMAND --help`` explains them.

From the parser itself, by cyclopts' own generator of documentation, with the commands of moseg's
bundles, in the order of ``moseg --help``. A test compares::

    python tools/make_cli_docs.py
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from unittest.mock import patch

from cyclopts import App

from moseg_core.cli.app import app
from moseg_core.cli.overview import ENTRIES, PURPOSE
from moseg_core.components.discovery.registry import registry
from tools.make_component_docs import BUNDLES

PAGE = Path(__file__).parents[1] / "docs" / "cli.md"

INTRODUCTION = f"""\
# The command line

{PURPOSE}
`moseg COMMAND --help` prints the same of one command; made from the parser by
`tools/make_cli_docs.py`.

Data goes to stdout, messages to stderr. Exit codes are 0 ok, 1 failure, 2 usage or expression, 3 a
shape that cannot be used, 130 interrupted, 129 or 143 told to end.
"""


def commands() -> App:
    """All commands, without a change to the parser that the process itself uses."""
    found = {name: app[name] for name in app if not name.startswith("-")}
    for component in registry().components("command"):
        if component.bundle in BUNDLES:
            found.setdefault(component.spec.name, component.load())
    order = [*ENTRIES, *found]
    whole = App(name="moseg", help_flags=[], version_flags=[])
    for name in sorted(found, key=order.index):
        whole.command(found[name], name=name)
    return whole


def page() -> str:
    """The text of the page."""
    with patch.object(sys, "argv", ["moseg"]):  # what usage is said of
        text = commands().generate_docs()
    text = text[text.index("**Commands**") :]
    return f"{INTRODUCTION}\n" + re.sub(r"\n{3,}", "\n\n", text).strip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
