"""Examples in the help of commands: the section of that name of their docstrings.

The parser reads of a docstring what it says of the command and of its parameters; its help ends
with the examples, as they would be typed.
"""

from __future__ import annotations

import inspect
import re
import textwrap

from cyclopts import App


def show_examples(app: App) -> None:
    """Let the help of every command of an app, and of those below, end with its examples."""
    for name in app:
        if name.startswith("-"):
            continue
        command = app[name]
        show_examples(command)
        documented = getattr(command.default_command, "__doc__", None) or ""
        if examples := examples_in(documented):
            # Indented, Markdown is left as it is.
            command.help_epilogue = f"Examples\n\n{textwrap.indent(examples, '    ')}"


def examples_in(docstring: str) -> str:
    r"""The section "Examples" of a numpydoc docstring; empty where there is none.

    Examples
    --------
    >>> examples_in("Do it.\n\nExamples\n--------\ndo it\n\nParameters\n----------\nx")
    'do it'
    """
    after = inspect.cleandoc(docstring).partition("Examples\n--------\n")[2]
    return re.split(r"\n\n\w[\w ]*\n-{3,}\n", after)[0].strip()
