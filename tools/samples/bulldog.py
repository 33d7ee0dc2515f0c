"""The sample `bulldog`: an English bulldog that stands square, in metres.

x points forward, y up, z to the dog's right; it stands on the ground y = 0. The dog is its own
mirror image in the plane z = 0, and so is its mesh. The head has hardly a neck; the tail is a stub
and belongs to the body. Each leg starts inside the trunk, at the shoulder or the hip.
"""

from __future__ import annotations

import numpy as np

from samples.fields import (
    Field,
    FloatArray,
    blend,
    dot,
    folded,
    loft,
    mirrored,
    smooth_max,
    smooth_min,
)

GRID = 0.008
LOW = np.array([-0.45, -0.03, -0.27])
HIGH = np.array([0.58, 0.60, 0.27])
SYMMETRIC = True
FILLET = 0.04


def parts() -> dict[str, Field]:
    """Return the solids of the six parts, each without the others."""
    fore, hind = _fore_leg(), _hind_leg()
    return {
        "head": folded(_left_of_head()),
        "body": _body(),
        "leg1": fore,
        "leg2": mirrored(fore),
        "leg3": hind,
        "leg4": mirrored(hind),
    }


def whole(points: FloatArray) -> FloatArray:
    """Blend the dog into one; limbs and neck flow into the trunk."""
    return folded(_left)(points)


def size(points: FloatArray) -> FloatArray:
    """Give the length of edges: shorter towards the face and the paws, which are small."""
    face = points - np.array([0.47, 0.38, 0.0])
    near_face = 0.0115 + 0.04 * np.maximum(np.sqrt(dot(face, face)) - 0.12, 0.0)
    near_paws = 0.0115 + 0.06 * np.maximum(points[:, 1] - 0.07, 0.0)
    return np.minimum(np.minimum(near_face, near_paws), 0.0170)


def _left(points: FloatArray) -> FloatArray:
    """Blend the parts that have a left half, each with the trunk and hardly with another."""
    body = _body()(points)
    joined = [
        smooth_min(body, solid(points), FILLET)
        for solid in (_left_of_head(), _fore_leg(), _hind_leg())
    ]
    return smooth_min(smooth_min(joined[0], joined[1], 0.01), joined[2], 0.01)


def _body() -> Field:
    """A barrel of a chest, a lighter loin, and a stub of a tail."""
    trunk = loft(
        [
            (-0.26, 0.255, 0.0, 0.085, 0.085),
            (-0.18, 0.258, 0.0, 0.100, 0.105),
            (-0.05, 0.250, 0.0, 0.115, 0.125),
            (0.07, 0.235, 0.0, 0.135, 0.150),
            (0.16, 0.228, 0.0, 0.140, 0.155),
            (0.23, 0.232, 0.0, 0.110, 0.125),
        ],
        caps=(0.07, 0.06),
    )
    tail = loft(
        [
            (-0.28, 0.300, 0.0, 0.034, 0.034),
            (-0.335, 0.310, 0.0, 0.025, 0.025),
            (-0.362, 0.288, 0.0, 0.017, 0.017),
        ]
    )
    return blend([trunk, tail], 0.03)


