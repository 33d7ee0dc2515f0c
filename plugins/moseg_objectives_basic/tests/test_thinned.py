"""Surface distances of coarse parts: near the exact ones, and from fewer samples."""

from __future__ import annotations

import numpy as np
import pytest
from moseg_objectives_basic.convexity import hull_volume
from moseg_objectives_basic.ellipsoid import ellipsoidal
from moseg_objectives_basic.surface_distance import surface_samples
from moseg_objectives_basic.symmetry import planar_symmetric

import moseg_core as moseg
from moseg_core import Segmentation, coarsen
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Centers
from moseg_core.io import read_labels


def labellings(shape, coarse, name):
    """The true labels, and random Voronoi partitions."""
    truth = read_labels(moseg.sample_labels_path(name), shape.n_elements).labels
    by_piece = [np.bincount(truth[coarse.members == k]).argmax() for k in range(coarse.n_elements)]
    yield np.array(by_piece), len(set(by_piece))
    rng = np.random.default_rng(5)
    voronoi = Voronoi(coarse, 6)
    for _ in range(3):
        at = coarse.points[rng.choice(coarse.n_elements, 6, replace=False)]
        vector = voronoi.encode(Centers(positions=at, weights=np.ones(6)))
        yield voronoi.labels(vector[None])[0], 6


@pytest.mark.parametrize("name", ["hammer", "horse"])
def test_values_are_near_the_exact_ones(name):
    shape = moseg.load(moseg.sample_path(name))
    coarse = coarsen(shape, 2000)
    fewer = 0
    for labels, n in labellings(shape, coarse, name):
        rough = Segmentation.from_labels(coarse, labels, n).parts
        exact = Segmentation.from_labels(shape, labels[coarse.members], n).parts
        for a, b in zip(rough, exact, strict=True):
            for value in (planar_symmetric, ellipsoidal):
                assert value(a) == pytest.approx(value(b), rel=0.05, abs=5e-5)
            assert hull_volume(a) == pytest.approx(hull_volume(b), rel=1e-7)
            points, weights = surface_samples(a)
            assert len(points) == len(weights)
            assert weights.sum() == pytest.approx(a.area, rel=1e-9)
            fewer += len(points) < len(surface_samples(b)[0]) * 0.7
    assert fewer >= 5
