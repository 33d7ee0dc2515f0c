"""Checks of parameterizations: any vector within the bounds is a segmentation (Sec. 4).

The search knows nothing of a segmentation but its vector. It moves along coordinates, wherever
the bounds let it, and so meets centres far away, on top of each other and of all weights; seeders
and labelers encode, decode and permute. What they rely on is checked here, on a lump whose
elements touch and on a cloud of which nobody knows which do.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.components.discovery.specs import ParameterizationSpec
from moseg_core.components.protocols import Centers, ClippableParameterization, Parameterization
from moseg_core.components.requirements import lack
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.comparison import as_numbers, expect_equal, unlike
from moseg_core.testing.fixtures.problems import (
    encoded,
    own_centers,
    own_encoded,
    placed,
    within,
)
from moseg_core.testing.fixtures.shapes import cloud, horseshoe, lump, reordered
from moseg_core.testing.fixtures.trial import made
from moseg_core.types import FloatArray, Int32Array

_CLOSE = 1e-9


def _shapes(subject: Subject, *tried: tuple[Shape, int]) -> list[tuple[Shape, int]]:
    """Shapes and numbers of parts, without the shapes that lack what is required of them."""
    requires = cast(ParameterizationSpec, subject.component.spec).requires
    return [pair for pair in tried if not any(lack(pair[0], word) for word in requires)]


def _partitions(subject: Subject) -> Iterator[tuple[str, Shape, Parameterization]]:
    for shape, n in _shapes(subject, (lump(), 1), (lump(), 4), (cloud(), 3)):
        yield f"{n} parts of the {shape.name}", shape, made(subject, shape, n)


def _labels(partition: Parameterization, vectors: FloatArray) -> Int32Array:
    return np.asarray(partition.labels(vectors))


@check("parameterization-bounds", kinds=["parameterization"])
def _bounds(subject: Subject) -> None:
    """The search steps along coordinates within the bounds; without them it cannot begin."""
    for what, _, partition in _partitions(subject):
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


@check("parameterization-labels", kinds=["parameterization"])
def _one_label_each(subject: Subject) -> None:
    """The search may step anywhere within the bounds, and needs a whole segmentation there."""
    for what, shape, partition in _partitions(subject):
        n = partition.n_parts
        # Centres on top of each other, as a seeder may place them.
        one_place = np.repeat(placed(shape, 1, seed=0).positions, n, axis=0)
        together = partition.encode(Centers(positions=one_place, weights=np.ones(n)))
        anywhere = within(partition.lower, partition.upper, partition.scale, 12)
        tried = np.vstack([anywhere, together[None]])
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


@check("parameterization-batch", kinds=["parameterization"])
def _batch(subject: Subject) -> None:
    """Candidates come in batches of any size; a result must not depend on its company."""
    for what, shape, partition in _partitions(subject):
        tried = own_encoded(partition, shape, *range(6))
        expect_equal(
            _labels(partition, tried),
            np.vstack([_labels(partition, vector[None]) for vector in tried]),
            did=f"labels() was called with 6 vectors for {what}, and with each alone",
            got="other labels",
            expected="the same, row by row",
            fix="let a row depend on nothing but its own vector",
        )


@check("parameterization-encode-decode", kinds=["parameterization"])
def _encode_decode(subject: Subject) -> None:
    """Seeders place centres and users see them; both go through encode() and decode()."""
    for what, shape, partition in _partitions(subject):
        _comes_back(what, shape, partition, own_centers(partition, shape, 5))
        # Where a part has several centres, a seeder still gives one.
        _comes_back(what, shape, partition, placed(shape, partition.n_parts, 5))


def _comes_back(what: str, shape: Shape, partition: Parameterization, meant: Centers) -> None:
    """Complain unless centres that are encoded are decoded again."""
    vector = as_numbers(partition.encode(meant))
    lower, upper = partition.lower, partition.upper
    if vector.shape != lower.shape or not ((vector >= lower) & (vector <= upper)).all():
        raise ContractFailure(
            did=f"centres on elements, of weights near 1, were encoded for {what}",
            got=f"{vector.tolist()}",
            expected=f"{len(lower)} numbers within the bounds",
            fix="scale positions by shape.frame.to_unit; move centres to the nearest that"
            " can be had; let Centers.fitted() give each part as many as it has",
        )
    whole = partition.decode(vector)
    own = own_centers(partition, shape, 5).per_part
    counted = np.array_equal(whole.per_part, own) and len(whole.positions) == own.sum()
    back = whole.fitted(meant.per_part) if counted else whole
    moved = unlike(back.positions, meant.positions, tolerance=_CLOSE * shape.frame.scale)
    again = unlike(partition.encode(whole), vector, tolerance=_CLOSE) if counted else None
    weights = as_numbers(back.weights)
    # A family may do without weights: then all are equal.
    kept = counted and weights.shape == meant.weights.shape
    kept = kept and min(np.ptp(weights / meant.weights), np.ptp(weights)) < _CLOSE
    if moved is not None or again is not None or not kept:
        raise ContractFailure(
            did=f"centres were encoded and decoded for {what}",
            got=f"positions up to {0.0 if moved is None else moved:.3g} away, weights"
            f" {weights.round(6).tolist()} for {meant.weights.round(6).tolist()}, of parts"
            f" with {whole.per_part.tolist()} centres each",
            expected="the same positions in model units, weights in the same ratios (or all"
            " equal), and the same vector when encoded again; for each part as many as"
            " centers_per_part says, else one",
            fix="let decode() undo encode(), shape.frame.to_model undo shape.frame.to_unit",
        )


@check("parameterization-element-order", kinds=["parameterization"])
def _element_order(subject: Subject) -> None:
    """Files list the same faces in any order; the parts must not depend on it."""
    for shape, n in _shapes(subject, (lump(), 4), (cloud(), 3)):
        other, order = reordered(shape)
        first, second = made(subject, shape, n), made(subject, other, n)
        for seed in range(4):
            centers = own_centers(first, shape, seed)
            labels = _labels(first, first.encode(centers)[None])[0]
            found = _labels(second, second.encode(centers)[None])[0]
            if wrong := int((labels[order] != found).sum()):
                raise ContractFailure(
                    did=f"the {shape.name} was cut into {n} parts, and again with its elements in"
                    " another order",
                    got=f"another part for {wrong} of {len(found)} elements",
                    expected="the same part for each, there being no ties",
                    fix="decide by distances, and by an element's number only between equal ones",
                )


@check("parameterization-connected", kinds=["parameterization"])
def _connected(subject: Subject) -> None:
    """Where it says that parts are connected, objectives and users rely on it."""
    shape = horseshoe()
    partition = made(subject, shape, 4)
    if not getattr(partition, "connected", False):
        raise Skip("it does not say that its parts are connected")
    anywhere = within(partition.lower, partition.upper, partition.scale, 20)
    tried = np.vstack([anywhere, own_encoded(partition, shape, *range(20))])
    assert shape.adjacency is not None  # it is a mesh
    a, b = shape.adjacency.pairs.T
    for vector, labels in zip(tried, _labels(partition, tried), strict=True):
        kept = labels[a] == labels[b]
        size = (len(labels), len(labels))
        graph = sparse.coo_array((np.ones(kept.sum()), (a[kept], b[kept])), shape=size)
        pieces, parts = csgraph.connected_components(graph)[0], len(np.unique(labels))
        if pieces != parts:
            raise ContractFailure(
                did=f"a horseshoe in one piece was cut by the vector {vector.round(3).tolist()}",
                got=f"{parts} parts in {pieces} pieces",
                expected="each part in one piece, since 'connected' is true",
                fix="flood parts along shape.adjacency, or leave the attribute out",
            )


@check("parameterization-permute", kinds=["parameterization"])
def _permute(subject: Subject) -> None:
    """Labelers say which centre gets which label; permute() is how they are obeyed."""
    for what, shape, partition in _partitions(subject):
        order = np.roll(np.arange(partition.n_parts), 1)
        vector = encoded(partition, shape, 3)
        turned = partition.permute(vector[0], order)
        before, after = _labels(partition, vector)[0], _labels(partition, turned[None])[0]
        if wrong := int((order[after] != before).sum()):
            raise ContractFailure(
                did=f"a vector for {what} was permuted by {order.tolist()}",
                got=f"{wrong} elements in a part that they were not in",
                expected="part j with the elements that part order[j] had",
                fix="put the coordinates of part order[j] in the places of part j",
            )


@check("parameterization-coordinates", kinds=["parameterization"])
def _coordinates(subject: Subject) -> None:
    """A part is frozen, or follows others, by its coordinates; those of others must be free."""
    for what, shape, partition in _partitions(subject):
        size = len(partition.lower)
        vector, other = own_encoded(partition, shape, 6, 7)
        for part in range(partition.n_parts):
            own = np.asarray(partition.coordinates(part))
            mixed = other.copy()
            legal = np.issubdtype(own.dtype, np.integer) and own.ndim == 1 and own.size > 0
            if legal and own.min() >= 0 and own.max() < size:
                mixed[own] = vector[own]
                kept = partition.decode(mixed).of(part).positions
                before = partition.decode(vector).of(part).positions
                if unlike(kept, before, tolerance=1e-6) is None:
                    continue
            raise ContractFailure(
                did=f"coordinates({part}) was asked for {what}, and all others were changed",
                got=f"{own.tolist()}, which do not keep the centre where it was",
                expected=f"all places, of 0 to {size - 1}, that decide about part {part}",
                fix="return the indices of its positions and weights in the vector",
            )


@check("parameterization-distances", kinds=["parameterization"])
def _distances(subject: Subject) -> None:
    """Boundaries are moved off the elements by distances; they must agree with the labels."""
    shape, n = cloud(), 3
    partition = made(subject, shape, n)
    if not isinstance(partition, ClippableParameterization):
        raise Skip("it does not say how far points are from its parts")
    for vector in own_encoded(partition, shape, *range(4)):
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
        wrong = int((distances.argmin(axis=1) != _labels(partition, vector[None])[0]).sum())
        if wrong:
            raise ContractFailure(
                did="labels of a cloud's points were compared with the least of their distances",
                got=f"another part for {wrong} of {shape.n_elements} points",
                expected="the same, where parts are not kept connected",
                fix="take points to unit coordinates with shape.frame.to_unit, as labels() does",
            )
