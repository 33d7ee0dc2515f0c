"""Point clouds as text that do not add up: columns, counts, separators, numbers, places."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case
from tests.fuzz.seeds import box, ply_header, rows


def _points() -> list[list[str]]:
    return [[repr(float(x)) for x in row] for row in box()[0]]


def _table(header: str, more: Callable[[int], str] = lambda k: "", between: str = ",") -> bytes:
    """A line for each corner of the box, with cells behind it."""
    lines = [between.join(row) + more(k) for k, row in enumerate(_points())]
    return "\n".join([*([header] if header else []), *lines, ""]).encode()


def cloud_cases() -> Iterator[Case]:
    yield from _columns()
    yield from _rows()
    yield from _numbers()


def _case(suffix: str, kind: str, name: str, make: Callable[[], bytes], expected: str = EITHER,
          elements: tuple[int, int] = (24, 24)) -> Case:  # fmt: skip
    format = {".xyz": "points, xyz", ".csv": "points, csv", ".pts": "points, pts"}[suffix]
    return Case(format=format, suffix=suffix, kind=kind, name=name, make=make, expected=expected,
                elements=elements)  # fmt: skip


def _columns() -> Iterator[Case]:
    headers: list[tuple[str, str, Callable[[int], str], str]] = [
        ("x twice", "x,y,z,x", lambda k: ",9", REFUSED),
        ("x twice under other names", "x,y,z,px", lambda k: ",9", EITHER),
        ("an area twice", "x,y,z,area,area", lambda k: ",1,2", REFUSED),
        ("no z", "x,y,w", lambda k: "", REFUSED),
        ("nothing but commas", ",,", lambda k: "", EITHER),
        ("two names", "x,y", lambda k: "", REFUSED),
        ("four names", "x,y,z,a", lambda k: "", REFUSED),
        ("quoted names", '"x","y","z"', lambda k: "", SOUND),
        ("names with units", "x [mm],y [mm],z [mm]", lambda k: "", SOUND),
        ("names of escapes", "x,y,z,\x1b]0;owned\x07", lambda k: ",1", EITHER),
        ("names of marks", "x,y,z,\u202egnp", lambda k: ",1", EITHER),
        ("a name of 100,000 characters", "x,y,z," + "w" * 100_000, lambda k: ",1", EITHER),
        ("20,000 columns", "x,y,z" + "".join(f",c{k}" for k in range(20_000)),
         lambda k: ",1" * 20_000, EITHER),
        ("20,000 columns called the same", "x,y,z" + ",c" * 20_000, lambda k: ",1" * 20_000,
          EITHER),
        ("a name that is a formula", "x,y,z,=cmd|' /C calc'!A0", lambda k: ",1", EITHER),
        ("areas of words", "x,y,z,area", lambda k: ",large", REFUSED),
        ("areas below 0", "x,y,z,area", lambda k: ",-1", REFUSED),
        ("areas of nan", "x,y,z,area", lambda k: ",nan", REFUSED),
        ("areas of inf", "x,y,z,area", lambda k: ",inf", REFUSED),
        ("areas of 0", "x,y,z,area", lambda k: ",0", REFUSED),
        ("areas of 1e308", "x,y,z,area", lambda k: ",1e308", REFUSED),
        ("areas of 1e-320", "x,y,z,area", lambda k: ",1e-320", EITHER),
        ("an area of 1e300", "x,y,z,area", lambda k: ",1e300" if k == 3 else ",1", EITHER),
        ("normals of 0", "x,y,z,nx,ny,nz", lambda k: ",0,0,0", EITHER),
        ("normals of nan", "x,y,z,nx,ny,nz", lambda k: ",nan,nan,nan", EITHER),
        ("normals of 1e308", "x,y,z,nx,ny,nz", lambda k: ",1e308,1e308,1e308", EITHER),
        ("normals of 1e-320", "x,y,z,nx,ny,nz", lambda k: ",1e-320,0,0", EITHER),
        ("two of three normals", "x,y,z,nx,ny", lambda k: ",0,1", EITHER),
    ]  # fmt: skip
    for name, header, more, expected in headers:
        yield _case(".csv", "structure", name, lambda h=header, m=more: _table(h, m), expected)


def _rows() -> Iterator[Case]:
    plain = _table("", between=" ")
    known: list[tuple[str, str, str, Callable[[], bytes], str]] = [
        (".xyz", "structure", "a row of two", lambda: plain + b"1 2\n", REFUSED),
        (".xyz", "structure", "a row of four", lambda: plain + b"1 2 3 4\n", REFUSED),
        (".xyz", "structure", "a row of words", lambda: plain + b"a b c\n", REFUSED),
        (".xyz", "structure", "one column", lambda: b"1\n2\n3\n4\n", REFUSED),
        (".xyz", "structure", "comments alone", lambda: b"# a\n" * 1000, REFUSED),
        (".xyz", "structure", "a header alone", lambda: b"x y z\n", REFUSED),
        (".csv", "structure", "a header alone", lambda: b"x,y,z\n", REFUSED),
        (".csv", "structure", "decimal commas", lambda: plain.replace(b".", b",").replace(b" ",
          b";"),
         SOUND),
        (".csv", "structure", "separators of two kinds", lambda: plain.replace(b" ", b",", 20),
          EITHER),
        (".csv", "structure", "a quote that does not end", lambda: b'"x,y,z\n' + _table(""),
          EITHER),
        (".csv", "structure", "lines within quotes", lambda: b'x,y,z,"a\nb"\n' + _table("",
          lambda k: ",1"),
         EITHER),
        (".csv", "structure", "300,000 commas in a row",
          lambda: _table("x,y,z") + b"," * 300_000 + b"\n",
         REFUSED),
        (".csv", "structure", "a cell of 1,000,000 characters", lambda: _table(
            "x,y,z,a", lambda k: ",1") + b"1,2,3," + b"w" * 1_000_000 + b"\n", EITHER),
        *((".pts", "counts", f"announces {n}", lambda n=n: f"{n}\n".encode() + plain,
           REFUSED) for n in ("0", "1", "23", "25", "2147483648", "18446744073709551616",
             "9" * 5000)),
        *((".pts", "counts", f"announces {n!r}", lambda n=n: f"{n}\n".encode() + plain,
           EITHER) for n in ("-24", "24.0", "2_4", "\u0662\u0664", "x", "+24", "1e1")),
        (".pts", "counts", "a thousand empty lists", lambda: b"0\n" * 1000 + b"24\n" + plain,
          EITHER),
        (".pts", "counts", "a hundred lists", lambda: (b"24\n" + plain) * 100, EITHER),
    ]  # fmt: skip
    for suffix, kind, name, make, expected in known:
        n = 26 if expected == EITHER else 24
        most = 2400 if name == "a hundred lists" else n
        yield _case(suffix, kind, name, make, expected, (24, most))


def _numbers() -> Iterator[Case]:
    plain = _table("", between=" ")
    for word, expected in (
        ("nan", EITHER), ("inf", EITHER), ("-inf", EITHER), ("1e999", EITHER), ("1e308", EITHER),
        ("1e200", EITHER), ("1e155", EITHER), ("1e20", EITHER), ("1e-320", SOUND), ("0x10",
          REFUSED),
        ("1_000", REFUSED), ("1e", REFUSED), ("--1", REFUSED), ("1.2.3", REFUSED), ("1,5", EITHER),
        ("\u0661", EITHER), ("1.#QNAN", EITHER), ("9" * 400, EITHER), ("9" * 1_000_000, EITHER),
        ("0." + "0" * 1_000_000 + "1", SOUND), ("1" + "0" * 300, EITHER), ("NA", EITHER), ("null",
          EITHER),
        ("infinity", EITHER), ("\u221e", REFUSED), ("\u22121", REFUSED), ("1\u00a02", EITHER),
    ):  # fmt: skip
        shown = word if len(word) < 20 else f"of {len(word)} characters"
        for suffix in (".xyz", ".csv"):
            between = " " if suffix == ".xyz" else ","
            yield _case(
                suffix,
                "numbers",
                f"the coordinate {shown}",
                lambda w=word, b=between: (
                    plain.replace(b" ", b.encode()) + b.join(("1", "2", w)).encode() + b"\n"
                ),
                expected,
                (25, 25),
            )
    places: list[tuple[str, list[list[float]]]] = [
        ("one point", [[1, 2, 3]]), ("two points", [[0, 0, 0], [1, 1, 1]]),
        ("three points in a line", [[k, k, k] for k in range(3)]),
        ("1,000 points in a line", [[k, 2 * k, 0] for k in range(1000)]),
        ("1,000 points in one place", [[1, 2, 3]] * 1000),
        ("all but one in one place", [[1, 2, 3]] * 1000 + [[4, 5, 6]]),
        ("300,000 points in one place", [[1, 2, 3]] * 300_000),
        ("100,000 points in ten places", [[k % 10, k % 3, k % 7] for k in range(100_000)]),
        ("points of nan", [[float("nan")] * 3] * 30),
        ("all points of a cube's grid", [[i, j, k] for i in range(20) for j in range(20)
                                         for k in range(20)]),
    ]  # fmt: skip
    for name, points in places:
        n = len(points)
        kind = "large" if n > 10_000 else "no surface"
        expected = REFUSED if "nan" in name else EITHER
        yield _case(".xyz", kind, name, lambda p=points: rows(p).encode(), expected, (n, n))
        yield Case(
            format="ply, points",
            suffix=".ply",
            kind=kind,
            name=name,
            expected=expected,
            elements=(n, n),
            make=lambda p=points: ply_header(len(p), None) + rows(p).encode(),
        )
