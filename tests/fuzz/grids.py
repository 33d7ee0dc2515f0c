"""Voxel grids that lie or explode: headers of .npy, binvox, NIfTI and NRRD files."""

from __future__ import annotations

import gzip
import pickle
import zlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case
from tests.fuzz.seeds import N_CELLS, binvox, box, ell, nifti, npy, npy_header, nrrd

_MANY = (1, 1 << 62)


def grid_cases() -> Iterator[Case]:
    yield from _npy()
    yield from _binvox()
    yield from _nifti()
    yield from _nrrd()


def _case(format: str, suffix: str, kind: str, name: str, make: Callable[[], bytes] | bytes,
          expected: str = REFUSED, elements: tuple[int, int] = _MANY) -> Case:  # fmt: skip
    made = make if callable(make) else lambda: make
    return Case(format=format, suffix=suffix, kind=kind, name=name, make=made, expected=expected,
                elements=elements)  # fmt: skip


def npy_header_words() -> list[tuple[str, str, str | bytes]]:
    """Kind, name and text of headers that NumPy's parser does not expect."""

    def head(
        shape: str = "(8,)", descr: str = "'<i8'", order: str = "False", more: str = ""
    ) -> str:
        return f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}{more}}}"

    return [
        *(("counts", f"shape {shape}", head(shape)) for shape in (
            "(True, True)", "(1.0,)", "(-1,)", "(-8, -1)", "(2**64,)", "8", "[8]", "('8',)", "None",
            "(8, None)", "(18446744073709551616,)", "(9223372036854775808,)",
              "(4611686018427387904, 4)",
            "(0,)", "(0, 18446744073709551616)", "(1, 18446744073709551616, 0)", "(8j,)", "((8,),)",
            "(b'8',)", "{8}", "()", "(1e400,)", "(7,)", "(9,)", "(64,)", "(8, 0, 3)")),
        *(("counts", f"{n} dimensions", head("(" + "1," * n + ")")) for n in (33, 64, 65, 5000)),
        *(("nesting", f"{n} minus signs", head("(" + "-" * n + "8,)")) for n in (50, 500, 4000,
          9000)),
        *(("nesting", f"{n} parentheses", head("(" * n + "8," + ")" * n)) for n in (50, 300, 4000)),
        *(("nesting", f"{n} lists in a type", head(descr="[" * n + "'<i8'" + "]" * n))
          for n in (50, 300, 4000)),
        *(("code", f"the type {descr[:40]}", head(descr=descr)) for descr in (
            "'|O'", "'O'", "'<M8[ns]'", "'|V8'", "'|S8'", "'<U2'", "'<c16'", "'<f2'", "'>i8'",
              "'|b1'",
            "'<i3'", "'spam'", "''", "None", "8", "[('a', '<i8')]", "[('a', 'O')]",
              "{'a': ('<i8', 0)}",
            "[('a', '<i4', (1000000, 1000000))]", "'<f16'", "('<i8', (2,))", "'<i8,<i8'", "b'<i8'",
            "'i8' * 3", "__import__('os').system('true')", "['<i8']", "'<V18446744073709551616'",
            "'<U2147483648'", "'<S99999999999'", "'<f8\\x00'")),
        *(("structure", f"order {order}", head(order=order))
          for order in ("1", "None", "'no'", "[]", "True")),
        ("structure", "another key", head(more=", 'a': 1")),
        ("structure", "a key twice", head(more=", 'shape': (9,)")),
        ("structure", "no dictionary", "[1, 2]"), ("structure", "nothing", ""),
        ("structure", "a call", "exec('1')"), ("structure", "no end", "{'descr': '<i8'"),
        ("structure", "a comment", head() + " # " + "x" * 100),
        ("structure", "9,999 blanks", head() + " " * 9999),
        ("structure", "60,000 blanks", head() + " " * 60_000),
        ("encoding", "NUL in it", head() + "\0"), ("encoding", "not ASCII", head(more="\u00e9")),
        ("encoding", "escapes", head(more=", '\x1b]0;owned\x07': 1")),
        ("encoding", "a line's end in it", head().replace(", ", ",\n")),
        ("numbers", "an integer of 5,000 digits", head("(" + "9" * 5000 + ",)")),
    ]  # fmt: skip


