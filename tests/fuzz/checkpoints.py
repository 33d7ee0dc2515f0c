"""Checkpoints that lie: lines whose sum is right and whose contents are not, heads of any build."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from collections.abc import Iterator
from typing import Any

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case
from tests.fuzz.documents import VALUES
from tests.fuzz.seeds import Seed

RUN = {"shape": "abc", "problem": {"labels": ["head", "handle"]}, "versions": {"core": "0.1.0"}}
"""What the checkpoint is of."""
_ANSWERS = 40


def _answer(number: int, count: int = 2) -> bytes:
    return struct.pack("<16sI2d", b"%016d" % number, count, 0.5, float(number))


def _line(data: bytes) -> bytes:
    return b"%08x " % zlib.crc32(data) + base64.b64encode(data) + b"\n"


def _head(run: Any = RUN, format: Any = "moseg-checkpoint/1") -> bytes:
    return json.dumps({"format": format, "run": run}).encode() + b"\n"


def checkpoint() -> bytes:
    """A sound one: a head, and four lines of ten answers."""
    lines = [b"".join(_answer(k) for k in range(n, n + 10)) for n in range(0, _ANSWERS, 10)]
    return _head() + b"".join(map(_line, lines))


CHECKPOINT_SEED = Seed(
    format="checkpoint",
    suffix=".checkpoint",
    data=checkpoint,
    elements=_ANSWERS,
    counted=False,
    text=True,
    task="checkpoint",
)


def checkpoint_cases() -> Iterator[Case]:
    def case(kind: str, name: str, data: bytes, expected: str = EITHER, most: int = 40) -> Case:
        return Case(
            format="checkpoint",
            suffix=".checkpoint",
            kind=kind,
            name=name,
            make=lambda: data,
            task="checkpoint",
            expected=expected,
            elements=(0, most),
        )

    for value in VALUES:
        shown = json.dumps(value)
        shown = shown if len(shown) < 30 else f"{shown[:20]}... of {len(shown)}"
        yield case("structure", f"a run that is {shown}", _head(value), REFUSED)
        yield case("structure", f"the format {shown}", _head(format=value), REFUSED)
        yield case("structure", f"a shape that is {shown}", _head({**RUN, "shape": value}), REFUSED)
        yield case("structure", f"another member, {shown}", _head({**RUN, "a": value}), REFUSED)
    for n in (500, 2000, 100_000):
        deep = (
            b'{"format": "moseg-checkpoint/1", "run": ' + b'{"a": ' * n + b"1" + b"}" * n + b"}\n"
        )
        yield case("nesting", f"a run {n} deep", deep, REFUSED)
    for digits in (400, 5000, 3_000_000):
        head = b'{"format": "moseg-checkpoint/1", "run": {"a": ' + b"9" * digits + b"}}\n"
        yield case("numbers", f"an integer of {digits} digits", head, REFUSED)
    sound = checkpoint()
    for count in (0, 1, 3, 2**16, 2**31, 2**32 - 1):
        line = _line(_answer(99, count))
        yield case("counts", f"an answer that announces {count} values", sound + line, most=41)
    for name, data in (
        ("half of an answer", _answer(1)[:20]),
        ("no answer", b""),
        ("one byte", b"a"),
        ("the same answer twice", _answer(1) + _answer(1)),
        ("another value of an answer that is known", _answer(1)[:-8] + bytes(8)),
        ("values that are no numbers", _answer(99)[:-8] + b"\xff" * 8),
    ):
        yield case("structure", name, sound + _line(data), SOUND, 41)
    known = (
        ("a line without a sum", base64.b64encode(_answer(99)) + b"\n"),
        ("a line with a wrong sum", b"0" * 9 + base64.b64encode(_answer(99)) + b"\n"),
        ("a line of noise", b"\xff\x00\x1b[2J" * 1000 + b"\n"),
        ("a line of 30 megabytes", b"00000000 " + b"A" * 30_000_000 + b"\n"),
        ("300,000 empty lines", b"\n" * 300_000),
        ("a last line without an end", _line(_answer(99))[:-1]),
    )
    for name, data in known:
        yield case("structure", name, sound + data, SOUND)
    yield case("large", "100,000 lines", sound + b"".join(
        _line(_answer(k)) for k in range(100_000)), SOUND, 100_000)  # fmt: skip
    yield case("structure", "no head", sound.partition(b"\n")[2], REFUSED)
    yield case("structure", "two heads", _head() + sound, SOUND)
