"""Meshes that are strange or impossible, each in every format that can hold it.

Strange ones are sound: surfaces that cross themselves, have one side, meet three at an edge, fall
into ten thousand pieces. Impossible ones have no area, no end or no place.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case
from tests.fuzz.seeds import box, glb, obj, off, ply, ply_binary, scene, stl, stl_binary

Mesh = tuple[Any, Sequence[Sequence[int]]]
_UNIT = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]


@dataclass(frozen=True, kw_only=True)
class Geometry:
    """A mesh with what is known of it; `area` None where nobody knows."""

    kind: str
    name: str
    mesh: Callable[[], Mesh]
    expected: str = SOUND
    elements: tuple[int, int] | None = None
    area: float | None = None
    triangles: bool = True
    single: bool = True
    """Whether numbers of 32 bits, as in STL and GLB, hold the places."""


def moebius(n: int = 48) -> Mesh:
    """A strip with one side."""
    angle = 2 * math.pi * np.arange(n) / n
    half = 0.3 * np.array([np.cos(angle / 2), np.sin(angle / 2)])
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    out = ring * half[0][:, None] + np.array([0, 0, 1.0]) * half[1][:, None]
    vertices = np.concatenate([ring - out, ring + out])
    faces = []
    for k in range(n):
        a, b, c, d = k, k + 1, n + k + 1, n + k
        if k == n - 1:
            b, c = n, 0
        faces += [(a, b, c), (a, c, d)]
    return vertices, faces


def klein(n: int = 24) -> Mesh:
    """A bottle without an inside, which crosses itself."""
    vertices, faces = [], []
    for i in range(n):
        u = 2 * math.pi * i / n
        for j in range(n):
            v = 2 * math.pi * j / n
            r = 2 + math.cos(u / 2) * math.sin(v) - math.sin(u / 2) * math.sin(2 * v)
            z = math.sin(u / 2) * math.sin(v) + math.cos(u / 2) * math.sin(2 * v)
            vertices.append((r * math.cos(u), r * math.sin(u), z))
    for i in range(n):
        for j in range(n):
            a, b = i * n + j, i * n + (j + 1) % n
            if i < n - 1:
                c, d = (i + 1) * n + (j + 1) % n, (i + 1) * n + j
            else:
                c, d = (-(j + 1)) % n, (-j) % n
            faces += [(a, b, c), (a, c, d)]
    return vertices, faces


def fan(n: int) -> Mesh:
    """Leaves of a book: n triangles at one edge."""
    leaves = [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n), 0.5) for k in range(n)]
    return [(0, 0, 0), (0, 0, 1), *leaves], [(0, 1, 2 + k) for k in range(n)]


def pieces(n: int, apart: float = 3.0) -> Mesh:
    """Single triangles in a row."""
    vertices = np.concatenate([_UNIT + apart * k * np.eye(3)[0] for k in range(n)])
    return vertices, np.arange(3 * n).reshape(-1, 3).tolist()


def ring(n: int, radius: Callable[[int], float] = lambda k: 1.0, turns: int = 1) -> Mesh:
    """One polygon of n corners about the origin."""
    corners = [
        (radius(k) * math.cos(2 * math.pi * turns * k / n),
         radius(k) * math.sin(2 * math.pi * turns * k / n), 0.0)
        for k in range(n)
    ]  # fmt: skip
    return corners, [range(n)]


def spiral(n: int) -> Mesh:
    """One polygon that winds 40 times inwards and back again."""
    inward = [(1 + k / n, 80 * math.pi * k / n) for k in range(n // 2)]
    back = [(r + 0.3 / n, a) for r, a in reversed(inward)]
    corners = [(r * math.cos(a), r * math.sin(a), 0.0) for r, a in inward + back]
    return corners, [range(len(corners))]


def scattered(n: int) -> Mesh:
    """One polygon whose corners a generator drew."""
    draw = random.Random(n)
    return [(draw.random(), draw.random(), draw.random()) for _ in range(n)], [range(n)]


def with_box(vertices: Sequence[Any] = (), faces: Sequence[Any] = ()) -> Mesh:
    """The box with more vertices behind its own 24, and more faces behind its own 44."""
    own, triangles = box()
    return [*own.tolist(), *vertices], [*triangles.tolist(), *faces]


def placed(scale: float = 1.0, shift: float = 0.0) -> Mesh:
    vertices, faces = box()
    return vertices * scale + shift, faces.tolist()


def moved(index: int, place: Sequence[float]) -> Mesh:
    """The box with a vertex elsewhere."""
    vertices, faces = with_box()
    vertices[index] = list(place)
    return vertices, faces


def near_chain(n: int) -> Mesh:
    """A strip of triangles so small, beside one that is large, that vertices are joined."""
    far = [(0.0, 0.0, 5.0), (1e3, 0.0, 5.0), (0.0, 1e3, 5.0)]
    chain = [(1e-7 * k, float(k % 2), 0.0) for k in range(n)]
    return far + chain, [(0, 1, 2), *((k, k + 1, k + 2) for k in range(3, n + 1))]


_A, _N = 22.0, (44, 44)
_FAR = [("1e20", 1e20), ("1e100", 1e100), ("1e200", 1e200), ("1e308", 1e308)]
_NO_PLACE = [("nan", math.nan), ("inf", math.inf), ("-inf", -math.inf)]


def geometries() -> Iterator[Geometry]:
    """All of them, the strange first."""
    strange, bad, many = "strange surface", "no surface", "large"
    yield Geometry(kind=strange, name="Moebius strip", mesh=moebius, elements=(96, 96))
    yield Geometry(kind=strange, name="Klein bottle", mesh=klein, elements=(1152, 1152))
    for n in (3, 200, 3000):
        yield Geometry(kind=strange, name=f"{n} leaves at an edge", mesh=lambda n=n: fan(n),
                       elements=(n, n), area=n / 2)  # fmt: skip
    yield Geometry(kind=strange, name="two boxes at a corner", area=44.0, elements=(88, 88),
                   mesh=lambda: with_box(
                       (box()[0] + (3, 2, 1)).tolist(), (box()[1] + 24).tolist()))  # fmt: skip
    yield Geometry(kind=strange, name="one triangle", mesh=lambda: (_UNIT, [(0, 1, 2)]),
                   elements=(1, 1), area=0.5)  # fmt: skip
    yield Geometry(
        kind=strange,
        name="a triangle and its back",
        mesh=lambda: (_UNIT, [(0, 1, 2), (2, 1, 0)]),
        elements=(2, 2),
        area=1.0,
    )
    yield Geometry(
        kind=strange,
        name="half of the faces turned over",
        elements=_N,
        area=_A,
        mesh=lambda: (box()[0], [f[::-1] if k % 2 else f for k, f in enumerate(box()[1].tolist())]),
    )
    yield Geometry(
        kind=strange,
        name="a box in a box",
        elements=(88, 88),
        area=27.5,
        mesh=lambda: with_box((box()[0] / 2 + 0.2).tolist(), (box()[1] + 24).tolist()),
    )
    yield Geometry(
        kind=strange,
        name="a face without area among others",
        elements=(45, 45),
        area=_A,
        mesh=lambda: with_box(faces=[(0, 0, 1)]),
    )
    yield Geometry(
        kind=strange,
        name="a needle among others",
        elements=(45, 45),
        area=_A,
        mesh=lambda: with_box([(0, 0, 0), (3, 0, 0), (1, 1e-15, 0)], [(24, 25, 26)]),
    )
    yield Geometry(
        kind=strange,
        name="vertices of no face",
        elements=_N,
        area=_A,
        mesh=lambda: with_box([(9, 9, 9)] * 1000),
    )
    for name, x in _NO_PLACE:
        yield Geometry(kind="numbers", name=f"{name}, in no face", elements=_N, area=_A,
                       mesh=lambda x=x: with_box([(x, 0, 0)]))  # fmt: skip
        yield Geometry(kind="numbers", name=f"{name}, in a face", expected=REFUSED,
                       mesh=lambda x=x: moved(5, (0, x, 0)))  # fmt: skip
    for name, x in _FAR:
        yield Geometry(
            kind="numbers",
            name=f"a vertex at {name}",
            expected=EITHER,
            elements=_N,
            mesh=lambda x=x: moved(5, (0, x, 0)),
            single=x < 1e38,
        )
        yield Geometry(
            kind="numbers",
            name=f"all at {name}",
            expected=EITHER,
            elements=_N,
            mesh=lambda x=x: placed(1.0, x),
            single=x < 1e38,
        )
        yield Geometry(
            kind="numbers",
            name=f"as large as {name}",
            expected=EITHER,
            elements=_N,
            mesh=lambda x=x: placed(x / 4),
            single=x < 1e38,
        )
    for scale in (1e-3, 1e-12, 1e-30):
        yield Geometry(kind="numbers", name=f"as small as {scale:g}", elements=_N,
                       area=_A * scale**2, mesh=lambda s=scale: placed(s))  # fmt: skip
    for scale in (1e-100, 1e-160, 1e-310, 5e-324):
        yield Geometry(kind="numbers", name=f"as small as {scale:g}", elements=_N, single=False,
                       mesh=lambda s=scale: placed(s), expected=EITHER)  # fmt: skip
    yield Geometry(kind="numbers", name="in the grid of a country", elements=_N, area=_A,
                   mesh=lambda: placed(1.0, 5e6), single=False)  # fmt: skip
    yield Geometry(kind="numbers", name="two triangles 1e12 apart", elements=(2, 2), area=1.0,
                   mesh=lambda: pieces(2, 1e12), single=False)  # fmt: skip
    yield Geometry(kind="numbers", name="zeros below zero", elements=_N, area=_A,
                   mesh=lambda: (box()[0] * -1.0, box()[1].tolist()))  # fmt: skip
    yield Geometry(kind=bad, name="no faces", mesh=lambda: (_UNIT, []), expected=EITHER,
                   elements=(3, 3))  # fmt: skip
    yield Geometry(kind=bad, name="nothing", mesh=lambda: ([], []), expected=REFUSED)
    yield Geometry(kind=bad, name="faces of no vertices", expected=REFUSED,
                   mesh=lambda: ([], [(0, 1, 2)]))  # fmt: skip
    yield Geometry(
        kind=bad,
        name="all in a line",
        expected=REFUSED,
        mesh=lambda: ([(k, 2 * k, 3 * k) for k in range(9)], [(k, k + 1, k + 2) for k in range(7)]),
    )
    yield Geometry(
        kind=bad,
        name="all in one place",
        expected=REFUSED,
        mesh=lambda: ([(1, 2, 3)] * 24, box()[1].tolist()),
    )
    yield Geometry(kind=bad, name="each face names one vertex", expected=REFUSED,
                   mesh=lambda: (box()[0], [(k, k, k) for k in range(24)]))  # fmt: skip
    for name, index in (("one too large", 24), ("2^31", 2**31), ("2^32 - 1", 2**32 - 1)):
        yield Geometry(kind="references", name=f"a vertex number {name}", expected=REFUSED,
                       mesh=lambda i=index: with_box(faces=[(0, 1, i)]))  # fmt: skip
    yield Geometry(kind=many, name="10,000 pieces", mesh=lambda: pieces(10_000), area=5000.0,
                   elements=(10_000, 10_000))  # fmt: skip
    yield Geometry(kind=many, name="one face 20,000 times", expected=EITHER,
                   mesh=lambda: (_UNIT, [(0, 1, 2)] * 20_000), elements=(20_000,) * 2,
                   area=10_000.0)  # fmt: skip
    yield Geometry(
        kind=many,
        name="100,000 vertices of no face",
        elements=_N,
        area=_A,
        mesh=lambda: with_box([(1, 1, 1)] * 100_000),
    )
    yield Geometry(
        kind=many,
        name="a chain of near vertices",
        expected=EITHER,
        mesh=lambda: near_chain(5000),
        elements=(4999, 4999),
    )
    yield from _polygons()


def _polygons() -> Iterator[Geometry]:
    """Faces of many corners, which only some formats have."""
    known: list[tuple[str, Callable[[], Mesh], str]] = [
        ("100 corners", lambda: ring(100), SOUND),
        ("a star", lambda: ring(400, lambda k: 1.0 + k % 2), SOUND),
        ("a comb", lambda: ring(2000, lambda k: 1.0 + 5.0 * (k % 2)), EITHER),
        ("20,000 convex corners", lambda: ring(20_000), EITHER),
        ("2,000 random corners", lambda: scattered(2000), EITHER),
        ("5,000 random corners", lambda: scattered(5000), EITHER),
        ("15,000 repeated corners", lambda: (_UNIT, [[0, 1, 2] * 5000]), EITHER),
        ("a spiral of 30,000 corners", lambda: spiral(30_000), EITHER),
        ("a star that crosses itself", lambda: ring(101, turns=50), EITHER),
        ("all corners in one place", lambda: ([(0, 0, 0)] * 500, [range(500)]), REFUSED),
        ("all corners in a line", lambda: ([(k, k, k) for k in range(500)], [range(500)]), REFUSED),
        ("300,000 corners", lambda: ring(300_000), EITHER),
        ("a bow tie", lambda: ([(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)], [range(4)]), EITHER),
        ("out of its plane", lambda: (
            [(math.cos(k), math.sin(k), math.cos(3 * k)) for k in range(6)], [range(6)]), SOUND),
        ("500 of 300 random corners", lambda: (
            scattered(300)[0], [range(300)] * 500), EITHER),
    ]  # fmt: skip
    for name, mesh, expected in known:
        n = 500 if name.startswith("500") else 1
        yield Geometry(kind="many corners", name=name, mesh=mesh, expected=expected,
                       triangles=False, elements=(n, n))  # fmt: skip
    for sizes, expected in (((0,), EITHER), ((1,), EITHER), ((2,), EITHER), ((0, 1, 2), EITHER)):
        yield Geometry(kind="many corners", name=f"too few: {sizes}", triangles=False,
                       expected=expected, elements=_N, area=_A,
                       mesh=lambda s=sizes: with_box(faces=[range(n) for n in s]))  # fmt: skip


def _quantised(vertices: Any, faces: Any) -> tuple[np.ndarray, Any]:
    return np.asarray(vertices, np.float64).reshape(-1, 3), faces


def _scene(vertices: Any, faces: Any) -> bytes:
    points, _ = _quantised(vertices, faces)
    return glb(*scene(points, np.asarray(faces, np.uint32).reshape(-1, 3)))


def _stl_binary(vertices: Any, faces: Any) -> bytes:
    points, _ = _quantised(vertices, faces)
    return stl_binary(points, np.asarray(faces, np.int64).reshape(-1, 3))


#: Writers, whether they hold polygons, whether places are doubles.
_WRITERS: tuple[tuple[str, str, Callable[[Any, Any], bytes], bool, bool], ...] = (
    ("off", ".off", off, True, True),
    ("obj", ".obj", obj, True, True),
    ("ply, text", ".ply", ply, True, True),
    ("ply, binary", ".ply", ply_binary, True, True),
    ("stl, text", ".stl", stl, False, True),
    ("stl, binary", ".stl", _stl_binary, False, False),
    ("glb", ".glb", _scene, False, False),
)


def polygon_cases() -> Iterator[Case]:
    """Each geometry in each format that can hold it."""
    for found in geometries():
        for format, suffix, write, polygons, double in _WRITERS:
            if (not found.triangles and not polygons) or (not found.single and not double):
                continue
            if format.startswith("stl") and found.kind == "references":
                continue  # an STL file has no numbers of vertices
            if format == "ply, binary" and not _fits_bytes(found):
                continue
            if format.startswith("stl") and found.name == "faces of no vertices":
                continue
            expected, elements = found.expected, found.elements or (1, 1 << 62)
            if found.name == "2^32 - 1" or (format == "glb" and "2^32" in found.name):
                expected = REFUSED
            yield Case(
                format=format,
                kind=found.kind,
                name=found.name,
                suffix=suffix,
                make=lambda write=write, found=found: _written(write, found),
                expected=expected,
                elements=elements,
                area=found.area,
            )


def _fits_bytes(found: Geometry) -> bool:
    """Whether lengths of lists are below 256 and numbers of vertices of 32 bits."""
    return (found.kind != "many corners" or found.name.startswith(("100 ", "too", "a bow", "out"))
            ) and "2^3" not in found.name  # fmt: skip


def _written(write: Callable[[Any, Any], bytes], found: Geometry) -> bytes:
    vertices, faces = found.mesh()
    with np.errstate(over="ignore", invalid="ignore"):
        return write(
            vertices.tolist() if isinstance(vertices, np.ndarray) else vertices,
            [list(face) for face in faces],
        )