def _npy() -> Iterator[Case]:
    body = np.arange(8).tobytes()
    for kind, name, words in npy_header_words():
        yield _case(
            "npy, grid", ".npy", kind, f"header: {name}", lambda w=words: npy_header(w, body)
        )
    for version in (0, 2, 3, 4, 255):
        words = "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2, 2)}"
        yield _case(
            "npy, grid",
            ".npy",
            "structure",
            f"version {version}",
            lambda v=version, w=words: npy_header(w, body, version=v),
            EITHER,
            (7, 7),
        )
    pickled = pickle.dumps(np.array([1, "a", None], object), protocol=2)
    words = "{'descr': '|O', 'fortran_order': False, 'shape': (3,)}"
    yield _case("npy, grid", ".npy", "code", "pickled objects", npy_header(words, pickled))
    yield _case("npy, grid", ".npy", "code", "a pickle alone", pickled)
    yield _case(
        "npy, grid",
        ".npy",
        "code",
        "a pickle that calls",
        npy_header(words, b"cos\nsystem\n(S'touch /tmp/owned'\ntR."),
    )
    yield _case(
        "npy, grid",
        ".npy",
        "counts",
        "a header length of 65,535",
        lambda: b"\x93NUMPY\x01\x00\xff\xff" + npy(ell())[10:],
    )
    yield _case(
        "npy, grid",
        ".npy",
        "counts",
        "a header length of 2^32 - 1",
        lambda: b"\x93NUMPY\x02\x00\xff\xff\xff\xff" + npy(ell())[10:],
    )
    arrays: list[tuple[str, str, Callable[[], np.ndarray], str, tuple[int, int]]] = [
        ("no cell", "numbers", lambda: np.zeros((4, 4, 4), bool), REFUSED, _MANY),
        ("no size", "counts", lambda: np.zeros((0, 4, 4), bool), REFUSED, _MANY),
        ("negative", "numbers", lambda: np.full((3, 3, 3), -1), REFUSED, _MANY),
        ("half floats", "structure", lambda: np.ones((4, 4, 4), np.float16), REFUSED, _MANY),
        ("complex", "structure", lambda: np.ones((4, 4, 4), complex), REFUSED, _MANY),
        ("one axis", "structure", lambda: np.ones(8), REFUSED, _MANY),
        ("four axes", "structure", lambda: np.ones((2, 2, 2, 2), bool), REFUSED, _MANY),
        ("no axis", "structure", lambda: np.array(1), REFUSED, _MANY),
        ("by columns", "structure", lambda: np.asfortranarray(ell()), SOUND, (N_CELLS, N_CELLS)),
        ("of 2^63", "numbers", lambda: np.full((2, 2, 2), 2**63, np.uint64), SOUND, (8, 8)),
        ("one long row", "large", lambda: np.ones((1, 1, 200_000), bool), SOUND, (200_000,) * 2),
        ("200,000 single cells", "large", lambda: np.arange(400_000).reshape(1, 1, -1) % 2 == 0,
         SOUND, (200_000,) * 2),
        ("cells as on a chessboard", "large", lambda: np.indices((50, 50, 50)).sum(0) % 2 == 0,
         SOUND, (62_500,) * 2),
        ("two columns", "structure", lambda: np.ones((9, 2)), REFUSED, _MANY),
        ("3 rows of 1,000 columns", "structure", lambda: np.ones((3, 1000)), REFUSED, _MANY),
        ("one point", "no surface", lambda: np.ones((1, 3)), EITHER, (1, 1)),
        ("no points", "no surface", lambda: np.ones((0, 3)), REFUSED, _MANY),
        ("points in one place", "no surface", lambda: np.ones((5000, 3)), EITHER, (5000, 5000)),
        ("points of nan", "numbers", lambda: np.full((9, 3), np.nan), REFUSED, _MANY),
        ("a point of nan", "numbers", lambda: np.concatenate([box()[0], [[np.nan] * 3]]), EITHER,
         (25, 25)),
        ("a point of inf", "numbers", lambda: np.concatenate([box()[0], [[np.inf] * 3]]), EITHER,
         (25, 25)),
        *((f"a point at {x:g}", "numbers", lambda x=x: np.concatenate([box()[0], [[x] * 3]]),
          EITHER,
           (25, 25)) for x in (1e20, 1e100, 1e155, 1e308)),
        *((f"points of the size {x:g}", "numbers", lambda x=x: box()[0] * x, EITHER, (24, 24))
          for x in (1e-300, 1e-160, 1e-30, 1e100, 1e155, 5e307)),
        ("300,000 points in one place", "large", lambda: np.ones((300_000, 3)), EITHER,
         (300_000,) * 2),
        ("100,000 points in two places", "large", lambda: np.repeat(np.eye(3)[:2], 50_000, 0),
          EITHER,
         (100_000,) * 2),
        ("100,000 points in a line", "large",
         lambda: np.arange(100_000)[:, None] * np.ones(3), EITHER, (100_000,) * 2),
    ]  # fmt: skip
    for name, kind, make, expected, elements in arrays:
        format = "npy, points" if "point" in name or "columns" in name else "npy, grid"
        yield _case(format, ".npy", kind, name, lambda make=make: npy(make()), expected, elements)


