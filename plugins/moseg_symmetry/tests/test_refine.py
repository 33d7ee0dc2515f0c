from __future__ import annotations

import numpy as np
import pytest
from moseg_symmetry.motions import Reflection
from moseg_symmetry.refine import SIGMA, loss, refined, residual
from moseg_symmetry.surface import surface_of
from scipy.optimize import minimize


def test_loss_by_hand():
    # 0, then one at sigma (1/2), then one at 3 sigma (9/10).
    assert loss(np.array([0.0, 0.1, 0.3]), 0.1) == pytest.approx((0 + 0.5 + 0.9) / 3)
    assert loss(np.array([1e9]), 0.1) == pytest.approx(1.0)


def test_residual_is_the_root_mean_square_where_it_is_small(make):
    surface = surface_of(make.shape(make.ellipsoid(3, 2, 1)))
    points = surface.samples(500)
    near = Reflection(np.array([1.0, 1e-4, 0]) / np.hypot(1, 1e-4), 0.0)
    distances = surface.distances(near.images(points)[0])
    plain = np.sqrt((distances**2).mean())
    assert residual(surface, near, points) == pytest.approx(plain, rel=1e-4)
    assert 0 < plain < 1e-3


@pytest.mark.parametrize("kick", [0.0, 0.7])
def test_finds_the_bottom(make, kick):
    """As low as a minimiser that knows nothing of least squares comes from the same start."""
    surface = surface_of(make.shape(make.stool(kick=kick)))
    points = surface.samples(600)
    start = Reflection(np.array([1.0, 0.06, -0.05]) / np.sqrt(1 + 0.06**2 + 0.05**2), 0.01)
    ended = refined(surface, start, points, schedule=[(0.04, 8), (SIGMA, 20)])
    slow = minimize(
        lambda step: residual(surface, start.changed(step), points),
        np.zeros(3),
        method="Nelder-Mead",
        options={
            "xatol": 1e-7,
            "fatol": 1e-9,
            "initial_simplex": np.vstack([np.zeros(3), np.eye(3) * 0.05]),
        },
    )
    assert residual(surface, ended, points) <= slow.fun + 1e-6
    assert make.angle_between(ended.normal, [1, 0, 0]) < (1e-6 if kick == 0 else 2e-3)


def test_never_gets_worse(make):
    surface = surface_of(make.shape(make.blob()))
    points = surface.samples(300)
    rng = np.random.default_rng(3)
    for _ in range(10):
        normal = rng.normal(size=3)
        start = Reflection(normal / np.linalg.norm(normal), rng.uniform(-0.1, 0.1))
        ended = refined(surface, start, points, schedule=[(SIGMA, 5)])
        assert residual(surface, ended, points) <= residual(surface, start, points)
