"""An even triangle mesh on the zero level set of a field.

Marching cubes gives the right topology and bad triangles: their corners sit where the surface
happens to cross the grid. So the mesh is then remade in rounds, after Botsch and Kobbelt ("A
remeshing approach to multiresolution modeling", 2004): split long edges, collapse short ones,
flip edges, slide each vertex towards the middle of its neighbours, and put it back on the
surface with Newton steps. Every operation keeps a closed manifold closed and manifold.

A solid that is its own mirror image in the plane z = 0 gets a mesh that is, exactly: the half at
negative z is meshed alone, up to a rim of vertices that stay in the plane, and then doubled. While
it is remade, a *ghost* vertex, joined to the whole rim, closes the half. So the operations find two
faces at each edge there too, and need only leave alone what touches the ghost.

All loops run in a fixed order, so that the result depends on the input alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from skimage.measure import marching_cubes

from samples.fields import Field, FloatArray, dot, gradient, normalized

IntArray: TypeAlias = npt.NDArray[np.int64]
Point: TypeAlias = tuple[float, float, float]
Triangle: TypeAlias = tuple[int, int, int]


def mesh_level_set(
    field: Field,
    size: Field,
    low: FloatArray,
    high: FloatArray,
    *,
    grid: float,
    rounds: int = 14,
    symmetric: bool = False,
) -> tuple[FloatArray, IntArray]:
    """Triangulate ``field == 0`` with edges of a given length.

    Parameters
    ----------
    field : Field
        Negative inside.
    size : Field
        The length that edges should have at a point.
    low, high : (3,) float
        A box around the surface, with room to spare.
    grid : float
        Spacing of the marching cubes; below the thickness of all details.
    rounds : int
        Rounds of remeshing. The second half turns edges by their angles and no longer by the
        number of neighbours; a few more rounds at the end only turn and slide.
    symmetric : bool
        The field is the same at z and -z, and the mesh is to be its own mirror image. The second
        half of the faces is the image of the first, in the same order.

    Returns
    -------
    vertices : (V, 3) float
    faces : (F, 3) int
        Counter-clockwise when seen from outside.
    """
    axes = [np.arange(a, b + grid, grid) for a, b in zip(low, high, strict=True)]
    if symmetric:
        axes[2] = grid * np.arange(np.floor(low[2] / grid), 1.0)
    vertices, faces = _march(field, axes, grid)
    for number in range(rounds + 4):
        surface = _Surface(vertices, faces, size(vertices))
        if number < rounds:
            surface.split(4.0 / 3.0)
            surface.collapse(0.8, 4.0 / 3.0)
        surface.flip(by_angle=number >= rounds // 2)
        vertices, faces = surface.arrays()
        for _ in range(3):
            vertices = _project(field, _slide(vertices, faces), 0.25 * grid)
    for _ in range(3):
        vertices = _project(field, vertices, 0.25 * grid)
    return _doubled(vertices, faces) if symmetric else (vertices, faces)


def _march(field: Field, axes: list[FloatArray], grid: float) -> tuple[FloatArray, IntArray]:
    """Marching cubes on a regular grid, with faces that look outwards; open where the grid ends."""
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = field(nodes.reshape(-1, 3)).reshape(nodes.shape[:3])
    points, faces, _, _ = marching_cubes(values, 0.0, allow_degenerate=False)  # type: ignore[no-untyped-call]
    points = np.asarray(points, dtype=np.float64) * grid + np.array([axis[0] for axis in axes])
    faces = np.asarray(faces, dtype=np.int64)
    a, b, c = (points[faces[:, k]] for k in range(3))
    if dot(a, np.cross(b, c)).sum() < 0:
        faces = faces[:, ::-1]
    return points, np.ascontiguousarray(faces)


def _project(field: Field, points: FloatArray, longest: float) -> FloatArray:
    """Take a Newton step onto the zero level set, bounded in length."""
    slope = gradient(field, points, 1e-2 * longest)
    step = (field(points) / np.maximum(dot(slope, slope), 1e-2))[:, None] * slope
    length = np.sqrt(dot(step, step))
    limit = np.minimum(1.0, longest / np.maximum(length, 1e-9 * longest))
    return points - limit[:, None] * step


def _rim(faces: IntArray) -> IntArray:
    """(R, 2) directed edges of faces that no other face runs along the other way."""
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    count = faces.max() + 1
    alone = ~np.isin(start * count + end, end * count + start)
    return np.stack([start[alone], end[alone]], axis=1)


def _doubled(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Glue a half to its image in the plane z = 0, along the rim; a closed surface stays alone."""
    rim = _rim(faces)
    if len(rim) == 0:
        return points, faces
    inner = np.ones(len(points), dtype=bool)
    inner[rim] = False
    image = np.arange(len(points))
    image[inner] = len(points) + np.arange(inner.sum())
    mirrored = points[inner] * np.array([1.0, 1.0, -1.0])
    return np.concatenate([points, mirrored]), np.concatenate([faces, image[faces][:, ::-1]])