def _binvox() -> Iterator[Case]:
    full = bytes((1, 27))

    def heads(name: str, kind: str, head: str, expected: str = REFUSED,
              runs: bytes = full, elements: tuple[int, int] = (27, 27)) -> Case:  # fmt: skip
        shown = name if len(name) < 60 else f"{name[:40]}..."
        return _case(
            "binvox", ".binvox", kind, shown, lambda: binvox(head, runs), expected, elements
        )

    for words in ("3 3", "3 3 3 3", "0 3 3", "-3 3 3", "-3 -3 3", "3.5 3 3", "6.9 3 3", "1e0 27 1",
                  "nan 3 3", "inf 3 3", "1e308 3 3", "x 3 3", "", "3_0 3 3", "9" * 5000 + " 3 3",
                  "2147483648 1 1", "4294967296 4294967296 1", "18446744073709551617 27 1",
                    "3e0 3 3",
                  "3.0 3 3", "03 3 3", "+3 3 3"):  # fmt: skip
        loose = words in ("1e0 27 1", "3e0 3 3", "3.0 3 3", "03 3 3", "+3 3 3")
        yield heads(
            f"dim {words}",
            "counts",
            f"dim {words}\ntranslate 0 0 0\nscale 1\n",
            EITHER if loose else REFUSED,
        )
    for words in ("nan 0 0", "inf 0 0", "0 0", "0 0 0 0", "x 0 0", "1e308 0 0", "-1e308 0 0",
                  "1e200 0 0", "1e155 0 0", "1e20 0 0", "1e999 0 0", ""):  # fmt: skip
        yield heads(
            f"translate {words}",
            "numbers",
            f"dim 3 3 3\ntranslate {words}\nscale 1\n",
            EITHER if words in ("1e200 0 0", "1e155 0 0", "1e20 0 0") else REFUSED,
        )
    for word in ("0", "-1", "nan", "inf", "1e300", "1e299", "1e155", "1e100", "1e-300", "1e-107",
                 "5e-324", "x", "1 1", ""):  # fmt: skip
        loose = word[:2] == "1e" and word not in ("1e300", "1e299")
        yield heads(
            f"scale {word}",
            "numbers",
            f"dim 3 3 3\ntranslate 0 0 0\nscale {word}\n",
            EITHER if loose else REFUSED,
        )
    sound = "dim 3 3 3\ntranslate 0 0 0\nscale 1\n"
    yield heads("no dim", "structure", "translate 0 0 0\nscale 1\n")
    yield heads("no scale", "structure", "dim 3 3 3\ntranslate 0 0 0\n", EITHER)
    yield heads("no translate", "structure", "dim 3 3 3\nscale 1\n", EITHER)
    yield heads("dim twice", "structure", sound + "dim 1 27 1\n", EITHER)
    yield heads("an unknown line", "structure", sound + "colour red\n", EITHER)
    yield heads("a line of escapes", "structure", sound + "\x1b]0;owned\x07\n", EITHER)
    yield heads("300,000 lines", "structure", sound + "a\n" * 300_000, EITHER)
    yield heads("blanks for a line", "structure", sound + "\n \n", EITHER)
    for name, runs in (("26 cells", bytes((1, 26))), ("28 cells", bytes((1, 28))), ("no cells",
      b""),
                       ("half of a run", bytes((1, 26, 1))), ("a run of nothing", bytes((1, 0, 1,
                         27))),
                       ("other values", bytes((7, 27))), ("all empty", bytes((0,
                         27)))):  # fmt: skip
        yield heads(name, "counts", sound, EITHER if name in ("a run of nothing", "other values")
                    else REFUSED, runs)  # fmt: skip

    def block(n: int, value: int) -> bytes:
        runs, rest = divmod(n**3, 255)
        return bytes((value, 255)) * runs + (bytes((value, rest)) if rest else b"")

    for n, value in ((60, 1), (180, 1), (200, 1), (400, 0), (1290, 0), (1290, 1)):
        what = "full" if value else "empty"
        yield _case("binvox", ".binvox", "expansion", f"{n}^3 {what} cells",
                    lambda n=n, v=value: binvox(f"dim {n} {n} {n}\ntranslate 0 0 0\nscale 1\n",
                                                block(n, v)),
                    EITHER if value else REFUSED, (n**3, n**3))  # fmt: skip
    corner = binvox(
        "dim 400 400 400\ntranslate 0 0 0\nscale 1\n",
        bytes((1, 1))
        + b"".join(bytes((0, k)) for k in [255] * ((400**3 - 1) // 255) + [(400**3 - 1) % 255]),
    )
    yield _case("binvox", ".binvox", "expansion", "one cell of 400^3", corner, EITHER, (1, 1))


def _nifti() -> Iterator[Case]:
    def changed(name: str, kind: str, expected: str = EITHER, array: np.ndarray | None = None,
                **fields: Any) -> Case:  # fmt: skip
        return _case(
            "nifti",
            ".nii",
            kind,
            name,
            lambda: nifti(ell() if array is None else array, **fields),
            expected,
            (1, 60),
        )

    for dim in (
        [3, 5, 4, 2, 1, 1, 1, 1],
        [3, 5, 4, 4, 1, 1, 1, 1],
        [3, -5, 4, 3, 1, 1, 1, 1],
        [3, 0, 4, 3, 1, 1, 1, 1],
        [0, 5, 4, 3, 1, 1, 1, 1],
        [7, 5, 4, 3, 1, 1, 1, 1],
        [8, 5, 4, 3, 1, 1, 1, 1],
        [-1, 5, 4, 3, 1, 1, 1, 1],
        [3, 32767, 32767, 32767, 1, 1, 1, 1],
        [7] + [32767] * 7,
        [2, 5, 12, 1, 1, 1, 1, 1],
        [4, 5, 4, 3, 0, 1, 1, 1],
        [1, 60, 1, 1, 1, 1, 1, 1],
        [5, 5, 4, 3, 1, -1, 1, 1],
        [32767, 5, 4, 3, 1, 1, 1, 1],
    ):
        yield changed(f"dim {dim}", "counts", dim=dim)
    for code in (
        0,
        1,
        4,
        8,
        16,
        32,
        64,
        128,
        256,
        512,
        768,
        1024,
        1536,
        1792,
        2048,
        2304,
        -1,
        9999,
    ):
        yield changed(f"datatype {code}", "structure", datatype=code)
    for bits in (0, 1, 7, 16, -8, 32767):
        yield changed(f"bitpix {bits}", "structure", bitpix=bits)
    for offset in (0.0, 1.0, 348.0, 353.0, 1e30, -352.0, np.nan, np.inf, -np.inf, 352.5):
        yield changed(f"values at byte {offset:g}", "counts", vox_offset=offset)
    for value in (0.0, np.nan, np.inf, 1e38, -1.0, 1e-45):
        yield changed(f"slope {value:g}", "numbers", slope=value)
        yield changed(f"intercept {value:g}", "numbers", inter=value)
        yield changed(f"sides of {value:g}", "numbers", sform=0, pixdim=[value] * 8)
        yield changed(f"an affine of {value:g}", "numbers", srow=[value] * 12)
        yield changed(
            f"a side of {value:g}", "numbers", srow=[value, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
        )
        yield changed(
            f"a place at {value:g}", "numbers", srow=[1, 0, 0, value, 0, 1, 0, 0, 0, 0, 1, 0]
        )
    for size in (0, 347, 540, 2**31 - 1, -1, 1543569408):
        yield changed(f"a header of {size}", "structure", size=size)
    for magic in (b"n+2\0", b"ni1\0", b"\0\0\0\0", b"\x1b[2J"):
        yield changed(f"magic {magic!r}", "structure", magic=magic)
    for code in (-1, 3, 99, 32767):
        yield changed(f"sform {code}", "structure", sform=code)
        yield changed(f"qform {code}", "structure", qform=code, sform=0)
    yield changed("floats", "structure", array=np.where(ell() > 0, 1.5, 0.0).astype(np.float32))
    yield changed(
        "nan among floats", "numbers", array=np.where(ell() > 0, np.nan, 0.0).astype(np.float32)
    )
    yield changed(
        "noise",
        "structure",
        REFUSED,
        array=np.random.default_rng(1).integers(-30000, 30000, (12, 12, 12)).astype(np.int16),
    )
    data = nifti(np.zeros((400, 400, 400), np.uint8))
    yield _case(
        "nifti, zipped",
        ".nii.gz",
        "expansion",
        "400^3 empty cells",
        lambda: gzip.compress(data, 1, mtime=0),
    )
    yield _case(
        "nifti, zipped",
        ".nii.gz",
        "expansion",
        "a gigabyte of zeros",
        lambda: _zipped_zeros(1 << 30),
    )
    yield _case(
        "nifti, zipped",
        ".nii.gz",
        "expansion",
        "200^3 full cells",
        lambda: gzip.compress(nifti(np.ones((200, 200, 200), np.uint8)), 1, mtime=0),
        EITHER,
        (200**3, 200**3),
    )
    yield _case(
        "nifti, zipped",
        ".nii.gz",
        "expansion",
        "zipped twice",
        lambda: gzip.compress(gzip.compress(nifti(ell()), mtime=0), mtime=0),
    )
    whole = gzip.compress(nifti(ell()), mtime=0)
    yield _case("nifti, zipped", ".nii.gz", "counts", "a wrong sum", lambda: whole[:-8] + bytes(8))
    yield _case(
        "nifti, zipped",
        ".nii.gz",
        "counts",
        "noise behind",
        lambda: whole + b"noise",
        EITHER,
        (N_CELLS, N_CELLS),
    )
    yield _case(
        "nifti, zipped",
        ".nii.gz",
        "counts",
        "two members",
        lambda: (
            gzip.compress(nifti(ell())[:200], mtime=0) + gzip.compress(nifti(ell())[200:], mtime=0)
        ),
        EITHER,
        (N_CELLS, N_CELLS),
    )


def _zipped_zeros(n: int) -> bytes:
    """A member of n zeros, without n bytes of memory."""
    squeeze = zlib.compressobj(9, zlib.DEFLATED, 31)
    block = bytes(1 << 20)
    return b"".join(squeeze.compress(block) for _ in range(n >> 20)) + squeeze.flush()


def _nrrd() -> Iterator[Case]:
    def changed(name: str, kind: str, expected: str = EITHER, body: bytes | None = None,
                **head: str) -> Case:  # fmt: skip
        fields = {key.replace("_", " "): value for key, value in head.items()}
        return _case(
            "nrrd",
            ".nrrd",
            kind,
            name if len(name) < 60 else f"{name[:50]}...",
            lambda: nrrd(ell(), head=fields, body=body),
            expected,
            (1, 60),
        )

    for sizes in ("5 4", "5 4 2", "5 4 4", "-5 4 3", "0 4 3", "5 4 3 1", "5.5 4 3", "x 4 3",
      "nan 4 3",
                  "4294967296 4294967296 4294967296", "9" * 400 + " 1 1", "2147483648 1 1",
                  "-5 -4 3", "5 4 1e0", " "):  # fmt: skip
        yield changed(f"sizes {sizes}", "counts", sizes=sizes)
    for n in ("0", "1", "2", "4", "-1", "3.0", "65", "x", "1000000000", ""):
        yield changed(f"dimension {n}", "counts", dimension=n)
    for kind in ("float", "double", "int64", "uint64", "block", "quad", "", "signed char", "O",
      "object",
                 "|O", "int8", "\x1b[2J"):  # fmt: skip
        yield changed(f"type {kind!r}", "structure", type=kind)
    for encoding in (
        "gzip",
        "bzip2",
        "text",
        "hex",
        "ascii",
        "zip",
        "",
        "\x1b]0;owned\x07",
        "raw ",
    ):
        yield changed(f"encoding {encoding!r}", "structure", encoding=encoding)
    for value in ("0", "nan", "inf", "1e300", "1e-300", "-1", "x", "1e200", "1e155", "1e999"):
        yield changed(
            f"a direction of {value}", "numbers", space_directions=f"({value},0,0) (0,1,0) (0,0,1)"
        )
        yield changed(f"an origin at {value}", "numbers", space_origin=f"({value},0,0)")
        yield changed(
            f"spacings of {value}",
            "numbers",
            space_directions="",
            space="",
            space_origin="",
            spacings=f"{value} 1 1",
        )
    for words in ("none (1,0,0) (0,1,0)", "none none none", "(1,0) (0,1) (0,0)", "(1,0,0)", "((((",
      "()",
                  "(1,0,0) (1,0,0) (0,0,1)", "(1,0,0) (0,1,0) (0,0,1) (1,1,1)", "(" * 20_000,
                  "(1,0,0)" * 5000):  # fmt: skip
        yield changed(f"directions {words}", "structure", space_directions=words)
    for words in ("../../etc/passwd", "/etc/passwd", "/dev/zero", "LIST", "LIST 2\n/etc/passwd",
                  "%d.raw 1 9 1", "%99999999d.raw 1 2 1", "%n%n%n 1 2 1"):  # fmt: skip
        yield changed(f"data file {words}", "references", REFUSED, data_file=words)
        yield changed(f"datafile {words}", "references", REFUSED, datafile=words)
    for skip in ("-1", "1", "5", "1000000000", "-2", "x", "99999999999999999999"):
        yield changed(f"byte skip {skip}", "counts", byte_skip=skip)
        yield changed(f"line skip {skip}", "counts", line_skip=skip)
    for space in ("3", "scanner-xyz", "left-posterior-superior-time", "x" * 100_000, "\u202e", "2"):
        yield changed(f"space {space}", "structure", space=space)
    yield changed("a line of a megabyte", "structure", content="x" * 1_000_000)
    yield changed("a key of escapes", "names", **{"\x1b]0;owned\x07": "1"})
    yield _case(
        "nrrd",
        ".nrrd",
        "structure",
        "300,000 keys",
        lambda: nrrd(ell(), head={f"k{k}": "1" for k in range(300_000)}),
        EITHER,
        (N_CELLS, N_CELLS),
    )
    zeros = {"encoding": "gzip", "sizes": "1024 1024 1024"}
    yield _case(
        "nrrd, zipped",
        ".nrrd",
        "expansion",
        "a gigabyte of zeros",
        lambda: nrrd(ell(), head=zeros, body=_zipped_zeros(1 << 30)),
    )
    yield _case(
        "nrrd, zipped",
        ".nrrd",
        "expansion",
        "a gigabyte for 60 cells",
        lambda: nrrd(ell(), head={"encoding": "gzip"}, body=_zipped_zeros(1 << 30)),
        EITHER,
        (1, 60),
    )
    yield _case(
        "nrrd, zipped", ".nrrd", "counts", "no gzip", lambda: nrrd(ell(), head={"encoding": "gzip"})
    )
    for magic in (b"NRRD0001", b"NRRD0009", b"NRRD", b"nrrd0005", b"NRRD9999999999999999999999"):
        yield _case(
            "nrrd",
            ".nrrd",
            "structure",
            f"magic {magic.decode()}",
            lambda m=magic: nrrd(ell()).replace(b"NRRD0005", m, 1),
            EITHER,
            (1, 60),
        )
