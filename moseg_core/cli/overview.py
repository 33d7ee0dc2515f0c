"""What ``moseg`` says of itself: the list of commands, and its version.

It is the first that anybody asks of a program, and answered at once: no argument is parsed for it,
so neither the parser of the command line nor what lays out tables is imported. Everything else,
the help of each command among it, is the parser's (:mod:`moseg_core.cli.app`), and tests hold
this list to what the parser would have printed, and to what the bundles say.
"""

from __future__ import annotations

import os
import shutil
import textwrap
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TextIO

from moseg_core.components.discovery.contract import VERSION

PURPOSE = "Say what the parts of a shape are like; get the shape cut into named parts."
EPILOGUE = (
    "Bundles bring further commands: see 'moseg plugin list'. With --no-plugins any command does"
    " without bundles."
)
VERSION_LINE = f"moseg {VERSION}"

#: What there is to ask for, in the order of use, with what each does: the first line of its help.
ENTRIES = {
    "segment": "Cut a shape into named parts.",
    "batch": "Segment many shapes, each in a guarded process; what fails harms no other.",
    "learn": "Make a recipe of labelled examples.",
    "tune": "Find the words for a shape by looking: sliders for weights, centres moved by hand.",
    "view": "Turn a labelled shape in the browser: parts, areas, costs; a click places a centre.",
    "measure": "Measure parts: a table of areas, volumes, lengths and more, of one shape or many.",
    "export": "Write other files of a saved result, also with labels corrected by hand; nothing is"
    " searched.",
    "render": "Draw a segmented shape: a picture of any labels, from the sides that are asked for.",
    "explain": "Show what a segmentation costs, by term and part.",
    "evaluate": "Compare a labelling with true ones: the measures of the Princeton benchmark, and"
    " names.",
    "field": "Show a field: a number for each element of a shape, such as how thick it is there.",
    "plot": "Draw how a search went: cost per generation and per iteration, and what the starts"
    " came to.",
    "symmetry": "Show the planes and axes of symmetry of a shape.",
    "embed": "Write a shape with its limbs stretched out, to look at.",
    "benchmark": "How well results agree with people.",
    "objectives": "List the objectives that expressions are made of, or explain one.",
    "recipes": "List installed recipes, or print one as it was shipped, to change it.",
    "sample": "Write a sample shape, to try things on.",
    "plugin": "Installed bundles of objectives, seeders, formats and more.",
    "--install-completion": "Let your shell complete moseg's commands and options.",
    "--help (-h)": "Display this message and exit.",
    "--version": "Display application version.",
}
#: Those that bundles bring, by the package that has to be there. To ask every bundle for its
#: commands would take as long as all the rest, so these are the ones that come with moseg.
FROM_BUNDLES = {
    "learn": "moseg_learn",
    "symmetry": "moseg_symmetry",
    "embed": "moseg_mds",
    "benchmark": "moseg_benchmark",
}

#: Columns below which lines get no shorter.
_NARROWEST = 40


def overview_of(arguments: Sequence[str], stream: TextIO) -> str | None:
    """The text that answers a command line, where that asks for no command; else None.

    Parameters
    ----------
    arguments : sequence of str
        Those of the command line.
    stream : file
        Where the text will be written; a terminal gets colours, unless ``NO_COLOR`` is set.

    Examples
    --------
    >>> import sys
    >>> overview_of(["--help"], sys.stdout).splitlines()[0]
    'Usage: moseg COMMAND'
    >>> overview_of(["segment", "--help"], sys.stdout) is None
    True
    """
    if list(arguments) == ["--version"]:
        return VERSION_LINE
    if list(arguments) not in ([], ["--help"], ["-h"]):
        return None
    styled = stream.isatty() and "NO_COLOR" not in os.environ
    return draw_overview(
        shutil.get_terminal_size().columns,
        styled=styled,
        unicode=(stream.encoding or "").lower().startswith("utf"),
    )


def present_entries() -> dict[str, str]:
    """What there is to ask for here: the core's own, and of bundles what is installed.

    Examples
    --------
    >>> list(present_entries())[0]
    'segment'
    """
    return {
        name: summary
        for name, summary in ENTRIES.items()
        if name not in FROM_BUNDLES
        or (find_spec(FROM_BUNDLES[name]) is not None and os.environ.get("MOSEG_NO_PLUGINS") != "1")
    }


def draw_overview(width: int, *, styled: bool = False, unicode: bool = True) -> str:
    """The list of commands in a frame.

    Parameters
    ----------
    width : int
        Columns of a line; at least 40 are taken.
    styled : bool
        Whether names are coloured, by the codes that terminals understand.
    unicode : bool
        Whether the frame may be of other characters than those of ASCII.
    """
    width = max(width, _NARROWEST)
    bold, cyan, plain = ("\x1b[1m", "\x1b[36m", "\x1b[0m") if styled else ("", "", "")
    top_left, top_right, bottom_left, bottom_right, across, down = "╭╮╰╯─│" if unicode else "++++-|"
    entries = present_entries()
    longest = max(map(len, entries))
    room = width - len("| ") - longest - len("  ") - len(" |")
    title = f"{top_left}{across} Commands "
    lines = [
        f"{bold}Usage: moseg COMMAND{plain}",
        "",
        *textwrap.wrap(PURPOSE, width),
        "",
        title + across * (width - len(title) - 1) + top_right,
    ]
    for name, summary in entries.items():
        for row, text in enumerate(textwrap.wrap(summary, room)):
            said = "" if row else name
            lines.append(f"{down} {cyan}{said:{longest}}{plain}  {text:{room}} {down}")
    lines += [bottom_left + across * (width - 2) + bottom_right, ""]
    return "\n".join([*lines, *textwrap.wrap(EPILOGUE, width)])
