"""Labellings that do not fit or explode: names, numbers, counts, archives, JSON of any build."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case
from tests.fuzz.grids import npy_header_words
from tests.fuzz.seeds import npy, npy_header, npz
from tests.fuzz.statements import LABELS

HOSTILE_NAMES: dict[str, str] = {
    "escapes": "\x1b]0;owned\x07\x1b[31mred\x1b[2J",
    "one-byte escapes": "\x9b31mred\x9d0;owned\x9c",
    "marks of direction": "\u202egnp.\u2066exe\u2069\u200f",
    "no width": "a\u200b\u200d\ufeffb",
    "10,000 characters": "x" * 10_000,
    "a line's end": "one\ntwo\r\nthree\u2028four",
    "NUL": "a\0b",
    "markup of a terminal": "[/x][bold red]big[/]",
    "markup of a page": "<script>alert(1)</script><img src=x onerror=alert(1)>&amp;",
    "a path": "../../../tmp/x",
    "an absolute path": "/etc/passwd",
    "a device": "con",
    "a drive": "C:\\x",
    "dots": "..",
    "a dash": "-rf",
    "a formula": "=cmd|' /C calc'!A0",
    "nothing": "",
    "blanks": "   ",
    "letters that combine": "a" + "\u0301" * 500,
    "half of a pair": "\ud83d",
    "a number": "1e308",
    "quotes": "\"'`$(id)`",
    "a brace": "{part}{}{0.__class__}%s%n",
}
"""Names that are more than names, by what they are."""


def label_cases() -> Iterator[Case]:
    yield from _texts()
    yield from _documents()
    yield from _arrays()
    yield from _archives()


def _case(format: str, suffix: str, kind: str, name: str, make: Callable[[], bytes] | bytes,
          expected: str = EITHER, elements: tuple[int, int] = (1, 44)) -> Case:  # fmt: skip
    made = make if callable(make) else lambda: make
    return Case(format=f"labels, {format}", suffix=suffix, kind=kind, name=name, make=made,
                task="labels", expected=expected, elements=elements)  # fmt: skip


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


_NUMBERS = ("-1", "-2", "-5", "0.5", "nan", "inf", "1e300", "1e999", "2147483648", "4294967296",
  "1e18",
            "9223372036854775807", "9223372036854775808", "18446744073709551616", "9" * 5000,
            "1_0", "0x1", "1.0", "true", "\u0661", "\u00b2", "--1", "1e-320", "+1",
              "1,5")  # fmt: skip


def _numbers(first: int, stop: int) -> str:
    return " ".join(map(str, range(first, stop)))


def _texts() -> Iterator[Case]:
    for name, hostile in HOSTILE_NAMES.items():
        words = [hostile, "handle"]
        yield _case(
            "txt",
            ".txt",
            "names",
            name,
            lambda w=words: _bytes("".join(f"{w[label]}\n" for label in LABELS)),
            EITHER,
            (1, 44),
        )
        yield _case(
            "named lines",
            ".lab",
            "names",
            name,
            lambda h=hostile: _bytes(f"{h}\n{_numbers(1, 21)}\nhandle\n{_numbers(21, 45)}\n"),
        )
        yield _case(
            "csv",
            ".csv",
            "names",
            name,
            lambda w=words: _bytes(
                "face,label\n" + "".join(f"{k},{w[x]}\n" for k, x in enumerate(LABELS))
            ),
        )
    for word in _NUMBERS:
        shown = word if len(word) < 30 else f"of {len(word)} digits"
        yield _case(
            "seg",
            ".seg",
            "numbers",
            f"the label {shown}",
            lambda w=word: _bytes("".join(f"{w if k == 7 else x}\n" for k, x in enumerate(LABELS))),
        )
        yield _case(
            "named lines",
            ".lab",
            "references",
            f"the face {shown}",
            lambda w=word: _bytes(f"head\n{' '.join(map(str, range(1, 21)))} {w}\n"),
        )
        yield _case(
            "csv",
            ".csv",
            "references",
            f"the face {shown}",
            lambda w=word: _bytes(
                "face,label\n"
                + "".join(f"{w if k == 7 else k},{x}\n" for k, x in enumerate(LABELS))
            ),
        )
    for n in (0, 1, 43, 45, 132, 1_000_000):
        expected = REFUSED if n != 1 else EITHER
        yield _case("seg", ".seg", "counts", f"{n} labels", lambda n=n: b"0\n" * n, expected)
    known: list[tuple[str, str, str, Callable[[], bytes], str]] = [
        ("seg", "structure", "all in a line", lambda: " ".join(map(str, LABELS)).encode(), SOUND),
        ("seg", "structure", "words and numbers", lambda: b"0\nleg\n" * 22, EITHER),
        ("seg", "structure", "a line of 10 million blanks", lambda: b" " * 10_000_000 + b"0\n" * 44,
         EITHER),
        ("txt", "large", "as many names as faces", lambda: "".join(
            f"name{k}\n" for k in range(44)).encode(), SOUND),
        ("csv", "structure", "two columns of labels", lambda: b"label,label\n" + b"0,1\n" * 44,
          EITHER),
        ("csv", "structure", "20,000 columns", lambda: b"label" + b",c" * 20_000 + b"\n" + (
            b"0" + b",1" * 20_000 + b"\n") * 44, EITHER),
        ("csv", "structure", "a face twice", lambda: b"face,label\n" + b"0,1\n" * 44, EITHER),
        ("csv", "structure", "rows that differ", lambda: b"face,label\n" + b"0,1\n0\n" * 22,
          EITHER),
        ("named lines", "structure", "a face of two names", lambda: b"head\n1 2 3\nhandle\n1 2 3\n",
         EITHER),
        ("named lines", "structure", "a name twice", lambda: b"head\n1 2 3\nhead\n4 5 6\n", EITHER),
        ("named lines", "structure", "names alone", lambda: b"head\nhandle\n" * 20, EITHER),
        ("named lines", "large", "300,000 names", lambda: b"".join(
            b"n%d\n%d\n" % (k, 1 + k % 44) for k in range(300_000)), EITHER),
    ]  # fmt: skip
    suffixes = {"seg": ".seg", "txt": ".txt", "csv": ".csv", "named lines": ".lab"}
    for format, kind, name, make, expected in known:
        yield _case(format, suffixes[format], kind, name, make, expected)


_VALUES: tuple[Any, ...] = (
    *(
        None,
        True,
        False,
        -1,
        -5,
        0.5,
        1e308,
        2**31,
        2**63,
        2**64,
        10**400,
        "",
        "x",
        "-1",
        "1e999",
        [],
    ),
    *([[]], {}, [None], [[0], [0]], {"": 0}, [1, "a"], {"a": None}, [[0, 1], 2], "\x1b[2J"),
)


def _documents() -> Iterator[Case]:
    def json_case(kind: str, name: str, document: Any, expected: str = EITHER) -> Case:
        return _case("json list", ".json", kind, name,
                     lambda: document if isinstance(document,
                       bytes) else json.dumps(document).encode(),
                     expected)  # fmt: skip

    for value in _VALUES:
        shown = json.dumps(value)
        shown = shown if len(shown) < 40 else f"{shown[:20]}... of {len(shown)}"
        yield json_case("structure", f"{shown} alone", value)
        yield json_case("structure", f"{shown} among labels", [value, *LABELS[1:]])
        yield json_case("structure", f"{shown} for all labels", [value] * 44)
        yield json_case(
            "structure",
            f"{shown} as a face's label",
            {**{str(k): x for k, x in enumerate(LABELS)}, "7": value},
        )
        yield json_case("structure", f"{shown} among faces", {"head": [value, *range(20)]})
        yield json_case("structure", f"{shown} as faces", {"head": value, "handle": [1, 2]})
        yield json_case("structure", f"{shown} as labels", {"labels": value})
        yield json_case("structure", f"{shown} as names", {"labels": LABELS, "names": value})
        yield json_case("structure", f"{shown} as problem", {"labels": LABELS, "problem": value})
        yield json_case(
            "structure", f"{shown} as segIndices", {"segIndices": value, "segGroups": value}
        )
        yield json_case("structure", f"{shown} as a record", [{"name": "head", "faces": value}])
    for name, hostile in HOSTILE_NAMES.items():
        yield json_case("names", name, [(hostile, "handle")[x] for x in LABELS])
        yield json_case("names", f"{name}, of groups", {hostile: list(range(20)), "handle": [30]})
        yield json_case(
            "names", f"{name}, listed", {"labels": LABELS, "names": [hostile, "handle"]}
        )
        yield json_case("names", f"{name}, as a member", {hostile: LABELS})
    for n in (500, 2000, 100_000):
        yield json_case("nesting", f"{n} lists in each other", b"[" * n + b"]" * n)
        yield json_case("nesting", f"{n} open lists", b"[" * n)
        yield json_case(
            "nesting", f"{n} objects in each other", b'{"labels":' * n + b"1" + b"}" * n
        )
    for name, text in (
        ("NaN", b"[NaN, Infinity, -Infinity]"), ("an integer of 5,000 digits",
          b"[" + b"9" * 5000 + b"]"),
        ("an integer of 3 million digits", b"[" + b"9" * 3_000_000 + b"]"),
        ("a float of 3 million digits", b"[0." + b"9" * 3_000_000 + b"]"),
        ("a million labels", b"[" + b"0," * 1_000_000 + b"0]"),
        ("a comma too many", b"[0,1,]"), ("a comment", b"[0, // one\n 1]"), ("single quotes",
          b"['a']"),
        ("two documents", b"[0][1]"), ("a key twice", b'{"labels": [0], "labels": [1]}'),
        ("300,000 members", b"{" + b",".join(b'"%d": 1' % k for k in range(300_000)) + b"}"),
        ("300,000 names", json.dumps({"labels": LABELS,
          "names": [f"n{k}" for k in range(300_000)]})),
        ("a name numbered 10^15", b'{"labels": [0], "names": {"1000000000000000": "a"}}'),
        ("faces numbered 10^15", b'{"1000000000000000": 1, "0": 1}'),
    ):  # fmt: skip
        yield json_case("structure", name, text.encode() if isinstance(text, str) else text)


def _arrays() -> Iterator[Case]:
    body = np.arange(44).tobytes()
    for kind, name, words in npy_header_words():
        yield _case("npy", ".npy", kind, f"header: {name}", lambda w=words: npy_header(w, body))
    arrays: tuple[tuple[str, Callable[[], np.ndarray]], ...] = (
        ("nan", lambda: np.full(44, np.nan)), ("inf", lambda: np.full(44, np.inf)),
        ("halves", lambda: np.full(44, 0.5)), ("2^63", lambda: np.full(44, 2**63, np.uint64)),
        ("-2^63", lambda: np.full(44, -(2**63))), ("1e300", lambda: np.full(44, 1e300)),
        ("complex", lambda: np.zeros(44, complex)), ("dates", lambda: np.zeros(44, "M8[s]")),
        ("bytes", lambda: np.array([b"a", b"b"] * 22)), ("texts", lambda: np.array(["a",
          "b"] * 22)),
        ("half floats", lambda: np.ones(44, np.float16)), ("nothing", lambda: np.zeros(0)),
        ("one", lambda: np.array(1)), ("a matrix", lambda: np.zeros((44, 44))),
        ("four axes", lambda: np.zeros((44, 1, 1, 1))), ("scores", lambda: np.ones((44, 2)) / 2),
        ("a text of 100,000 characters", lambda: np.array(["x" * 100_000] * 44)),
        ("hostile texts", lambda: np.array(list(HOSTILE_NAMES.values())[:4] * 11)),
        ("44 million labels", lambda: np.zeros(44_000_000, np.uint8)),
    )  # fmt: skip
    for name, make in arrays:
        kind = "large" if "million" in name else "numbers"
        yield _case("npy", ".npy", kind, name, lambda make=make: npy(make()))
        yield _case("npz", ".npz", kind, name, lambda make=make: npz(labels=make()))
        if "million" not in name:
            yield _case(
                "npz",
                ".npz",
                kind,
                f"{name} as names",
                lambda make=make: npz(labels=np.array(LABELS), names=make()),
            )


def _zip(entries: dict[str, bytes], *, squeeze: bool = False) -> bytes:
    file = io.BytesIO()
    method = zipfile.ZIP_DEFLATED if squeeze else zipfile.ZIP_STORED
    with zipfile.ZipFile(file, "w", method) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return file.getvalue()


def _archives() -> Iterator[Case]:
    words = "{'descr': '<i8', 'fortran_order': False, 'shape': (%s,)}"
    labels = npy(np.array(LABELS))

    def archive(kind: str, name: str, make: Callable[[], bytes], expected: str = EITHER) -> Case:
        return _case("npz", ".npz", kind, name, make, expected)

    for kind, name, header in npy_header_words():
        yield archive(
            kind,
            f"header: {name}",
            lambda h=header: _zip({"labels.npy": npy_header(h, np.arange(44).tobytes())}),
        )
    for n in (10**9, 10**12, 2**60):
        yield archive(
            "expansion",
            f"an array that announces {n} labels",
            lambda n=n: _zip({"labels.npy": npy_header(words % n)}),
            REFUSED,
        )
    gigabyte = 1 << 27
    yield archive(
        "expansion",
        "a gigabyte of zeros",
        lambda: _zip(
            {"labels.npy": npy_header(words % gigabyte, bytes(8 * gigabyte))}, squeeze=True
        ),
        REFUSED,
    )
    yield archive(
        "expansion",
        "a gigabyte beside the labels",
        lambda: _zip(
            {"labels.npy": labels, "x.npy": npy_header(words % gigabyte, bytes(8 * gigabyte))},
            squeeze=True,
        ),
    )
    yield archive(
        "large", "10,000 arrays", lambda: _zip({f"a{k}.npy": labels for k in range(10_000)})
    )
    for name, hostile in HOSTILE_NAMES.items():
        if name not in ("half of a pair", "nothing"):
            yield archive(
                "names",
                f"an array called {name}",
                lambda h=hostile: _zip({f"{h}.npy": labels, "other.npy": labels}),
            )
        if name != "half of a pair":
            yield archive(
                "names",
                name,
                lambda h=hostile: npz(labels=np.array(LABELS), names=np.array([h, "handle"])),
            )
    sound = _zip({"labels.npy": labels})
    known = (
        ("no arrays", _zip({})), ("a file that is no array", _zip({"labels.npy": b"hello"})),
        ("a file without a suffix", _zip({"labels": labels})),
        ("an archive in it", _zip({"labels.npy": sound})),
        ("bytes in front", b"junk" * 100 + sound), ("bytes behind", sound + b"junk" * 100),
        ("an unknown method", _method(sound, 99)), ("encrypted", _flags(sound, 1)),
        ("a wrong sum", sound.replace(labels, labels[:-1] + b"\x09")),
        ("a wrong offset", sound[:-6] + struct.pack("<I", 2**31) + sound[-2:]),
        ("a comment of 65,535 bytes", sound[:-2] + b"\xff\xff" + b"c" * 65_535),
        ("an array alone", labels), ("a pickle", b"\x80\x04K\x01."),
        ("pickled objects", _zip({"labels.npy": npy_header(
            "{'descr': '|O', 'fortran_order': False, 'shape': (1,)}",
              b"cos\nsystem\n(S'id'\ntR.")})),
    )  # fmt: skip
    for name, data in known:
        yield archive("code" if "pickle" in name else "structure", name, lambda d=data: d)


def _method(archive: bytes, method: int) -> bytes:
    """The archive with another method of compression, in both headers."""
    at = archive.index(b"PK\x01\x02")
    code = struct.pack("<H", method)
    return archive[:8] + code + archive[10 : at + 10] + code + archive[at + 12 :]


def _flags(archive: bytes, flags: int) -> bytes:
    at = archive.index(b"PK\x01\x02")
    code = struct.pack("<H", flags)
    return archive[:6] + code + archive[8 : at + 8] + code + archive[at + 10 :]
