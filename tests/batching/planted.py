"""A bundle with an objective that comes to harm at shapes whose names say how; and such shapes.

Tests of a batch plant these among sound shapes.
"""

from __future__ import annotations

from pathlib import Path

from moseg_core.batching.instructions import Instructions
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from tests import shapes

BUNDLE = """
from moseg_core import ObjectiveSpec, hookimpl
moseg_contract = 1

@hookimpl
def moseg_objectives():
    return [ObjectiveSpec(name="planted", target="planted_objective:planted", summary="a test")]
"""

OBJECTIVE = """
import ctypes
import os
import time

import moseg_core

KEPT, SEEN = [], set()


@moseg_core.objective(range=(0, 1))
def planted(part: moseg_core.Part) -> float:
    name = part.shape.name
    SEEN.add(name)
    if name.startswith("segfault"):
        ctypes.string_at(0)
    if name.startswith("hang"):
        time.sleep(3600)
    if name.startswith("spin"):
        while True:
            pass
    if name.startswith("hog"):
        while True:
            KEPT.append(b"x" * 50_000_000)
    if name.startswith("huge"):
        KEPT.append(bytearray(1 << 46))
    if name.startswith("liar"):
        return 7.0
    if name.startswith("raise"):
        raise ValueError("no idea")
    if name.startswith("leave"):
        raise SystemExit(0)
    if name.startswith("vanish"):
        os._exit(0)
    if name.startswith("interrupt"):
        raise KeyboardInterrupt
    if name.startswith("noise"):
        print("noise" * 1000)
        os.write(1, b"more")
    if name.startswith("moves"):
        os.chdir("/")
    if name.startswith("aged") and len(SEEN) > 1:
        raise ValueError("only in a fresh process")
    if name.startswith("killed"):
        os.kill(os.getpid(), 9)
    return float(part.area / part.shape.area)
"""

#: For each name that harm begins with, what becomes of the shape. The rest is sound.
HARM = {
    "segfault": "crashed",
    "hang": "timeout",
    "spin": "timeout",
    "hog": "out of memory",
    "huge": "out of memory",
    "liar": "plugin error",
    "moves": "plugin error",
    "raise": "plugin error",
    "leave": "plugin error",
    "vanish": "crashed",
    "interrupt": "plugin error",
    "killed": "crashed",
    "broken": "bad shape",
}

STATEMENT = Statement(labels=("a", "b"), minimize="planted:planted(a) + convex_parts")
OPTIONS = SearchOptions(optimizer="pattern_search(max_evaluations=20)", restarts=1)
INSTRUCTIONS = Instructions(statement=STATEMENT, options=OPTIONS)
#: The same on the command line.
WORDS = [
    *("--labels", "a,b", "--minimize", STATEMENT.minimize, "--restarts", "1"),
    *("--optimizer", "pattern_search(max_evaluations=20)"),
]


def write_shape(folder: Path, name: str) -> Path:
    """A small box, of other sides for another name; a file that is cut off where it is broken."""
    path = folder / f"{name}.off"
    sides = [2 + sum(name.encode()) % 3, 1 + len(name) % 2, 1]
    vertices, faces = shapes.box(*sides)
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(repr, map(float, vertex))) for vertex in vertices]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    if name.startswith("broken"):
        lines = lines[:5]
    path.write_text("\n".join(lines) + "\n")
    return path


def expected(name: str) -> str:
    """The kind of outcome of a shape."""
    return next((kind for harm, kind in HARM.items() if name.startswith(harm)), "ok")
