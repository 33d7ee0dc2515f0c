"""The sample `horse`: a horse at the walk, in metres.

x points forward, y up, z to the horse's right; it stands on the ground y = 0. The trunk and the
tail are the body. The neck, with its mane, counts as head. Each leg starts inside the trunk, at the
shoulder or the hip, and no two legs are alike: one fore leg has just been set down, one hind leg
swings forward, and the others push back.
"""

from __future__ import annotations

import numpy as np

from samples.fields import Field, FloatArray, blend, dot, loft, smooth_min

GRID = 0.022
LOW = np.array([-1.25, -0.12, -0.48])
HIGH = np.array([1.55, 2.35, 0.48])
SYMMETRIC = False
FILLET = 0.09


def parts() -> dict[str, Field]:
    """Return the solids of the six parts, each without the others."""
    return {
        "head": _head(),
        "body": _body(),
        "leg1": _fore_leg(-1.0, elbow=0.42, knee=(0.585, 0.50), foot=(0.645, 0.20, 0.71, 0.0)),
        "leg2": _fore_leg(1.0, elbow=0.36, knee=(0.31, 0.49), foot=(0.17, 0.205, 0.215, 0.0)),
        "leg3": _hind_leg(-1.0, stifle=-0.44, hock=(-0.84, 0.55), foot=(-0.975, 0.21, -0.93, 0.0)),
        "leg4": _hind_leg(
            1.0, stifle=-0.345, hock=(-0.60, 0.535), foot=(-0.555, 0.225, -0.52, 0.045), tilt=0.035
        ),
    }


def whole(points: FloatArray) -> FloatArray:
    """Blend the horse into one; limbs and neck flow into the trunk."""
    solids = parts()
    body = solids.pop("body")(points)
    joined = [smooth_min(body, solid(points), FILLET) for solid in solids.values()]
    # Legs are blended with the trunk, but hardly with each other.
    result = joined[0]
    for other in joined[1:]:
        result = smooth_min(result, other, 0.02)
    return result


def size(points: FloatArray) -> FloatArray:
    """Give the length of edges: shorter towards the ears and the feet, which are small."""
    head = points - np.array([1.02, 2.12, 0.0])
    near_ears = 0.018 + 0.08 * np.maximum(np.sqrt(dot(head, head)) - 0.10, 0.0)
    near_feet = 0.024 + 0.08 * np.maximum(points[:, 1] - 0.15, 0.0)
    return np.minimum(np.minimum(near_ears, near_feet), 0.040)


def _body() -> Field:
    """Trunk with withers and croup, and a tail that hangs clear of the legs."""
    trunk = loft(
        [
            (-0.70, 1.23, 0.0, 0.20, 0.16),
            (-0.52, 1.235, 0.0, 0.265, 0.24),
            (-0.25, 1.18, 0.0, 0.305, 0.275),
            (0.05, 1.15, 0.0, 0.335, 0.28),
            (0.32, 1.16, 0.0, 0.345, 0.25),
            (0.52, 1.15, 0.0, 0.29, 0.20),
        ],
        caps=(0.14, 0.15),
    )
    withers = loft([(0.12, 1.40, 0.0, 0.10, 0.06), (0.36, 1.45, 0.0, 0.09, 0.06)], steps=1)
    croup = loft([(-0.64, 1.33, 0.0, 0.13, 0.16), (-0.40, 1.365, 0.0, 0.12, 0.17)], steps=1)
    tail = loft(
        [
            (-0.76, 1.37, 0.0, 0.050, 0.050),
            (-0.86, 1.36, 0.0, 0.046, 0.046),
            (-0.94, 1.26, 0.010, 0.050, 0.046),
            (-0.98, 1.08, 0.025, 0.064, 0.052),
            (-1.00, 0.86, 0.040, 0.074, 0.056),
            (-1.02, 0.66, 0.045, 0.056, 0.046),
            (-1.06, 0.50, 0.045, 0.020, 0.020),
        ],
    )
    return blend([trunk, withers, croup, tail], 0.08)


