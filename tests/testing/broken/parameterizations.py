"""Parameterizations that are broken in one way each."""

from __future__ import annotations

import numpy as np

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.specs import ParameterizationSpec
from moseg_core.components.protocols import Centers
from tests.testing.sound import Bodies

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

SEVERAL_CENTERS = {
    id: ParameterizationSpec(name="broken", target=f"tests.testing.broken.parameterizations:{name}")
    for id, name in {
        "parameterization-encode-decode": "DecodesTheFirst",
        "parameterization-permute": "OthersElsewhere",
        "parameterization-coordinates": "CoordinatesOfTheFirst",
        "parameterization-connected": "KeepsAllPieces",
        "parameterization-distances": "DistancesOfTheFirst",
    }.items()
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


# --- several centres a part ----------------------------------------------------------------------


class DecodesTheFirst(Bodies):
    """One centre a part, whatever it says."""

    def decode(self, vector):
        return super().decode(vector).first


class OthersElsewhere(Bodies):
    """The other centres of the first part begin beside the first, so that they change its cell."""

    def encode(self, centers):
        rows = super().encode(centers).reshape(-1, 4)
        if centers.parts is None:
            rows[1:3, 0] += [0.3, -0.3]
        return rows.reshape(-1)


class CoordinatesOfTheFirst(Bodies):
    """Coordinates of one centre of several."""

    def coordinates(self, part):
        return super().coordinates(part)[:4]


class KeepsAllPieces(Bodies):
    """What the centres of a part reach is its own, wherever it is."""

    def labels(self, vectors):
        per_part = self.centers_per_part
        alone = Voronoi(self._shape, int(per_part.sum())).labels(vectors)
        return np.repeat(np.arange(len(per_part), dtype=np.int32), per_part)[alone]


class DistancesOfTheFirst(Bodies):
    """Distances from one centre of several."""

    def distances(self, vector, points):
        first = self.decode(vector).first
        return Voronoi(self._shape, self.n_parts).distances(
            Voronoi(self._shape, self.n_parts).encode(first), points
        )
