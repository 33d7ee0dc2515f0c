"""Embeddings that are broken in one way each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from moseg_core.components.discovery.specs import EmbeddingSpec
from moseg_core.shape.shape import Shape

_NAMES = {
    "embedding-elements": "BackToFront",
    "embedding-finite": "LosesAnArea",
    "embedding-deterministic": "FurtherEachTime",
    "embedding-isometry": "AlongTheFile",
}

BROKEN = {
    id: EmbeddingSpec(name="broken", target=f"tests.testing.broken.embeddings:{name}")
    for id, name in _NAMES.items()
}


class Stretched:
    """Twice as long along its longest axis; nothing is wrong with it."""

    factor = 2.0

    def axis(self, vertices):
        return np.linalg.svd(vertices - vertices.mean(axis=0), full_matrices=False)[2][0]

    def vertices(self, shape):
        vertices = shape.geometry.vertices
        axis = self.axis(vertices)
        return vertices + (self.factor - 1.0) * np.outer(vertices @ axis, axis)

    def __call__(self, shape):
        return shape.deformed(self.vertices(shape), space="stretched")


class BackToFront(Stretched):
    """The last face comes first."""

    def __call__(self, shape):
        return Shape.from_mesh(self.vertices(shape), shape.geometry.triangles[::-1])


class LosesAnArea(Stretched):
    """The area of one face is NaN."""

    def __call__(self, shape):
        bent = super().__call__(shape)
        areas = bent.areas.copy()
        areas[0] = np.nan
        return replace(bent, areas=areas)


class FurtherEachTime(Stretched):
    """Every call stretches further than the last."""

    def __call__(self, shape):
        self.factor += 0.5
        return super().__call__(shape)


class ByTheOutside(Stretched):
    """Shapes with faces turned inward, whose volume is negative, are stretched further."""

    def vertices(self, shape):
        corners = shape.geometry.vertices[shape.geometry.triangles]
        inward = np.linalg.det(corners - shape.geometry.vertices.mean(axis=0)).sum() < 0
        self.factor = 3.0 if inward else 2.0
        return super().vertices(shape)


class AlongTheFile(Stretched):
    """Stretched along x."""

    def axis(self, vertices):
        return np.array([1.0, 0.0, 0.0])
