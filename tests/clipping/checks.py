"""What must be true of any clipped mesh, and a literal version of the method to compare with.

The reference is written from the description, in plain Python: dictionaries by position, loops
over faces and corners, bisection instead of a closed form, and areas of pieces as products of
fractions instead of pieces.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter, defaultdict

import numpy as np

from moseg_core.clipping.clip import Clipped
from moseg_core.shape.mesh import PolygonMesh

SNAP = 1e-4


def triangle_normals(mesh: PolygonMesh) -> np.ndarray:
    """(T, 3): normals as long as twice the area."""
    p = mesh.vertices[mesh.triangles]
    return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def polygon_areas(mesh: PolygonMesh) -> np.ndarray:
    areas = np.linalg.norm(triangle_normals(mesh), axis=1) / 2
    return np.bincount(mesh.triangle_polygon, areas, mesh.n_polygons)


def volume(mesh: PolygonMesh) -> float:
    p = mesh.vertices[mesh.triangles] - mesh.vertices.mean(axis=0)
    return float(np.einsum("ti,ti->", p[:, 0], np.cross(p[:, 1], p[:, 2]))) / 6


def unpaired(mesh: PolygonMesh) -> Counter:
    """By its two places, how often each edge is used in one direction more than in the other."""
    count: Counter = Counter()
    ends, _ = mesh.edges
    place = mesh.vertices[np.unique(mesh.merged, return_index=True)[1]]
    for a, b in ends.tolist():
        one, other = tuple(place[a].tolist()), tuple(place[b].tolist())
        count[min((one, other), (other, one))] += 1 if one < other else -1
    return Counter({edge: uses for edge, uses in count.items() if uses})


def is_closed(mesh: PolygonMesh) -> bool:
    """Whether every edge, by position, is used once in each direction."""
    ends, _ = mesh.edges
    directed = Counter(map(tuple, ends.tolist()))
    return all(n == 1 and directed[b, a] == 1 for (a, b), n in directed.items())


def rim(mesh: PolygonMesh) -> float:
    """Length of all edges that are not used alike in both directions, as often as that."""
    return sum(abs(n) * math.dist(a, b) for (a, b), n in unpaired(mesh).items())


def assert_valid(mesh: PolygonMesh, labels: np.ndarray, clipped: Clipped) -> None:
    """Area, orientation, holes, volume and labels of a clipped mesh against those of its source."""
    after = clipped.mesh
    assert (after.vertices[: len(mesh.vertices)] == mesh.vertices).all()
    assert len(clipped.labels) == len(clipped.source) == after.n_polygons
    assert (np.diff(clipped.source) >= 0).all()
    assert (np.unique(clipped.source) == np.arange(mesh.n_polygons)).all()
    assert set(clipped.labels.tolist()) == set(np.asarray(labels).tolist())

    before, area = polygon_areas(mesh), polygon_areas(after)
    per_face = np.bincount(clipped.source, area, mesh.n_polygons)
    np.testing.assert_allclose(per_face, before, rtol=1e-9, atol=1e-12 * before.max())
    assert abs(area.sum() / before.sum() - 1) < 1e-9

    pieces = np.bincount(clipped.source, minlength=mesh.n_polygons)[clipped.source]
    for k in np.flatnonzero(pieces == 1):
        f = clipped.source[k]
        ring = after.corners[after.offsets[k] : after.offsets[k + 1]]
        assert ring.tolist() == mesh.corners[mesh.offsets[f] : mesh.offsets[f + 1]].tolist()

    # Each piece lies in one triangle of its face, which it is wound like.
    normals, source = triangle_normals(mesh), clipped.source[after.triangle_polygon]
    own = defaultdict(list)
    for t, f in enumerate(mesh.triangle_polygon.tolist()):
        own[f].append(t)
    for normal, f in zip(triangle_normals(after), source.tolist(), strict=True):
        length = np.linalg.norm(normal)
        if length > 1e-9 * before.max():
            alike = max(normal @ normals[t] / np.linalg.norm(normals[t]) for t in own[f])
            assert alike > (1 - 1e-6) * length

    if is_closed(mesh):
        assert is_closed(after)
        assert abs(volume(after) - volume(mesh)) < 1e-9 * abs(volume(mesh))
    else:
        assert abs(rim(after) - rim(mesh)) < 1e-9 * max(rim(mesh), 1e-300)


def weighted(points: np.ndarray, centers: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """(P, n): distances over weights."""
    return np.linalg.norm(points[:, None] - centers, axis=2) / weights


def reference_areas(mesh, labels, points, centers, weights) -> dict[tuple[int, int], float]:
    """For each face and label the area, as a fraction of each triangle summed up, by hand.

    Only for triangles with distinct corners and for labellings in which no part vanishes.
    """
    place = {v: tuple((p + 0.0).tolist()) for v, p in enumerate(mesh.vertices)}
    n = range(len(centers))

    def distance(p, i):
        return math.dist(p, centers[i]) / weights[i]

    triangles = [tuple(place[v] for v in row) for row in mesh.triangles.tolist()]
    owner = mesh.triangle_polygon.tolist()
    around, closed = defaultdict(set), defaultdict(set)
    for corners, f in zip(triangles, owner, strict=True):
        own = int(labels[f])
        for p in corners:
            around[p].add(own)
        for x in n:
            lost = distance(points[f], x) < distance(points[f], own) * (1 - 1e-9)
            if lost and all(distance(p, x) < distance(p, own) for p in corners):
                for p in corners:
                    closed[p].add(x)
    label = {}
    for p in around:
        open_to = sorted(around[p] - closed[p])
        label[p] = min(open_to, key=lambda i: (distance(p, i), i)) if open_to else None
    edges = {
        frozenset(pair) for corners in triangles for pair in itertools.combinations(corners, 2)
    }
    neighbors = defaultdict(set)
    for p, q in map(tuple, edges):
        neighbors[p].add(q)
        neighbors[q].add(p)
    changed = True
    while changed:
        changed, old = False, dict(label)
        for p in label:
            if old[p] is None:
                continue
            offers = {old[q] for q in neighbors[p]} - {None, old[p]} - closed[p]
            best = min(offers | {old[p]}, key=lambda i: (distance(p, i), i != old[p], i))
            if distance(p, best) < distance(p, old[p]):
                label[p], changed = best, True

    def cut(p, q):
        """How far from p to q the two are equally near, by bisection; None where not cut."""
        a, b = label[p], label[q]
        if a is None or b is None or a == b:
            return None

        def gap(t):
            x = [u + t * (v - u) for u, v in zip(p, q, strict=True)]
            return distance(x, a) - distance(x, b)

        if not (gap(0.0) <= 0.0 <= gap(1.0) and gap(0.0) < gap(1.0)):
            return None
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if gap(middle) > 0 else (middle, high)
        return 0.0 if low <= SNAP else 1.0 if low >= 1 - SNAP else low

    total: dict[tuple[int, int], float] = defaultdict(float)
    areas = np.linalg.norm(triangle_normals(mesh), axis=1) / 2
    for corners, f, area in zip(triangles, owner, areas.tolist(), strict=True):
        own, has = int(labels[f]), [label[p] for p in corners]
        sides = [cut(corners[k], corners[(k + 1) % 3]) for k in range(3)]
        number = sum(t is not None for t in sides)
        if number == 0:
            same = has[0] is not None and len(set(has)) == 1
            total[f, has[0] if same else own] += area
        elif number == 1:
            k = next(k for k in range(3) if sides[k] is not None)
            for piece, part in ((sides[k], has[k]), (1 - sides[k], has[(k + 1) % 3])):
                total[f, part if own in (has[k], has[(k + 1) % 3]) else own] += piece * area
        elif number == 2:
            k = next(k for k in range(3) if sides[(k + 1) % 3] is None)
            corner = sides[k] * (1 - sides[(k + 2) % 3])
            others = [has[(k + 1) % 3], has[(k + 2) % 3]]
            rest = min(others, key=lambda i: distance(points[f], i))
            total[f, has[k]] += corner * area
            total[f, own if own in others else rest] += (1 - corner) * area
        else:
            total[f, -1] += area  # three parts meet: only that the area is whole
    return dict(total)