def _left_of_head() -> Field:
    """Thick neck, broad skull, short square muzzle; brow, cheek, jowl and ear of the left side."""
    neck = loft(
        [
            (0.16, 0.290, 0.0, 0.090, 0.110),
            (0.24, 0.325, 0.0, 0.105, 0.115),
            (0.31, 0.360, 0.0, 0.105, 0.115),
        ],
    )
    skull = loft(
        [
            (0.295, 0.380, 0.0, 0.100, 0.115),
            (0.335, 0.380, 0.0, 0.112, 0.135),
            (0.390, 0.372, 0.0, 0.108, 0.128),
        ],
        caps=(0.05, 0.042),
    )
    muzzle = loft(
        [(0.38, 0.345, 0.0, 0.060, 0.094), (0.448, 0.342, 0.0, 0.048, 0.082)],
        power=4,
        caps=(None, 0.028),
    )
    jaw = loft(
        [(0.38, 0.290, 0.0, 0.042, 0.082), (0.462, 0.290, 0.0, 0.026, 0.064)],
        caps=(None, 0.028),
    )
    nose = loft([(0.455, 0.383, 0.0, 0.018, 0.030), (0.474, 0.383, 0.0, 0.016, 0.025)], steps=1)
    cheek = loft([(0.33, 0.340, -0.092, 0.06, 0.05), (0.38, 0.320, -0.094, 0.05, 0.04)], steps=1)
    jowl = loft(
        [(0.430, 0.335, -0.064, 0.032, 0.028), (0.424, 0.272, -0.078, 0.027, 0.024)], steps=1
    )
    brow = loft(
        [(0.405, 0.428, -0.082, 0.024, 0.024), (0.424, 0.432, -0.040, 0.022, 0.022)], steps=1
    )
    ear = blend(
        [
            loft(
                [(0.312, 0.435, -0.085, 0.040, 0.022), (0.314, 0.463, -0.116, 0.034, 0.019)],
                side=(0.0, 1.0, 0.0),
                steps=1,
            ),
            loft(
                [(0.314, 0.464, -0.114, 0.034, 0.019), (0.346, 0.422, -0.150, 0.018, 0.015)],
                side=(0.0, 1.0, 0.0),
                steps=1,
            ),
        ],
        0.01,
    )
    return blend([neck, skull, muzzle, jaw, nose, cheek, jowl, brow, ear], 0.018)


def _fore_leg() -> Field:
    """Shoulder, bowed forearm and paw of the left side."""
    upper = loft(
        [
            (0.135, 0.265, -0.110, 0.085, 0.055),
            (0.152, 0.195, -0.146, 0.078, 0.058),
            (0.152, 0.135, -0.164, 0.056, 0.052),
        ],
    )
    lower = loft(
        [
            (0.151, 0.145, -0.165, 0.056, 0.052),
            (0.159, 0.085, -0.160, 0.043, 0.045),
            (0.168, 0.042, -0.154, 0.042, 0.045),
        ],
    )
    return _standing([upper, lower, *_paw(0.190, -0.154)])


def _hind_leg() -> Field:
    """Thigh, hock and paw of the left side."""
    thigh = loft(
        [
            (-0.225, 0.255, -0.075, 0.095, 0.055),
            (-0.206, 0.197, -0.100, 0.087, 0.062),
            (-0.188, 0.140, -0.122, 0.060, 0.048),
        ],
    )
    shank = loft(
        [
            (-0.190, 0.150, -0.122, 0.056, 0.047),
            (-0.236, 0.092, -0.124, 0.043, 0.040),
            (-0.241, 0.042, -0.124, 0.039, 0.040),
        ],
    )
    return _standing([thigh, shank, *_paw(-0.220, -0.124)])


def _paw(x: float, z: float) -> list[Field]:
    """Make a paw with three toes, which reach into the ground."""
    pad = loft(
        [(x - 0.004, 0.055, z, 0.038, 0.040), (x + 0.002, 0.0, z, 0.048, 0.046)],
        caps=(0.02, 0.02),
        steps=1,
    )
    toes = [
        loft(
            [(x + 0.02, 0.034, z + out, 0.019, 0.015), (x + ahead, 0.016, z + out, 0.022, 0.015)],
            caps=(None, 0.014),
            steps=1,
        )
        for out, ahead in ((-0.032, 0.040), (0.0, 0.054), (0.032, 0.040))
    ]
    return [blend(toes, 0.004), pad]


def _standing(solids: list[Field]) -> Field:
    """Blend the pieces of a leg and cut it level with the ground."""
    leg = blend(solids, 0.02)
    return lambda points: smooth_max(leg(points), -points[:, 1], 0.010)
