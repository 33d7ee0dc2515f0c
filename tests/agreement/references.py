"""The measures as they are defined: sets of elements, every element, every path.

In plain Python from Chen, Golovinskiy and Funkhouser 2009; nothing is taken from ``moseg_core``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Labels = Sequence[int]
Weights = Sequence[float]


def parts(labels: Labels) -> list[set[int]]:
    return [{f for f in range(len(labels)) if labels[f] == label} for label in sorted(set(labels))]


def weigh(elements: set[int], weights: Weights) -> float:
    return math.fsum(weights[f] for f in elements)


def part_of(f: int, labels: Labels) -> set[int]:
    return {g for g in range(len(labels)) if labels[g] == labels[f]}


# --- consistency -------------------------------------------------------------------------------


def refinement_error(f: int, first: Labels, second: Labels, weights: Weights) -> float:
    """E(S1, S2, f)."""
    mine, other = part_of(f, first), part_of(f, second)
    return weigh(mine - other, weights) / weigh(mine, weights)


def consistency_errors(first: Labels, second: Labels, weights: Weights) -> tuple[float, float]:
    """GCE and LCE; elements without weight add nothing."""
    elements = [f for f in range(len(first)) if weights[f] > 0]
    forth = {f: refinement_error(f, first, second, weights) for f in elements}
    back = {f: refinement_error(f, second, first, weights) for f in elements}
    whole = math.fsum(weights)
    return (
        min(
            math.fsum(weights[f] * forth[f] for f in elements),
            math.fsum(weights[f] * back[f] for f in elements),
        )
        / whole,
        math.fsum(weights[f] * min(forth[f], back[f]) for f in elements) / whole,
    )


# --- Hamming -----------------------------------------------------------------------------------


def directional_hamming(first: Labels, second: Labels, weights: Weights) -> float:
    """D(S1 => S2)."""
    outside = []
    for part in parts(second):
        best = max(parts(first), key=lambda other: weigh(part & other, weights))
        outside.append(weigh(part - best, weights))
    return math.fsum(outside)


# --- cuts --------------------------------------------------------------------------------------

Point = tuple[float, ...]


def place(vertices: Sequence[Sequence[float]], v: int) -> Point:
    return tuple(float(x) for x in vertices[v])


def sides(
    vertices: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]
) -> list[set[frozenset[Point]]]:
    """The edges of each face as pairs of positions, those of no length left out."""
    found = []
    for face in faces:
        ring = [place(vertices, v) for v in face]
        pairs = zip(ring, ring[1:] + ring[:1], strict=True)
        found.append({frozenset(pair) for pair in pairs if pair[0] != pair[1]})
    return found


def cut_points(
    vertices: Sequence[Sequence[float]], faces: Sequence[Sequence[int]], labels: Labels
) -> set[Point]:
    """Positions on edges that two faces of different parts share."""
    edges = sides(vertices, faces)
    cut: set[Point] = set()
    for f in range(len(faces)):
        for g in range(f):
            if labels[f] != labels[g] and -1 not in (labels[f], labels[g]):
                for edge in edges[f] & edges[g]:
                    cut |= edge
    return cut


def all_distances(
    vertices: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]
) -> dict[tuple[Point, Point], float]:
    """Shortest paths along edges between all positions, by Floyd and Warshall."""
    edges = set().union(*sides(vertices, faces))
    points = {point for edge in edges for point in edge}
    d = {(p, q): 0.0 if p == q else math.inf for p in points for q in points}
    for edge in edges:
        p, q = edge
        d[p, q] = d[q, p] = math.dist(p, q)
    for via in points:
        for p in points:
            for q in points:
                d[p, q] = min(d[p, q], d[p, via] + d[via, q])
    return d


def cut_discrepancy(
    vertices: Sequence[Sequence[float]],
    faces: Sequence[Sequence[int]],
    first: Labels,
    second: Labels,
    radius: float,
) -> float | None:
    """Mean distance between the cuts over the radius; None where undefined.

    A face without a label, -1, in either has none in both.
    """
    known = [-1 not in pair for pair in zip(first, second, strict=True)]
    first = [label if there else -1 for label, there in zip(first, known, strict=True)]
    second = [label if there else -1 for label, there in zip(second, known, strict=True)]
    here, there = cut_points(vertices, faces, first), cut_points(vertices, faces, second)
    if not here and not there:
        return 0.0
    if not here or not there:
        return None
    d = all_distances(vertices, faces)
    apart = [min(d[p, q] for q in there) for p in here]
    apart += [min(d[p, q] for p in here) for q in there]
    mean = math.fsum(apart) / len(apart)
    return mean / radius if math.isfinite(mean) else None