def _slide(points: FloatArray, faces: IntArray) -> FloatArray:
    """Move every vertex along the surface, towards the mean of its neighbours.

    At a rim these include the neighbours' images, so that its vertices stay in the plane.
    """
    half, rim = len(points), _rim(faces)
    points, faces = _doubled(points, faces)
    moved = _moved(points, faces)[:half]
    moved[rim, 2] = 0.0
    return moved


def _moved(points: FloatArray, faces: IntArray) -> FloatArray:
    """Slide the vertices of a closed surface."""
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    corner = points[faces]
    face_normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    move = _sums(start, points[end], len(points))
    move = move / np.bincount(start, minlength=len(points))[:, None] - points
    normal = normalized(_sums(start, np.repeat(face_normal, 3, axis=0), len(points)))
    return points + 0.7 * (move - dot(move, normal)[:, None] * normal)


def _sums(number: IntArray, rows: FloatArray, count: int) -> FloatArray:
    """(count, 3) sums of the rows that bear the same number."""
    return np.stack([np.bincount(number, rows[:, k], count) for k in range(3)], axis=1)


class _Surface:
    """A triangle mesh under reconstruction: faces and, for each vertex, its faces.

    The rim of an open mesh is closed by faces with the `ghost`, whose place means nothing.
    """

    def __init__(self, vertices: FloatArray, faces: IntArray, sizes: FloatArray) -> None:
        self.points: list[Point] = [(x, y, z) for x, y, z in vertices.tolist()]
        self.sizes: list[float] = sizes.tolist()
        self.faces: list[Triangle | None] = []
        self.around: list[set[int]] = [set() for _ in self.points]
        for a, b, c in faces.tolist():
            self._add((a, b, c))
        self.ghost = -1
        rim = _rim(faces)
        if len(rim):
            self.ghost = len(self.points)
            self.points.append((0.0, 0.0, 0.0))
            self.sizes.append(1.0)
            self.around.append(set())
            for a, b in rim.tolist():
                self._add((b, a, self.ghost))

    def arrays(self) -> tuple[FloatArray, IntArray]:
        """Vertices and faces that are left, renumbered."""
        kept = [face for face in self.faces if face is not None and self.ghost not in face]
        faces = np.array(kept, dtype=np.int64)
        used, faces = np.unique(faces, return_inverse=True)
        return np.array(self.points)[used], faces.reshape(-1, 3).astype(np.int64)

    def split(self, longest: float) -> None:
        """Halve edges that are longer than `longest` times their due, the worst first."""
        for _, a, b in sorted(self._edges(), reverse=True):
            wings = self._wings(a, b)
            if wings is None or self._stretch(a, b) <= longest:
                continue
            middle = len(self.points)
            self.points.append(_midpoint(self.points[a], self.points[b]))
            self.sizes.append((self.sizes[a] + self.sizes[b]) / 2.0)
            self.around.append(set())
            c, d = wings
            self._remove(a, b)
            for face in ((a, middle, c), (middle, b, c), (b, middle, d), (middle, a, d)):
                self._add(face)

    def collapse(self, shortest: float, longest: float) -> None:
        """Join the ends of edges that are too short, where that makes none too long or folded."""
        for _, a, b in sorted(self._edges()):
            wings = self._wings(a, b)
            if wings is None or self._stretch(a, b) >= shortest:
                continue
            near_a, near_b = self._neighbors(a), self._neighbors(b)
            # The link condition: otherwise two sheets would be pinched together.
            if near_a & near_b != set(wings):
                continue
            if any(len(self._neighbors(wing)) <= 4 for wing in wings):
                continue
            middle = _midpoint(self.points[a], self.points[b])
            if self._on_rim(a) != self._on_rim(b):
                rim, inner = (a, b) if self._on_rim(a) else (b, a)
                if self._ties(inner) - {rim, *wings}:
                    continue
                middle = self.points[rim]
            ring = (near_a | near_b) - {a, b, self.ghost}
            bound = longest * (self.sizes[a] + self.sizes[b]) / 2.0
            if any(_length(_minus(self.points[v], middle)) > bound for v in ring):
                continue
            if self._would_fold(a, b, middle):
                continue
            self._remove(a, b)
            self.points[a] = middle
            for number in sorted(self.around[b]):
                face = self.faces[number]
                assert face is not None
                self._drop(number)
                p, q, r = (a if v == b else v for v in face)
                self._add((p, q, r))

    def flip(self, *, by_angle: bool) -> None:
        """Turn edges: towards six neighbours for each vertex, or away from blunt angles."""
        for _, a, b in self._edges():
            wings = self._wings(a, b)
            if wings is None:
                continue
            c, d = wings
            if self.ghost in wings or (self._on_rim(c) and self._on_rim(d)):
                continue
            if d in self._neighbors(c) or min(len(self.around[a]), len(self.around[b])) <= 4:
                continue
            if not (self._too_blunt(a, b, c, d) if by_angle else self._uneven(a, b, c, d)):
                continue
            normal = _plus(self._normal((a, b, c)), self._normal((b, a, d)))
            new = ((c, d, b), (d, c, a))
            # A flip across a sharp rim would cut it off.
            if any(_cosine(self._normal(face), normal) < 0.8 for face in new):
                continue
            self._remove(a, b)
            for face in new:
                self._add(face)

    def _uneven(self, a: int, b: int, c: int, d: int) -> bool:
        """Whether turning the edge a-b brings vertices closer to six neighbours.

        A vertex on the rim has three faces of its own then, and two with the ghost.
        """
        excess = [len(self.around[v]) - (5 if self._on_rim(v) else 6) for v in (a, b, c, d)]
        change = (-1, -1, 1, 1)
        after = sum((e + x) ** 2 for e, x in zip(excess, change, strict=True))
        return after < sum(e**2 for e in excess)

    def _too_blunt(self, a: int, b: int, c: int, d: int) -> bool:
        """Whether the angles at c and d add up to more than half a turn."""
        sines, cosines = [], []
        for apex in (c, d):
            u = _minus(self.points[a], self.points[apex])
            v = _minus(self.points[b], self.points[apex])
            sines.append(_length(_cross(u, v)))
            cosines.append(_dot(u, v))
        return sines[0] * cosines[1] + cosines[0] * sines[1] < 0.0

    def _would_fold(self, a: int, b: int, middle: Point) -> bool:
        """Whether joining a and b at `middle` would turn one of their faces around."""
        for number in (self.around[a] | self.around[b]) - (self.around[a] & self.around[b]):
            face = self.faces[number]
            assert face is not None
            if self.ghost in face:
                continue
            p, q, r = (middle if v in (a, b) else self.points[v] for v in face)
            if _cosine(_cross(_minus(q, p), _minus(r, p)), self._normal(face)) < 0.5:
                return True
        return False

    def _edges(self) -> Iterable[tuple[float, int, int]]:
        """(stretch, a, b) with a < b of all edges, in the order of their faces; no ghost's."""
        corners = (face for face in self.faces if face is not None)
        pairs = [(p, q) for a, b, c in corners for p, q in ((a, b), (b, c), (c, a)) if p < q]
        pairs = [pair for pair in pairs if self.ghost not in pair]
        return [(self._stretch(a, b), a, b) for a, b in pairs]

    def _wings(self, a: int, b: int) -> tuple[int, int] | None:
        """Find the corners opposite the edge: of the face that runs a to b, and of the other."""
        shared = self.around[a] & self.around[b]
        if len(shared) != 2:
            return None
        wings = [-1, -1]
        for number in shared:
            face = self.faces[number]
            assert face is not None
            i = face.index(a)
            forward = face[(i + 1) % 3] == b
            wings[0 if forward else 1] = face[(i + 2) % 3] if forward else face[(i + 1) % 3]
        return wings[0], wings[1]

    def _neighbors(self, vertex: int) -> set[int]:
        return {v for n in self.around[vertex] for v in self.faces[n] or ()} - {vertex}

    def _on_rim(self, vertex: int) -> bool:
        return any(self.ghost in (self.faces[n] or ()) for n in self.around[vertex])

    def _ties(self, vertex: int) -> set[int]:
        """Find the neighbours on the rim: an edge across the half between two would double."""
        return {v for v in self._neighbors(vertex) if self._on_rim(v)}

    def _stretch(self, a: int, b: int) -> float:
        """Length of an edge, by the length that it should have."""
        length = _length(_minus(self.points[a], self.points[b]))
        return 2.0 * length / (self.sizes[a] + self.sizes[b])

    def _normal(self, face: Triangle) -> Point:
        p, q, r = (self.points[v] for v in face)
        return _cross(_minus(q, p), _minus(r, p))

    def _add(self, face: Triangle) -> None:
        for vertex in face:
            self.around[vertex].add(len(self.faces))
        self.faces.append(face)

    def _drop(self, number: int) -> None:
        for vertex in self.faces[number] or ():
            self.around[vertex].discard(number)
        self.faces[number] = None

    def _remove(self, a: int, b: int) -> None:
        """Take away the faces on both sides of an edge."""
        for number in self.around[a] & self.around[b]:
            self._drop(number)


def _plus(a: Point, b: Point) -> Point:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _length(a: Point) -> float:
    return sqrt(_dot(a, a))


def _cosine(a: Point, b: Point) -> float:
    return _dot(a, b) / max(_length(a) * _length(b), 1e-300)


def _midpoint(a: Point, b: Point) -> Point:
    return (a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0, (a[2] + b[2]) / 2.0
