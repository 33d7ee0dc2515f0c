r"""A motion that nearly maps a surface onto itself, improved until it does so best.

The measure is robust, since much of a surface may have no counterpart at all: a leg that steps
forward while the other steps back. A point whose image comes to lie ``d`` from the surface counts
as ``rho(d) = d^2 / (d^2 + sigma^2)``: nearly as its square where ``d`` is small, and as no more
than 1 however far it is (Geman and McClure). The *residual* of a motion is

    r = sigma sqrt( mean rho(d) )

the root mean square of distances, with each of them counted as ``sigma`` at most. 0 is best.

It is minimised as Simari, Kalogerakis and Singh (2006, "Folding meshes", SGP) minimise theirs:
by least squares in which each point has the weight ``rho'(d) / d`` of the round before. Distances
are taken to the tangent plane at the nearest point of the surface, so that a surface may slide
along itself (Chen and Medioni 1992, doi:10.1016/0262-8856(92)90066-C), and steps are damped until
the true residual falls (Levenberg and Marquardt). A large ``sigma`` first sees far, a smaller one
then sees what agrees exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from moseg_symmetry.motions import Motion
from moseg_symmetry.surface import Surface

FloatArray = npt.NDArray[np.float64]
M = TypeVar("M", bound=Motion)

#: Distances count as no more than this in what is reported, in sizes.
SIGMA = 0.02

_CONVERGED = 1e-9
#: What is left of an exact symmetry by rounding.
_EXACT = 1e-16


def loss(distances: npt.NDArray[np.floating], sigma: float) -> npt.NDArray[np.floating]:
    """Mean of ``rho(d)`` over the last axis; 0 is best, 1 worst."""
    squared = distances * distances
    mean: npt.NDArray[np.floating] = (squared / (squared + sigma * sigma)).mean(axis=-1)
    return mean


def residual(surface: Surface, motion: Motion, points: FloatArray, sigma: float = SIGMA) -> float:
    """``sigma sqrt(mean rho)``, in sizes: 0 is best, `sigma` worst."""
    distances = surface.distances(motion.images(points).reshape(-1, 3))
    return sigma * float(np.sqrt(loss(distances, sigma)))


def refined(
    surface: Surface,
    motion: M,
    points: FloatArray,
    *,
    schedule: Sequence[tuple[float, int]],
    worth: float = 1e-6,
) -> M:
    """The motion at the nearest minimum of the residual.

    Parameters
    ----------
    surface : Surface
    motion : Motion
        Where to start.
    points : (k, 3) float
        Samples of the surface.
    schedule : sequence of (float, int)
        For each stage ``sigma`` and the most rounds.
    worth : float
        A stage ends with a round that gains no more than this share of the loss.
    """
    for sigma, rounds in schedule:
        motion = _minimized(surface, motion, points, sigma, rounds, worth)
    return motion


def _minimized(
    surface: Surface, motion: M, points: FloatArray, sigma: float, rounds: int, worth: float
) -> M:
    damping = 1e-3
    images = motion.images(points).reshape(-1, 3)
    distance, triangle, feet = surface.nearest(images)
    best = loss(distance, sigma)
    for _ in range(rounds):
        if best < _EXACT:
            break
        normals = surface.normals[triangle]
        weights = 1.0 / (1.0 + (distance / sigma) ** 2) ** 2
        gap = ((images - feet) * normals).sum(axis=1)
        tangents = motion.tangents(points).reshape(-1, len(images), 3)
        slopes = (tangents * normals).sum(axis=2)
        matrix = (slopes * weights) @ slopes.T
        gradient = (slopes * weights) @ gap
        diagonal = np.diag(matrix) + 1e-9 * (1.0 + np.trace(matrix))
        for _ in range(5):
            step = -np.linalg.solve(matrix + damping * np.diag(diagonal), gradient)
            trial = motion.changed(step)
            trial_images = trial.images(points).reshape(-1, 3)
            answer = surface.nearest(trial_images)
            value = loss(answer[0], sigma)
            if value < best:
                break
            damping *= 10.0
        else:
            return motion
        gain = (best - value) / best
        motion, images, best = trial, trial_images, value
        distance, triangle, feet = answer
        damping /= 10.0
        if np.abs(step).max() < _CONVERGED or gain < worth:
            break
    return motion
