"""The sample `bulldog`: an English bulldog that stands square, in metres.

x points forward, y up, z to the dog's right; it stands on the ground y = 0. The dog is its own
mirror image in the plane z = 0, and so is its mesh. The head has hardly a neck; the tail is a stub
and belongs to the body. Each leg starts inside the trunk, at the shoulder or the hip.
"""

from __future__ import annotations

import numpy as np

from samples.fields import Field, FloatArray, blend, dot, folded, loft, mirrored, smooth_min

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
    near_face = 0.0105 + 0.04 * np.maximum(np.sqrt(dot(face, face)) - 0.12, 0.0)
    near_paws = 0.0105 + 0.06 * np.maximum(points[:, 1] - 0.07, 0.0)
    return np.minimum(np.minimum(near_face, near_paws), 0.0165)


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
            (-0.27, 0.285, 0.0, 0.085, 0.085),
            (-0.18, 0.290, 0.0, 0.100, 0.105),
            (-0.05, 0.285, 0.0, 0.115, 0.125),
            (0.08, 0.270, 0.0, 0.135, 0.150),
            (0.17, 0.262, 0.0, 0.140, 0.150),
            (0.24, 0.265, 0.0, 0.110, 0.120),
        ],
        caps=(0.07, 0.06),
    )
    tail = loft(
        [
            (-0.29, 0.330, 0.0, 0.034, 0.034),
            (-0.345, 0.345, 0.0, 0.026, 0.026),
            (-0.375, 0.325, 0.0, 0.017, 0.017),
        ]
    )
    return blend([trunk, tail], 0.03)


def _left_of_head() -> Field:
    """Thick neck, broad skull, short square muzzle; brow, cheek, jowl and ear of the left side."""
    neck = loft(
        [
            (0.17, 0.325, 0.0, 0.090, 0.105),
            (0.25, 0.365, 0.0, 0.100, 0.108),
            (0.33, 0.405, 0.0, 0.095, 0.105),
        ],
    )
    skull = loft(
        [
            (0.315, 0.425, 0.0, 0.095, 0.108),
            (0.355, 0.425, 0.0, 0.105, 0.122),
            (0.405, 0.418, 0.0, 0.100, 0.118),
        ],
        caps=(0.05, 0.05),
    )
    muzzle = loft(
        [(0.40, 0.385, 0.0, 0.062, 0.088), (0.468, 0.382, 0.0, 0.050, 0.076)],
        power=4,
        caps=(None, 0.032),
    )
    jaw = loft(
        [(0.40, 0.335, 0.0, 0.040, 0.075), (0.478, 0.335, 0.0, 0.026, 0.058)],
        caps=(None, 0.030),
    )
    nose = loft([(0.478, 0.420, 0.0, 0.018, 0.028), (0.494, 0.420, 0.0, 0.016, 0.024)], steps=1)
    cheek = loft([(0.36, 0.385, -0.085, 0.06, 0.05), (0.40, 0.365, -0.085, 0.05, 0.04)], steps=1)
    jowl = loft(
        [(0.435, 0.375, -0.062, 0.030, 0.026), (0.440, 0.322, -0.072, 0.026, 0.022)], steps=1
    )
    brow = loft([(0.42, 0.470, -0.075, 0.022, 0.024), (0.44, 0.472, -0.035, 0.020, 0.022)], steps=1)
    ear = loft(
        [
            (0.335, 0.490, -0.080, 0.034, 0.020),
            (0.325, 0.525, -0.108, 0.034, 0.016),
            (0.340, 0.522, -0.140, 0.028, 0.013),
            (0.355, 0.492, -0.153, 0.016, 0.011),
        ],
        side=(0.0, 1.0, 0.0),
    )
    return blend([neck, skull, muzzle, jaw, nose, cheek, jowl, brow, ear], 0.018)


def _fore_leg() -> Field:
    """Shoulder, bowed forearm and paw of the left side."""
    limb = loft(
        [
            (0.150, 0.300, -0.105, 0.085, 0.055),
            (0.165, 0.225, -0.142, 0.076, 0.056),
            (0.160, 0.160, -0.158, 0.054, 0.050),
            (0.170, 0.090, -0.152, 0.041, 0.043),
            (0.182, 0.045, -0.148, 0.040, 0.043),
        ],
    )
    return blend([limb, *_paw(0.200, -0.148)], 0.02)


def _hind_leg() -> Field:
    """Thigh, hock and paw of the left side."""
    limb = loft(
        [
            (-0.230, 0.290, -0.075, 0.100, 0.055),
            (-0.205, 0.220, -0.106, 0.088, 0.056),
            (-0.205, 0.160, -0.118, 0.062, 0.048),
            (-0.250, 0.105, -0.118, 0.041, 0.038),
            (-0.252, 0.045, -0.118, 0.036, 0.038),
        ],
    )
    return blend([limb, *_paw(-0.234, -0.118)], 0.02)


def _paw(x: float, z: float) -> list[Field]:
    """Make a paw with a flat sole and four toes."""
    pad = loft(
        [(x - 0.004, 0.055, z, 0.036, 0.038), (x + 0.004, 0.0, z, 0.050, 0.046)],
        caps=(0.02, None),
        flat=(None, 0.012),
        steps=1,
    )
    toes = [
        loft(
            [(x + 0.02, 0.032, z + out, 0.017, 0.0125), (x + ahead, 0.0185, z + out, 0.017, 0.0125)],
            caps=(None, 0.014),
            steps=1,
        )
        for out, ahead in ((-0.036, 0.040), (-0.012, 0.052), (0.012, 0.052), (0.036, 0.040))
    ]
    return [blend(toes, 0.006), pad]