def _head() -> Field:
    """Neck, mane, skull with brows and muzzle, and ears."""
    neck = loft(
        [
            (0.34, 1.25, 0.0, 0.27, 0.155),
            (0.56, 1.43, 0.0, 0.225, 0.13),
            (0.74, 1.66, 0.0, 0.165, 0.10),
            (0.87, 1.85, 0.0, 0.125, 0.085),
            (0.96, 1.93, 0.0, 0.105, 0.08),
        ],
    )
    skull = loft(
        [
            (0.985, 1.915, 0.0, 0.100, 0.085),
            (1.06, 1.83, 0.0, 0.125, 0.098),
            (1.15, 1.735, 0.0, 0.112, 0.090),
            (1.25, 1.625, 0.0, 0.084, 0.072),
            (1.325, 1.54, 0.0, 0.082, 0.074),
            (1.365, 1.495, 0.0, 0.076, 0.070),
        ],
        caps=(0.08, 0.045),
    )
    jaw = loft([(1.01, 1.765, 0.0, 0.090, 0.085), (1.13, 1.665, 0.0, 0.055, 0.065)], steps=1)
    mane = loft(
        [
            (0.41, 1.585, 0.012, 0.050, 0.042),
            (0.595, 1.785, 0.020, 0.060, 0.044),
            (0.76, 1.965, 0.016, 0.060, 0.044),
            (0.88, 2.045, 0.008, 0.054, 0.040),
            (0.985, 2.030, 0.0, 0.042, 0.036),
            (1.055, 1.955, 0.0, 0.025, 0.034),
        ],
    )
    brows = [
        loft([(1.085, 1.875, z, 0.03, 0.03), (1.115, 1.84, z, 0.028, 0.028)], steps=1)
        for z in (-0.072, 0.072)
    ]
    return blend([blend([neck, skull, jaw], 0.06), mane, *brows, *_ears()], 0.03)


def _ears() -> list[Field]:
    """Two ears, one turned a little more to the front."""
    return [
        loft(
            [
                (0.955, 1.985, 0.055 * side, 0.034, 0.032),
                (0.975, 2.09, 0.072 * side, 0.040, 0.036),
                (1.00 + ahead, 2.175, 0.078 * side, 0.026, 0.024),
                (1.015 + ahead, 2.215, 0.076 * side, 0.014, 0.014),
            ],
        )
        for side, ahead in ((-1.0, 0.0), (1.0, 0.015))
    ]


def _fore_leg(
    side: float, *, elbow: float, knee: tuple[float, float], foot: tuple[float, float, float, float]
) -> Field:
    """Shoulder, forearm, knee, cannon and foot, at an x or an (x, y) each."""
    z = 0.155 * side
    fetlock = foot[:2]
    shoulder = loft(
        [
            (0.42, 1.22, 0.125 * side, 0.10, 0.075),
            (0.49, 1.08, 0.145 * side, 0.13, 0.09),
            (elbow + 0.02, 0.93, z, 0.12, 0.088),
        ],
    )
    limb = loft(
        [
            (elbow, 0.97, z, 0.125, 0.09),
            ((elbow + knee[0]) / 2.0 - 0.01, 0.74, z, 0.088, 0.074),
            (knee[0], knee[1], 0.145 * side, 0.066, 0.060),
            ((knee[0] + fetlock[0]) / 2.0 - 0.008, (knee[1] + fetlock[1]) / 2.0, z, 0.046, 0.044),
            (fetlock[0], fetlock[1], z, 0.056, 0.050),
        ],
    )
    return blend([shoulder, limb, *_foot(foot, z, 0.0)], 0.04)


def _hind_leg(
    side: float,
    *,
    stifle: float,
    hock: tuple[float, float],
    foot: tuple[float, float, float, float],
    tilt: float = 0.0,
) -> Field:
    """Thigh, gaskin, hock, cannon and foot, at an x or an (x, y) each."""
    z = 0.155 * side
    fetlock = foot[:2]
    thigh = loft(
        [
            (-0.58, 1.28, 0.12 * side, 0.17, 0.10),
            ((stifle - 0.58) / 2.0 - 0.03, 1.06, 0.15 * side, 0.185, 0.115),
            (stifle - 0.04, 0.90, z, 0.13, 0.10),
        ],
    )
    limb = loft(
        [
            (stifle - 0.06, 0.98, z, 0.15, 0.10),
            ((stifle + hock[0]) / 2.0 - 0.01, 0.745, z, 0.098, 0.076),
            (hock[0], hock[1], 0.148 * side, 0.072, 0.058),
            ((hock[0] + fetlock[0]) / 2.0, (hock[1] + fetlock[1]) / 2.0, z, 0.052, 0.048),
            (fetlock[0], fetlock[1], z, 0.058, 0.052),
        ],
    )
    return blend([thigh, limb, *_foot(foot, z, tilt)], 0.04)


def _foot(foot: tuple[float, float, float, float], z: float, tilt: float) -> list[Field]:
    """Pastern and hoof, from the fetlock (x, y) to the middle of the sole (x, y).

    The hoof is a blunt cone with a flat sole, which `tilt` raises at the heel.
    """
    x, y, sole_x, sole_y = foot
    top = (sole_x + tilt, sole_y + 0.09)
    pastern = loft(
        [(x, y, z, 0.050, 0.046), (top[0] - 0.01, top[1] + 0.01, z, 0.048, 0.046)], steps=1
    )
    hoof = loft(
        [(*top, z, 0.054, 0.052), (sole_x, sole_y, z, 0.086, 0.078)],
        caps=(0.03, None),
        flat=(None, 0.015),
        steps=1,
    )
    return [pastern, hoof]
