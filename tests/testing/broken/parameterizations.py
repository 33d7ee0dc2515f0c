"""Parameterizations that are broken in one way each."""

from __future__ import annotations

import numpy as np

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.specs import ParameterizationSpec
from moseg_core.components.protocols import Centers

_NAMES = {
    "parameterization-bounds": "StepsOfNothing",
    "parameterization-labels": "LongLabels",
    "parameterization-batch": "BufferUsedAgain",
    "parameterization-encode-decode": "DecodesToUnits",
    "parameterization-element-order": "FirstElementIsSpecial",
    "parameterization-connected": "ClaimsToBeConnected",
    "parameterization-permute": "ForgetsWeights",
    "parameterization-coordinates": "CoordinatesOfOthers",
    "parameterization-distances": "DistancesWithoutWeights",
}

BROKEN = {
    id: ParameterizationSpec(name="broken", target=f"tests.testing.broken.parameterizations:{name}")
    for id, name in _NAMES.items()
}


class StepsOfNothing(Voronoi):
    """The scale of a weight is 0."""

    @property
    def scale(self):
        return np.tile([1.0, 1.0, 1.0, 0.0], self.n_parts)


class LongLabels(Voronoi):
    """int64 instead of int32."""

    def labels(self, vectors):
        return super().labels(vectors).astype(np.int64)


class BufferUsedAgain(Voronoi):
    """All rows of a batch are its first."""

    def labels(self, vectors):
        labels = super().labels(vectors)
        labels[1:] = labels[0]
        return labels


class DecodesToUnits(Voronoi):
    """Decoded positions stay in unit coordinates."""

    def decode(self, vector):
        rows = vector.reshape(-1, 4)
        return Centers(positions=rows[:, :3].copy(), weights=rows[:, 3].copy())


class FirstElementIsSpecial(Voronoi):
    """The first face of a mesh belongs to the part of the second, wherever it is."""

    def __init__(self, shape, n_parts):
        super().__init__(shape, n_parts, connected=False)

    def labels(self, vectors):
        labels = super().labels(vectors)
        if self._shape.adjacency is not None:
            labels[:, 0] = labels[:, 1]
        return labels


class ClaimsToBeConnected(Voronoi):
    """Parts fall to pieces, and it says that they do not."""

    def labels(self, vectors):
        return Voronoi(self._shape, self.n_parts, connected=False).labels(vectors)


class ForgetsWeights(Voronoi):
    """Positions change places, weights stay."""

    def permute(self, vector, order):
        rows = vector.reshape(-1, 4).copy()
        rows[:, :3] = rows[order, :3]
        return rows.reshape(-1)


class CoordinatesOfOthers(Voronoi):
    """Coordinates as if each part had one number."""

    def coordinates(self, part):
        return np.arange(part, part + 4)


class DistancesWithoutWeights(Voronoi):
    """Distances as if all weights were 1."""

    def distances(self, vector, points):
        rows = vector.reshape(-1, 4).copy()
        rows[:, 3] = 1.0
        return super().distances(rows.reshape(-1), points)
