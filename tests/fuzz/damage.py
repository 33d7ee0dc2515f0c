"""What can happen to any file on its way: cut off, bits turned, another encoding, another name.

Everything is done to the sound files of every format alike. What comes of it is known where the
format is: a file that says how much it holds cannot be accepted with less.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case
from tests.fuzz.checkpoints import CHECKPOINT_SEED
from tests.fuzz.seeds import SEEDS, Seed
from tests.fuzz.statements import LABEL_SEEDS, OTHER_SEEDS

ALL_SEEDS = [*SEEDS, *LABEL_SEEDS, *OTHER_SEEDS, CHECKPOINT_SEED]
_TURNS, _SPLICES = 24, 12


def damaged() -> Iterator[Case]:
    """All damage to all sound files."""
    for seed in ALL_SEEDS:
        yield _case(seed, "untouched", "as it is", lambda data: data, SOUND)
        yield from _cut(seed)
        yield from _turned(seed)
        yield from _spliced(seed)
        if seed.text:
            yield from _encoded(seed)
        if seed.task == "shape":
            yield from _renamed(seed)


def _case(
    seed: Seed,
    kind: str,
    name: str,
    change: Callable[[bytes], bytes],
    expected: str = EITHER,
    elements: tuple[int, int] | None = None,
    suffix: str = "",
) -> Case:
    return Case(
        format=seed.format,
        kind=kind,
        name=name,
        suffix=suffix or seed.suffix,
        make=lambda: seed.with_data(change(seed.data())),
        task=seed.task,
        expected=expected,
        elements=(seed.elements, seed.elements) if elements is None else elements,
    )


def _fewest(seed: Seed) -> int:
    """How much is left at least of what is accepted; damaged lines of a checkpoint are left out."""
    return 0 if seed.task == "checkpoint" else 1


def _cut(seed: Seed) -> Iterator[Case]:
    """Cut off at every hundredth of the length."""
    least = seed.elements if seed.counted else _fewest(seed)
    yield _case(seed, "cut off", "at 0 %", lambda data: b"", REFUSED)
    for percent in range(1, 100):
        yield _case(
            seed,
            "cut off",
            f"at {percent} %",
            lambda data, percent=percent: data[: max(1, len(data) * percent // 100)],
            elements=(least, seed.elements),
        )


def _turned(seed: Seed) -> Iterator[Case]:
    """A few bits turned over, at places that a generator draws."""
    for k in range(_TURNS):

        def turn(data: bytes, k: int = k) -> bytes:
            draw = random.Random(f"{seed.format} {k}")
            out = bytearray(data)
            for _ in range(1 + k % 3):
                out[draw.randrange(len(out))] ^= 1 << draw.randrange(8)
            return bytes(out)

        yield _case(seed, "bits turned", f"draw {k}", turn, elements=(_fewest(seed), 10_000))


def _spliced(seed: Seed) -> Iterator[Case]:
    """A stretch left out, written twice, or overwritten with noise, zeros or ones."""
    for k in range(_SPLICES):

        def splice(data: bytes, k: int = k) -> bytes:
            draw = random.Random(f"{seed.format} splice {k}")
            start = draw.randrange(len(data))
            length = draw.choice((1, 2, 4, 16, 64))
            stretch = data[start : start + length]
            put = (b"", 2 * stretch, draw.randbytes(len(stretch)), bytes(len(stretch)),
                   b"\xff" * len(stretch), stretch[::-1])[k % 6]  # fmt: skip
            return data[:start] + put + data[start + length :]

        yield _case(seed, "bytes spliced", f"draw {k}", splice, elements=(_fewest(seed), 10_000))


ENCODINGS: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "byte-order mark": (lambda data: b"\xef\xbb\xbf" + data, EITHER),
    "lines end in CR LF": (lambda data: data.replace(b"\n", b"\r\n"), SOUND),
    "lines end in CR": (lambda data: data.replace(b"\n", b"\r"), EITHER),
    "UTF-16": (lambda data: data.decode("latin1").encode("utf-16"), EITHER),
    "UTF-16 without a mark": (lambda data: data.decode("latin1").encode("utf-16-le"), EITHER),
    "UTF-32": (lambda data: data.decode("latin1").encode("utf-32"), EITHER),
    "no-break spaces": (lambda data: data.replace(b" ", "\u00a0".encode()), EITHER),
    "no-break spaces of Latin-1": (lambda data: data.replace(b" ", b"\xa0"), EITHER),
    "form feeds for blanks": (lambda data: data.replace(b" ", b"\x0c"), EITHER),
    "NUL in front": (lambda data: bytes(16) + data, EITHER),
    "NUL within": (lambda data: data[: len(data) // 2] + b"\0" + data[len(data) // 2 :], EITHER),
    "zeros behind": (lambda data: data + bytes(300), EITHER),
    "a terminal's escape within": (
        lambda data: data.replace(b"\n", b" \x1b]0;owned\x07\x1b[31m\n", 2), EITHER),
    "marks of direction within": (
        lambda data: data.replace(b"\n", " \u202egnp\u2066\u200f\n".encode(), 2), EITHER),
    "not UTF-8": (lambda data: data.replace(b"\n", b" \xff\xfe\xc3\x28\n", 2), EITHER),
    "a line of 3 million digits": (lambda data: data.replace(b"\n", b" " + b"7" * 3_000_000, 1),
                                   EITHER),
    "a line of 3 million words": (lambda data: data.replace(b"\n", b" 7" * 1_500_000 + b"\n", 1),
                                  EITHER),
    "a million empty lines": (lambda data: b"\n" * 1_000_000 + data, EITHER),
    "the file twice": (lambda data: data + data, EITHER),
    "digits of another script": (
        lambda data: data.decode("latin1").translate(
            {ord("0") + k: chr(0x660 + k) for k in range(10)}).encode(), EITHER),
    "minus signs of print": (lambda data: data.replace(b" 1", " \u22121".encode()), EITHER),
    "underscores in numbers": (lambda data: data.replace(b" 1", b" 1_0"), EITHER),
    "upper case": (lambda data: data.upper(), EITHER),
}  # fmt: skip


def _encoded(seed: Seed) -> Iterator[Case]:
    """The same text in another encoding, with other ends of lines, with what does not belong."""
    for name, (change, expected) in ENCODINGS.items():
        exact = "UTF" in name or (expected == SOUND and seed.task != "checkpoint")
        loose = seed.task in ("expression", "checkpoint", "labels")
        yield _case(
            seed,
            "encoding",
            name,
            change,
            EITHER if loose else expected,
            elements=None if exact else (_fewest(seed), 4 * seed.elements),
        )


def _renamed(seed: Seed) -> Iterator[Case]:
    """The file under the suffix of every other format."""
    suffixes = dict.fromkeys(other.suffix for other in SEEDS)
    for suffix in suffixes:
        if suffix != seed.suffix:
            yield _case(
                seed,
                "another format",
                f"called {suffix}",
                lambda data: data,
                elements=(1, 10_000),
                suffix=suffix,
            )
