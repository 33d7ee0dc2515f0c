"""Slow, literal versions of what the core computes fast, for its tests to compare with.

Written in plain Python from the paper (Simari & Singh, "Multi-objective shape segmentation") with
its errata applied, one statement here for one there: tuples in a ``heapq``, loops over elements,
every permutation, every pair. Nothing is taken from ``moseg_core``.

Where the paper leaves something open, what holds here is this:

- Algorithm 1: ties go by (distance, centre, element); an element that no flood reaches takes its
  nearest weighted centre, of equal ones the first.
- Algorithm 2: of equal points the first is chosen; an empty segment, or one without area, starts
  again at the element furthest from the centres of the others; the rounds end when a
  classification comes back, with the centres that produced it.
- Section 7: the best of the feasible neighbours is taken, of equal ones the first, in the order
  +1, -1, +2, -2, ...; an infeasible neighbour is skipped and not counted.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Iterable, Sequence

Point = Sequence[float]
Labels = list[int]


# --- Algorithm 1 -------------------------------------------------------------------------------


def weighted_distance(p: Point, c: Point, w: float) -> float:
    """Distance of p to a centre c of weight w (Sec. 4): ``||p - c|| / w``."""
    dx, dy, dz = p[0] - c[0], p[1] - c[1], p[2] - c[2]
    return math.sqrt(dx * dx + dy * dy + dz * dz) / w


def voronoi_partition(
    points: Sequence[Point], centers: Sequence[Point], weights: Sequence[float]
) -> Labels:
    """Nearest weighted centre of each point."""
    return [
        min(range(len(centers)), key=lambda i: (weighted_distance(p, centers[i], weights[i]), i))
        for p in points
    ]


def connected_partition(
    points: Sequence[Point],
    neighbors: Sequence[Iterable[int]],
    centers: Sequence[Point],
    weights: Sequence[float],
) -> Labels:
    """Algorithm 1, line by line."""
    surface, n = range(len(points)), range(len(centers))
    D = [[weighted_distance(points[f], centers[i], weights[i]) for i in n] for f in surface]
    Q: list[tuple[float, int, int]] = []
    Seg = [-1] * len(points)
    for i in n:
        f = min(surface, key=lambda f: (D[f][i], f))
        heapq.heappush(Q, (D[f][i], i, f))
    while Q:
        _, i, f = heapq.heappop(Q)
        if Seg[f] == -1:
            Seg[f] = i
            for g in neighbors[f]:
                heapq.heappush(Q, (D[g][i], i, g))
    for f in surface:
        if Seg[f] == -1:
            Seg[f] = min(n, key=lambda i: (D[f][i], i))
    return Seg


def connected_parts(
    points: Sequence[Point],
    neighbors: Sequence[Iterable[int]],
    centers: Sequence[Point],
    weights: Sequence[float],
    parts: Sequence[int],
) -> Labels:
    """Algorithm 1 for parts of several centres: of what a part has reached, one piece is kept.

    On each component of the graph it is the one with the first of the part's centres there; all
    that is left floods what becomes free.
    """
    Seg = connected_partition(points, neighbors, centers, weights)
    for ground in connected_pieces(neighbors, range(len(points))):
        starts = [
            min(range(len(points)), key=lambda f: (weighted_distance(points[f], c, w), f))
            for c, w in zip(centers, weights, strict=True)
        ]
        if not ground.intersection(starts):
            continue  # no flood has come here
        for part in set(parts):
            mine = [f for f in ground if Seg[f] >= 0 and parts[Seg[f]] == part]
            pieces = connected_pieces(neighbors, mine)
            for piece in sorted(pieces, key=lambda piece: min(Seg[f] for f in piece))[1:]:
                for f in piece:
                    Seg[f] = -1
    D = [
        [weighted_distance(p, c, w) for c, w in zip(centers, weights, strict=True)] for p in points
    ]
    Q = [(D[f][i], i, f) for f, i in enumerate(Seg) if i >= 0]
    heapq.heapify(Q)
    while Q:
        _, i, f = heapq.heappop(Q)
        if Seg[f] == -1:
            Seg[f] = i
        if Seg[f] == i:
            for g in neighbors[f]:
                if Seg[g] == -1:
                    heapq.heappush(Q, (D[g][i], i, g))
    return [parts[i] for i in Seg]


# --- Algorithm 2 -------------------------------------------------------------------------------


def square_distance(p: Point, q: Point) -> float:
    """Squared distance of two points."""
    dx, dy, dz = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return dx * dx + dy * dy + dz * dz


def farthest_pair(points: Sequence[Point]) -> tuple[int, int]:
    """The first i <= j with the greatest distance."""
    pairs = itertools.combinations_with_replacement(range(len(points)), 2)
    i, j = min(pairs, key=lambda pair: (-square_distance(points[pair[0]], points[pair[1]]), pair))
    return i, j


def furthest_element(points: Sequence[Point], centers: Sequence[Point]) -> int:
    """The first element whose nearest centre is furthest away."""
    nearest = [min(square_distance(p, c) for c in centers) for p in points]
    return nearest.index(max(nearest))


def kmeans(
    points: Sequence[Point],
    areas: Sequence[float],
    n: int,
    classify: Callable[[list[Point]], Labels],
    rounds: int = 100,
) -> tuple[list[Point], Labels, int]:
    """Algorithm 2: centres, the last classification, and the number of updates."""
    C: list[Point] = [points[f] for f in farthest_pair(points)][:n]
    while len(C) < n:
        C.append(points[furthest_element(points, C)])
    seen: list[Labels] = []
    S: Labels = []
    while len(seen) < rounds:
        S = list(classify(C))
        if S in seen:
            break
        seen.append(S)
        moved: dict[int, Point] = {}
        for i in range(n):
            members = [f for f in range(len(points)) if S[f] == i]
            area = math.fsum(areas[f] for f in members)
            if area > 0:
                moved[i] = [
                    math.fsum(areas[f] * points[f][k] for f in members) / area for k in range(3)
                ]
        for i in range(n):
            if i not in moved:
                moved[i] = points[furthest_element(points, list(moved.values()))]
        C = [moved[i] for i in range(n)]
    return C, S, len(seen)


# --- Section 6 ---------------------------------------------------------------------------------


def least_assignment_cost(C: Sequence[Sequence[float]]) -> float:
    """Least sum of C[i][j] over all ways to give every segment i a label j of its own."""
    n = len(C)
    return min(
        math.fsum(C[i][j] for i, j in enumerate(labels))
        for labels in itertools.permutations(range(n))
    )


# --- Section 7 ---------------------------------------------------------------------------------


def pattern_search(
    objective: Callable[[list[float]], tuple[int, float]],
    start: Sequence[float],
    lower: Sequence[float],
    upper: Sequence[float],
    scale: Sequence[float],
    *,
    pattern_size: float = 0.2,
    expansion: float = 2.0,
    contraction: float = 0.5,
    threshold: float = 1e-6,
    max_evaluations: int | None = None,
    combine: bool = False,
) -> tuple[list[float], tuple[int, float], list[tuple[int, tuple[int, float], float]]]:
    """The search of Sec. 7: best point, its cost, and (evaluations, cost, step) per iteration.

    With ``combine`` sums of a poll's best moves are tried after it, one along each coordinate.
    """
    x = list(start)
    best = objective(x)
    evaluations = 1
    step = pattern_size
    history = [(evaluations, best, step)]
    while step >= threshold and (max_evaluations is None or evaluations < max_evaluations):
        poll = []
        for k in range(len(x)):
            for sign in (1.0, -1.0):
                y = list(x)
                y[k] = x[k] + sign * (step * scale[k])
                if lower[k] <= y[k] <= upper[k]:
                    poll.append(y)
        if max_evaluations is not None:
            poll = poll[: max_evaluations - evaluations]
        evaluations += len(poll)
        costs = [objective(y) for y in poll]
        better = sorted((k for k in range(len(poll)) if costs[k] < best), key=lambda k: costs[k])
        polled = step
        center = x
        if better:
            x, best = poll[better[0]], costs[better[0]]
            step *= expansion
        else:
            step *= contraction
        if poll:
            history.append((evaluations, best, polled))
        if not combine:
            continue
        moved: list[int] = []
        y, sums = list(center), {}
        for k in better:
            (along,) = [i for i in range(len(x)) if poll[k][i] != center[i]]
            if along not in moved:
                moved.append(along)
                y[along] = poll[k][along]
                sums[len(moved)] = list(y)
        tried = [sums[n] for n in (2, 3, 4, 6, 8) if n in sums]
        if len(moved) > 1 and sums[len(moved)] not in tried:
            tried.append(sums[len(moved)])
        if max_evaluations is not None:
            tried = tried[: max_evaluations - evaluations]
        if tried:
            evaluations += len(tried)
            cost, at = min((objective(y), k) for k, y in enumerate(tried))
            if cost < best:
                x, best = tried[at], cost
            history.append((evaluations, best, step))
    return x, best, history


# --- parts -------------------------------------------------------------------------------------


def triangle_moments(
    triangles: Iterable[Sequence[Point]],
) -> tuple[float, list[float], list[list[float]]]:
    """Area, centroid and covariance of a surface of triangles.

    By the rule of the edge midpoints, which is exact for quadratic functions on a triangle; the
    covariance is taken about the centroid directly.
    """
    samples: list[tuple[float, list[float]]] = []
    for a, b, c in triangles:
        u = [b[k] - a[k] for k in range(3)]
        v = [c[k] - a[k] for k in range(3)]
        cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        third = math.sqrt(math.fsum(x * x for x in cross)) / 6
        for p, q in ((a, b), (b, c), (c, a)):
            samples.append((third, [(p[k] + q[k]) / 2 for k in range(3)]))
    area = math.fsum(w for w, _ in samples)
    mean = [math.fsum(w * p[k] for w, p in samples) / area for k in range(3)]
    covariance = [
        [
            math.fsum(w * (p[i] - mean[i]) * (p[j] - mean[j]) for w, p in samples) / area
            for j in range(3)
        ]
        for i in range(3)
    ]
    return area, mean, covariance


def membership_hash(elements: Iterable[int]) -> tuple[int, int]:
    """Two sums modulo 2**64 of SplitMix64-mixed element numbers, counted from 1."""
    whole = 2**64

    def mix(x: int) -> int:
        x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9 % whole
        x = (x ^ (x >> 27)) * 0x94D049BB133111EB % whole
        return x ^ (x >> 31)

    first = second = 0
    for f in elements:
        first += mix((f + 1) * 0x9E3779B97F4A7C15 % whole)
        second += mix(((f + 1) * 0xD1B54A32D192ED03 + 1) % whole)
    return first % whole, second % whole


def edge_neighbors(vertices: Sequence[Point], faces: Sequence[Sequence[int]]) -> list[set[int]]:
    """For each face those that share an edge with it, corners joined by position.

    Around an edge that is used more than three times only the next ones by angle on either side.
    """
    users: dict[tuple, list[int]] = {}
    for f, face in enumerate(faces):
        corners = [tuple(float(x) for x in vertices[v]) for v in face]
        for edge in zip(corners, corners[1:] + corners[:1], strict=True):
            if edge[0] != edge[1]:
                users.setdefault(tuple(sorted(edge)), []).append(f)
    neighbors: list[set[int]] = [set() for _ in faces]
    for (start, stop), around in users.items():
        if len(around) > 3:
            along = [b - a for a, b in zip(start, stop, strict=True)]
            beside = _cross(along, [along[1] + 1.0, along[2] + 2.0, along[0] + 4.0])
            upward = [x / math.hypot(*along) for x in _cross(along, beside)]
            angles = {}
            for f in set(around):
                corners = [vertices[v] for v in faces[f]]
                middle = [sum(float(c[k]) for c in corners) / len(corners) for k in range(3)]
                away = [m - a for m, a in zip(middle, start, strict=True)]
                angles[f] = math.atan2(_dot(away, upward), _dot(away, beside))
            around = sorted(around, key=angles.__getitem__)
        for f, g in zip(around, [*around[1:], around[0]], strict=True):
            if f != g:
                neighbors[f].add(g)
                neighbors[g].add(f)
    return neighbors


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def connected_pieces(neighbors: Sequence[Iterable[int]], elements: Iterable[int]) -> list[set[int]]:
    """The connected components of some elements, in the order of their least element."""
    left = set(elements)
    pieces = []
    while left:
        piece, front = set(), [min(left)]
        while front:
            f = front.pop()
            if f in left:
                left.remove(f)
                piece.add(f)
                front.extend(neighbors[f])
        pieces.append(piece)
    return pieces


# --- comparing segmentations ---------------------------------------------------------------------


def rand_index_error(
    first: Sequence[int], second: Sequence[int], weights: Sequence[float]
) -> float:
    """Weight of the pairs of elements on which two labellings disagree, over that of all pairs."""
    apart, whole = [], []
    for f, g in itertools.combinations(range(len(first)), 2):
        whole.append(weights[f] * weights[g])
        if (first[f] == first[g]) != (second[f] == second[g]):
            apart.append(weights[f] * weights[g])
    return math.fsum(apart) / math.fsum(whole) if whole else 0.0


# --- for the tests of what works with any parameterization ---------------------------------------


class Listed:
    """A parameterization whose vectors are the numbers of given labellings.

    Parameters
    ----------
    labellings : (K, F) int array
    n_parts : int
    lower, upper, scale : (1,) float arrays
        Taken as they are.
    """

    def __init__(self, labellings, n_parts, lower=None, upper=None, scale=None):
        self.labellings, self.n_parts = labellings, n_parts
        self.lower, self.upper, self.scale = lower, upper, scale

    def labels(self, vectors):
        """The labelling that each vector names."""
        return self.labellings[vectors.reshape(-1).astype(int)].astype("int32")

    def permute(self, vector, order):
        """The vector itself: nobody asks for the labels of what this returns."""
        return vector
