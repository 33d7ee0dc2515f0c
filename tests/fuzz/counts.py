"""Meshes whose numbers do not add up: counts, lengths of lists, numbers of vertices, words.

One for each way that a count can lie, in OFF, PLY, OBJ and STL files.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator

import numpy as np

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case, Made, constant
from tests.fuzz.seeds import box, obj, off, ply, ply_binary, ply_header, rows, stl, stl_binary

WRONG_COUNTS = (
    *("0", "-1", "-44", "1e1", "44.0", "4x4", "0x2c", "nan", "inf", "x", "", "'44'", "+44", "044"),
    *("2147483647", "2147483648", "4294967295", "4294967296", "4294967340", "9223372036854775807"),
    *("9223372036854775808", "18446744073709551615", "18446744073709551616", "1" + "0" * 400),
    *("9" * 5000, "\u0664\u0664", "4_4", "\u00b2"),
)
"""What may stand where the number of faces, 44, should."""
_ALLOWED = {"+44", "044"}


def count_cases() -> Iterator[Case]:
    yield from _off()
    yield from _ply()
    yield from _obj()
    yield from _stl()


def _case(format: str, suffix: str, kind: str, name: str, made: Made | Callable[[], Made],
          expected: str = REFUSED, elements: tuple[int, int] = (44, 44)) -> Case:  # fmt: skip
    make = made if callable(made) else constant(made)
    return Case(format=format, suffix=suffix, kind=kind, name=name, make=make, expected=expected,
                elements=elements)  # fmt: skip


def _shown(word: str) -> str:
    return repr(word) if len(word) < 30 else f"{word[:4]}... of {len(word)} digits"


def _off() -> Iterator[Case]:
    vertices, faces = box()
    listed = rows([(3, *face) for face in faces])
    said = [
        (f"{n} vertices and {m} faces", f"{n} {m} 0", REFUSED)
        for n, m in ((23, 44), (25, 44), (24, 43), (24, 45), (68, 0), (0, 68))
    ]
    said += [(f"{_shown(w)} faces", f"24 {w} 0", EITHER if w in _ALLOWED else REFUSED)
             for w in WRONG_COUNTS]  # fmt: skip
    said += [(f"{_shown(w)} vertices", f"{w} 44 0", REFUSED) for w in WRONG_COUNTS]
    said += [(f"{_shown(w)} edges", f"24 44 {w}", EITHER) for w in WRONG_COUNTS]
    said += [("one count", "24", REFUSED), ("four counts", "24 44 0 0", REFUSED)]
    for name, counts, expected in said:
        yield _case(
            "off",
            ".off",
            "counts",
            name,
            lambda counts=counts: off(vertices, faces, counts=counts),
            expected,
        )
    for word in WRONG_COUNTS:
        yield _case(
            "off",
            ".off",
            "counts",
            f"a face of {_shown(word)} corners",
            lambda w=word: f"OFF\n24 45 0\n{rows(vertices)}{listed}{w} 0 1 2\n".encode(),
        )
        yield _case(
            "off",
            ".off",
            "references",
            f"a vertex number {_shown(word)}",
            lambda w=word: f"OFF\n24 45 0\n{rows(vertices)}{listed}3 1 2 {w}\n".encode(),
            EITHER,
            (45, 45),
        )
        yield _case(
            "off",
            ".off",
            "numbers",
            f"the coordinate {_shown(word)}",
            lambda w=word: (
                f"OFF\n25 44 0\n{rows(vertices)}1 2 {w}\n{rows([(3, *f) for f in faces])}".encode()
            ),
            EITHER,
        )
    for name, head in (("4OFF", b"4OFF"), ("nOFF", b"nOFF\n3"), ("OFF BINARY", b"OFF BINARY"),
                       ("no keyword", b""), ("another keyword", b"OOF"), ("STCN4nOFF",
                         b"STCN4nOFF"),
                       ("a keyword of a megabyte", b"O" * 1_000_000)):  # fmt: skip
        yield _case(
            "off",
            ".off",
            "structure",
            name,
            lambda head=head: off(vertices, faces).replace(b"OFF", head, 1),
            SOUND if head == b"" else REFUSED,
        )
    yield _case("off", ".off", "structure", "nothing but comments", b"# a\n" * 100_000)


def _ply() -> Iterator[Case]:
    vertices, faces = box()
    body = (rows(vertices) + rows([(3, *f) for f in faces])).encode()
    for what, of in (
        ("vertices", lambda w: ply_header(w, 44)),
        ("faces", lambda w: ply_header(24, w)),
    ):
        for word in (*WRONG_COUNTS, *(("23", "25") if what == "vertices" else ("43", "45"))):
            expected = EITHER if word in _ALLOWED else REFUSED
            yield _case(
                "ply, text",
                ".ply",
                "counts",
                f"{_shown(word)} {what}",
                lambda of=of, w=word: of(w) + body,
                expected,
            )
            yield _case(
                "ply, binary", ".ply", "counts", f"{_shown(word)} {what}",
                lambda of=of, w=word: of(w).replace(b"ascii", b"binary_little_endian").replace(
                    b"float", b"double") + ply_binary(*box()).partition(b"end_header\n")[2],
                expected)  # fmt: skip
    for word in WRONG_COUNTS:
        head = ply_header(24, 45)
        yield _case(
            "ply, text",
            ".ply",
            "counts",
            f"a list of {_shown(word)}",
            lambda w=word, head=head: head + body + f"{w} 0 1 2\n".encode(),
        )
        yield _case(
            "ply, text",
            ".ply",
            "references",
            f"a vertex number {_shown(word)}",
            lambda w=word, head=head: head + body + f"3 1 2 {w}\n".encode(),
            EITHER,
            (45,) * 2,
        )
    for name, length, corner in (("char", "b", "i"), ("int", "i", "i"), ("uint", "I", "i"),
                                 ("short", "h", "i"), ("int64", "q", "i"), ("uint64", "Q", "i"),
                                 ("uchar", "B", "q"), ("uchar", "B", "Q")):  # fmt: skip
        kinds = {"i": "int", "q": "int64", "Q": "uint64"}
        low, high = np.iinfo(length).min, np.iinfo(length).max
        for value in dict.fromkeys((3, low, high, -1 if low else 0, 2)):
            for index in (2, np.iinfo(corner).min, np.iinfo(corner).max):
                head = ply_header(24, 1, format="binary_little_endian", number="double")
                head = head.replace(b"uchar int", f"{name} {kinds[corner]}".encode())
                data = head + np.asarray(vertices, "<f8").tobytes() + struct.pack(
                    f"<{length}3{corner}", value, 0, 1, index)  # fmt: skip
                yield _case(
                    "ply, binary",
                    ".ply",
                    "counts",
                    f"{name} {value} of {kinds[corner]}, the last {index}",
                    data,
                    SOUND if (value, index) == (3, 2) else EITHER,
                    (1, 24),
                )
    yield from _ply_headers(body)


def _ply_headers(body: bytes) -> Iterator[Case]:
    vertices = box()[0]
    sound = ply(*box())
    kind = "structure"

    def changed(name: str, old: bytes, new: bytes, expected: str = EITHER) -> Case:
        return _case("ply, text", ".ply", kind, name, lambda: sound.replace(old, new, 1), expected,
                     (24, 44))  # fmt: skip

    xyz, end = b"property double z\n", b"end_header\n"
    yield changed("no format", b"format ascii 1.0\n", b"", REFUSED)
    yield changed("an unknown format", b"ascii", b"morse", REFUSED)
    yield changed("two formats", b"format ascii 1.0\n", b"format ascii 1.0\n" * 2)
    yield changed("no x", b"property double x\n", b"", REFUSED)
    yield changed("x twice", b"property double x\n", b"property double x\n" * 2, REFUSED)
    yield changed("vertices twice", b"element face", b"element vertex", REFUSED)
    yield changed("an unknown type", b"double", b"quad", REFUSED)
    yield changed("a list of floats", b"uchar int", b"uchar float", EITHER)
    yield changed("lengths that are floats", b"uchar int", b"float int", REFUSED)
    yield changed("a list of a list", b"list uchar int", b"list list uchar int", REFUSED)
    yield changed("no end", end, b"", REFUSED)
    yield changed("a property of nothing", b"element vertex", b"property int a\nelement vertex",
                  REFUSED)  # fmt: skip
    yield changed("an element without a name", b"element face 44", b"element 44", REFUSED)
    yield changed("an empty element of 2^40 rows", end, b"element nothing 1099511627776\n" + end)
    yield changed(
        "an empty element of 10^17 rows", end, b"element nothing " + b"9" * 17 + b"\n" + end
    )
    yield changed(
        "strips of triangles", end, b"element tristrips 0\nproperty list int int v\n" + end
    )
    for n in (20_000, 50_000):
        many = b"".join(b"property int p%d\n" % k for k in range(n))
        yield changed(f"{n} properties of vertices", xyz, xyz + many)
        yield changed(f"{n} properties of faces", end, many + end)
        elements = b"".join(b"element e%d 0\nproperty int a\n" % k for k in range(n))
        yield changed(f"{n} elements without rows", end, elements + end)
    yield changed("300,000 comments", end, b"comment a\n" * 300_000 + end)
    yield changed("a name of 100,000 characters", b"element face", b"element " + b"f" * 100_000
                  + b" 0\nelement face")  # fmt: skip
    yield changed(
        "a name of escapes",
        b"element face 44",
        b"element \x1b]0;a\x07 1\nproperty int \x1b[2J\nelement face 44",
        REFUSED,
    )
    yield changed(
        "an element of 10^6 empty lists",
        end,
        b"element e 1000000\nproperty list uchar int v\n" + end,
        REFUSED,
    )
    head = ply_header(24, None, format="binary_little_endian", number="double")
    points = np.asarray(vertices, "<f8").tobytes()
    yield _case(
        "ply, binary",
        ".ply",
        "expansion",
        "2^40 rows of nothing behind the points",
        head.replace(end, b"element n 1099511627776\n" + end) + points,
        EITHER,
        (24, 24),
    )
    many = b"".join(b"property list uchar int p%d\n" % k for k in range(20_000))
    yield _case("ply, binary", ".ply", "expansion", "20,000 empty lists in a row",
                head.replace(end, b"element n 50\n" + many + end) + points + bytes(50 * 20_000),
                EITHER, (24, 24))  # fmt: skip
    yield _case("ply, binary", ".ply", "expansion", "a million empty lists",
                head.replace(end, b"element n 1000000\nproperty list uchar int p\n" + end) + points
                + bytes(1_000_000), EITHER, (24, 24))  # fmt: skip
    lengths = bytes(k % 2 for k in range(300_000))
    uneven = b"".join(bytes((n,)) + bytes(n) for n in lengths)
    yield _case("ply, binary", ".ply", "expansion", "300,000 lists of uneven lengths",
                head.replace(end, b"element n 300000\nproperty list uchar uchar p\n" + end) + points
                + uneven, EITHER, (24, 24))  # fmt: skip
    del body


def _obj() -> Iterator[Case]:
    sound = obj(*box())

    def added(kind: str, name: str, lines: bytes, expected: str = EITHER, n: int = 45) -> Case:
        return _case("obj", ".obj", kind, name, lambda: sound + lines + b"\n", expected, (44, n))

    words = (*WRONG_COUNTS, "0", "25", "-25", "-24", "1/", "1//", "/1", "1/2/3/4", "1/x", "1/99",
             "1//99", "1/-99/-99", "1\\", "\u0661")  # fmt: skip
    for word in dict.fromkeys(words):
        yield added("references", f"the corner {_shown(word)}", f"f 1 2 {word}".encode())
    for name, lines in (
        ("a face without corners", b"f"), ("a face of one corner", b"f 1"),
        ("a face of two corners", b"f 1 2"), ("a vertex of one number", b"v 1"),
        ("a vertex of 7 numbers", b"v 1 2 3 1 0 0 0"), ("a vertex of words", b"v a b c"),
        ("a vertex without numbers", b"v"), ("texture of no numbers", b"vt"),
        ("a normal of words", b"vn a b c"), ("a normal that is no number", b"vn nan nan nan"),
        ("a call of another file", b"call ../../../etc/passwd"), ("a command", b"csh rm -rf /"),
        ("materials out of the folder", b"mtllib ../../../../etc/passwd"),
        ("materials that never end", b"mtllib /dev/zero"),
        ("a trace object", b"trace_obj /etc/passwd\nshadow_obj /dev/zero"),
        ("a material of escapes", b"usemtl \x1b]0;owned\x07\nf 1 2 3"),
        ("a group of 100,000 characters", b"g " + b"g" * 100_000 + b"\nf 1 2 3"),
        ("100,000 groups", b"".join(b"g g%d\n" % k for k in range(100_000))),
        ("100,000 materials", b"".join(b"usemtl m%d\nf 1 2 3\n" % k for k in range(30_000))),
        ("300,000 unknown statements", b"".join(b"word%d 1\n" % k for k in range(300_000))),
        ("an unknown statement of a megabyte", b"w" * 1_000_000),
        ("lines joined 300,000 times", b"v 1 2 3 " + b"\\\n" * 300_000),
        ("a line joined to no other", b"f 1 2 3 \\"),
        ("a surface that is curved", b"cstype bezier\ndeg 3 3\nsurf 0 1 0 1 1 2 3"),
        ("a weight of zero", b"v 1 2 3 0"),
    ):  # fmt: skip
        yield added("structure", name, lines, EITHER, 30_045)
    yield _case(
        "obj",
        ".obj",
        "structure",
        "corners before their vertices",
        b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
        EITHER,
        (1, 1),
    )


def _stl() -> Iterator[Case]:
    vertices, faces = box()
    for count in (0, 1, 43, 45, 2**16, 2**31, 2**32 - 1):
        yield _case(
            "stl, binary",
            ".stl",
            "counts",
            f"{count} triangles",
            lambda n=count: stl_binary(vertices, faces, count=n),
        )
    binary = stl_binary(vertices, faces)
    yield _case(
        "stl, binary",
        ".stl",
        "structure",
        "begins with 'solid'",
        lambda: b"solid box".ljust(80) + binary[80:],
        SOUND,
    )
    yield _case(
        "stl, binary",
        ".stl",
        "structure",
        "a header of escapes",
        lambda: (b"\x1b]0;owned\x07" * 10)[:80] + binary[80:],
        SOUND,
    )
    for over in (1, 2, 49, 50, 51, 512, 5000):
        yield _case(
            "stl, binary",
            ".stl",
            "counts",
            f"{over} bytes of noise behind",
            lambda n=over: binary + bytes(1 + k % 255 for k in range(n)),
            EITHER,
        )
        yield _case(
            "stl, binary",
            ".stl",
            "counts",
            f"{over} zeros behind",
            lambda n=over: binary + bytes(n),
            EITHER,
        )
    for name, value in (("nan", np.nan), ("inf", np.inf), ("3e38", 3e38), ("1e-45", 1e-45)):
        yield _case("stl, binary", ".stl", "numbers", f"normals of {name}",
          lambda v=value: b"".join(
            [binary[:84], *(struct.pack("<3f", v, v, v) + binary[k + 12:k + 50]
                            for k in range(84, len(binary), 50))]), SOUND)  # fmt: skip
    text = stl(vertices, faces)
    for name, old, new in (
        ("no end of the solid", b"endsolid box\n", b""), ("a solid in a solid", b"facet",
          b"solid a\nfacet"),
        ("a facet of four corners", b"endloop", b"vertex 0 0 0\nendloop"),
        ("a facet of two corners", b"vertex 0 0 0\n", b""), ("no loop", b"outer loop\n", b""),
        ("a word for a number", b"vertex 0", b"vertex zero"),
        ("a name of escapes", b"solid box", b"solid \x1b]0;owned\x07"),
        ("a name of 1,000,000 characters", b"solid box", b"solid " + b"x" * 1_000_000),
        ("nothing in it", text[text.index(b"facet"):text.index(b"endsolid")], b""),
        ("text behind the end", b"endsolid box\n", b"endsolid box\nhello\n"),
        ("a normal of words", b"normal 0 0 0", b"normal a b c"),
    ):  # fmt: skip
        yield _case(
            "stl, text",
            ".stl",
            "structure",
            name,
            lambda old=old, new=new: text.replace(old, new, 1),
            EITHER,
        )
    yield _case(
        "stl, text", ".stl", "structure", "100,000 empty solids", b"solid a\nendsolid a\n" * 100_000
    )
