"""Checks of parameterizations: any vector within the bounds is a segmentation (Sec. 4).

The search knows nothing of a segmentation but its vector. It moves along coordinates, wherever
the bounds let it, and so meets centres far away, on top of each other and of all weights; seeders
and labelers encode, decode and permute. What they rely on is checked here, on a pebble whose
elements touch and on a cloud of which nobody knows which do.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.components.protocols import Centers, ClippableParameterization, Parameterization
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.problems import as_numbers, dots, horseshoe, pebble, unlike
from moseg_core.testing.fixtures.trial import values_for
from moseg_core.types import FloatArray, Int32Array

_FAR = 1e3
_CLOSE = 1e-9


def _made(subject: Subject, shape: Shape, n: int) -> Parameterization:
    given = values_for(subject, shape, n)
    made: Parameterization = subject.load()(shape, n, **given)
    return made


def _stages(subject: Subject) -> Iterator[tuple[str, Shape, Parameterization]]:
    for shape, n in ((pebble(), 1), (pebble(), 4), (dots(), 3)):
        yield f"{n} parts of the {shape.name}", shape, _made(subject, shape, n)


def within(lower: FloatArray, upper: FloatArray, scale: FloatArray, count: int) -> FloatArray:
    """(count, m) float: vectors anywhere between the bounds, near the middle and far away.

    Where a coordinate is unbounded, they go up to one step, or a thousand, from 0 or from its
    only bound. The last is as near to the lower bounds, or as far down, as can be.
    """
    rng = np.random.default_rng(2)
    found = []
    for reach in np.where(np.arange(count) % 3 == 2, _FAR, 1.0):
        size = reach * scale
        low = np.where(np.isfinite(lower), lower, np.where(np.isfinite(upper), upper, 0.0) - size)
        high = np.where(np.isfinite(upper), upper, np.where(np.isfinite(lower), lower, 0.0) + size)
        found.append(rng.uniform(low, high))
    found[-1] = np.where(np.isfinite(lower), lower, low)
    return np.array(found)


def _placed(shape: Shape, n: int, seed: int) -> Centers:
    rng = np.random.default_rng(seed)
    chosen = shape.points[rng.choice(shape.n_elements, n, replace=False)]
    return Centers(positions=chosen, weights=rng.uniform(0.8, 1.25, n))


def _labels(partition: Parameterization, vectors: FloatArray) -> Int32Array:
    return np.asarray(partition.labels(vectors))


@check(
    "parameterization-bounds",
    kinds=["parameterization"],
    why="the search steps along coordinates within the bounds; without them it cannot begin",
)
def _bounds(subject: Subject) -> None:
    for what, _, partition in _stages(subject):
        lower, upper, scale = (
            as_numbers(getattr(partition, name)) for name in ("lower", "upper", "scale")
        )
        one_each = lower.ndim == 1 and lower.shape == upper.shape == scale.shape and lower.size > 0
        if not (one_each and (lower <= upper).all()):
            raise ContractFailure(
                did=f"lower, upper and scale were asked for {what}",
                got=f"arrays of shape {lower.shape}, {upper.shape} and {scale.shape}"
                + (", with lower above upper somewhere" if one_each else ""),
                expected="one number per coordinate in each, lower never above upper",
                fix="use -inf and inf where a coordinate is unbounded",
            )
        if not (np.isfinite(scale).all() and (scale > 0).all()):
            raise ContractFailure(
                did=f"scale was asked for {what}",
                got=f"{scale.tolist()}",
                expected="positive, finite sizes of a step",
                fix="give 1 where a coordinate is in unit coordinates",
            )


@check(
    "parameterization-labels",
    kinds=["parameterization"],
    why="the search may step anywhere within the bounds, and needs a whole segmentation there",
)
def _one_label_each(subject: Subject) -> None:
    for what, shape, partition in _stages(subject):
        tried = within(partition.lower, partition.upper, partition.scale, 12)
        # Centres on top of each other, as a seeder may place them.
        same = _placed(shape, 1, seed=0)
        n = partition.n_parts
        together = Centers(positions=np.repeat(same.positions, n, axis=0), weights=np.ones(n))
        tried = np.vstack([tried, partition.encode(together)[None]])
        labels = _labels(partition, tried)
        expected = (len(tried), shape.n_elements)
        if labels.shape != expected or labels.dtype != np.int32:
            raise ContractFailure(
                did=f"labels() was called with {len(tried)} vectors for {what}",
                got=f"an array of {labels.dtype} of shape {labels.shape}",
                expected=f"int32 of shape {expected}, a row per vector, a label per element",
                fix="return one row for each vector, of dtype numpy.int32",
            )
        if labels.min() < 0 or labels.max() >= n:
            wrong = int(np.flatnonzero(((labels < 0) | (labels >= n)).any(axis=1))[0])
            raise ContractFailure(
                did=f"labels() was called for {what} with {tried[wrong].tolist()}",
                got=f"labels from {labels[wrong].min()} to {labels[wrong].max()}",
                expected=f"0 to {n - 1} for every vector within the bounds",
                fix="give each element to a part, however far away the centres are; narrow the"
                " bounds where a vector means nothing",
            )


@check(
    "parameterization-batch",
    kinds=["parameterization"],
    why="candidates come in batches of any size; a result must not depend on its company",
)
def _batch(subject: Subject) -> None:
    for what, shape, partition in _stages(subject):
        tried = np.array([partition.encode(_placed(shape, partition.n_parts, k)) for k in range(6)])
        together = _labels(partition, tried)
        alone = np.vstack([_labels(partition, vector[None]) for vector in tried])
        if unlike(together, alone) is not None:
            raise ContractFailure(
                did=f"labels() was called with 6 vectors for {what}, and with each alone",
                got="other labels",
                expected="the same, row by row",
                fix="let a row depend on nothing but its own vector",
            )


@check(
    "parameterization-encode-decode",
    kinds=["parameterization"],
    why="seeders place centres and users see them; both go through encode() and decode()",
)
def _encode_decode(subject: Subject) -> None:
    for what, shape, partition in _stages(subject):
        meant = _placed(shape, partition.n_parts, 5)
        vector = as_numbers(partition.encode(meant))
        lower, upper = partition.lower, partition.upper
        if vector.shape != lower.shape or not ((vector >= lower) & (vector <= upper)).all():
            raise ContractFailure(
                did=f"centres on elements, of weights near 1, were encoded for {what}",
                got=f"{vector.tolist()}",
                expected=f"{len(lower)} numbers within the bounds",
                fix="scale positions by shape.frame.to_unit; move centres to the nearest that"
                " can be had",
            )
        back = partition.decode(vector)
        moved = unlike(back.positions, meant.positions, tolerance=_CLOSE * shape.frame.scale)
        again = unlike(partition.encode(back), vector, tolerance=_CLOSE)
        weights = as_numbers(back.weights)
        ratio = weights / meant.weights
        # A family may do without weights: then all are equal.
        kept = (
            weights.shape == (partition.n_parts,) and min(np.ptp(ratio), np.ptp(weights)) < _CLOSE
        )
        if moved is not None or again is not None or not kept:
            raise ContractFailure(
                did=f"centres were encoded and decoded for {what}",
                got=f"positions up to {0.0 if moved is None else moved:.3g} away, weights"
                f" {weights.round(6).tolist()} for {meant.weights.round(6).tolist()}",
                expected="the same positions in model units, weights in the same ratios (or all"
                " equal), and the same vector when encoded again",
                fix="let decode() undo encode(), shape.frame.to_model undo shape.frame.to_unit",
            )


@check(
    "parameterization-element-order",
    kinds=["parameterization"],
    why="files list the same faces in any order; the parts must not depend on it",
)
def _element_order(subject: Subject) -> None:
    order = np.random.default_rng(11).permutation(pebble().n_elements)
    shuffled = np.random.default_rng(12).permutation(dots().n_elements)
    pairs = [
        (4, pebble(), pebble(order=order), order),
        (3, dots(), dots(order=shuffled), shuffled),
    ]
    for n, shape, other, places in pairs:
        first, second = _made(subject, shape, n), _made(subject, other, n)
        for seed in range(4):
            centers = _placed(shape, n, seed)
            labels = _labels(first, first.encode(centers)[None])[0]
            found = _labels(second, second.encode(centers)[None])[0]
            wrong = int((labels[places] != found).sum())
            if wrong:
                raise ContractFailure(
                    did=f"the {shape.name} was cut into {n} parts, and again with its elements in"
                    " another order",
                    got=f"another part for {wrong} of {len(found)} elements",
                    expected="the same part for each, there being no ties",
                    fix="decide by distances, and by an element's number only between equal ones",
                )


@check(
    "parameterization-connected",
    kinds=["parameterization"],
    why="where it says that parts are connected, objectives and users rely on it",
)
def _connected(subject: Subject) -> None:
    shape, n = horseshoe(), 4
    partition = _made(subject, shape, n)
    if not getattr(partition, "connected", False):
        raise Skip("it does not say that its parts are connected")
    placed = [partition.encode(_placed(shape, n, seed)) for seed in range(20)]
    tried = np.vstack([within(partition.lower, partition.upper, partition.scale, 20), placed])
    assert shape.adjacency is not None  # it is a mesh
    a, b = shape.adjacency.pairs.T
    for vector, labels in zip(tried, _labels(partition, tried), strict=True):
        kept = labels[a] == labels[b]
        graph = sparse.coo_array(
            (np.ones(kept.sum()), (a[kept], b[kept])), shape=(len(labels), len(labels))
        )
        pieces = csgraph.connected_components(graph)[0]
        parts = len(np.unique(labels))
        if pieces != parts:
            raise ContractFailure(
                did=f"a horseshoe in one piece was cut by the vector {vector.round(3).tolist()}",
                got=f"{parts} parts in {pieces} pieces",
                expected="each part in one piece, since 'connected' is true",
                fix="flood parts along shape.adjacency, or leave the attribute out",
            )


@check(
    "parameterization-permute",
    kinds=["parameterization"],
    why="labelers say which centre gets which label; permute() is how they are obeyed",
)
def _permute(subject: Subject) -> None:
    for what, shape, partition in _stages(subject):
        n = partition.n_parts
        order = np.roll(np.arange(n), 1)
        vector = partition.encode(_placed(shape, n, 3))
        turned = partition.permute(vector, order)
        before, after = (_labels(partition, v[None])[0] for v in (vector, turned))
        wrong = int((order[after] != before).sum())
        if wrong:
            raise ContractFailure(
                did=f"a vector for {what} was permuted by {order.tolist()}",
                got=f"{wrong} elements in a part that they were not in",
                expected="part j with the elements that part order[j] had",
                fix="put the coordinates of part order[j] in the places of part j",
            )


@check(
    "parameterization-coordinates",
    kinds=["parameterization"],
    why="a part is frozen, or follows others, by its coordinates; those of others must be free",
)
def _coordinates(subject: Subject) -> None:
    for what, shape, partition in _stages(subject):
        n, size = partition.n_parts, len(partition.lower)
        vector, other = (partition.encode(_placed(shape, n, k)) for k in (6, 7))
        for part in range(n):
            own = np.asarray(partition.coordinates(part))
            mixed = other.copy()
            legal = np.issubdtype(own.dtype, np.integer) and own.ndim == 1 and own.size > 0
            if legal and own.min() >= 0 and own.max() < size:
                mixed[own] = vector[own]
                kept = partition.decode(mixed).positions[part]
                if unlike(kept, partition.decode(vector).positions[part], tolerance=1e-6) is None:
                    continue
            raise ContractFailure(
                did=f"coordinates({part}) was asked for {what}, and all others were changed",
                got=f"{own.tolist()}, which do not keep the centre where it was",
                expected=f"all places, of 0 to {size - 1}, that decide about part {part}",
                fix="return the indices of its position and weight in the vector",
            )


@check(
    "parameterization-distances",
    kinds=["parameterization"],
    why="boundaries are moved off the elements by distances; they must agree with the labels",
)
def _distances(subject: Subject) -> None:
    shape, n = dots(), 3
    partition = _made(subject, shape, n)
    if not isinstance(partition, ClippableParameterization):
        raise Skip("it does not say how far points are from its parts")
    for seed in range(4):
        vector = partition.encode(_placed(shape, n, seed))
        distances = as_numbers(partition.distances(vector, shape.points))
        expected = (shape.n_elements, n)
        if distances.shape != expected or not np.isfinite(distances).all():
            raise ContractFailure(
                did="distances() was called with the points of a cloud, for 3 parts",
                got=f"an array of shape {distances.shape}, "
                + ("some not finite" if distances.size else "or none at all"),
                expected=f"finite numbers of shape {expected}, a row per point",
                fix="return how far each point, in model units, is from each part",
            )
        nearest = distances.argmin(axis=1)
        wrong = int((nearest != _labels(partition, vector[None])[0]).sum())
        if wrong:
            raise ContractFailure(
                did="labels of a cloud's points were compared with the least of their distances",
                got=f"another part for {wrong} of {shape.n_elements} points",
                expected="the same, where parts are not kept connected",
                fix="take points to unit coordinates with shape.frame.to_unit, as labels() does",
            )
