"""Generalised winding numbers: how often a surface, open or in pieces, goes around a point.

Of a surface the winding number at ``q`` is the solid angle under which it is seen from there, with
the sign of the side that is seen, over ``4 pi``: 1 inside and 0 outside of a closed surface that
is oriented outward, and something between where there are gaps (Jacobson, Kavan and
Sorkine-Hornung 2013, doi:10.1145/2461912.2461916). A triangle's solid angle is that of Van
Oosterom and Strackee (1983, doi:10.1109/TBME.1983.325207). A point of a cloud with normal ``n`` and
area ``A`` counts as a dipole ``A n . (x - q) / 4 pi d^3``, with ``d^2 = |x - q|^2 + e^2`` so that
it stays finite nearby.

Pieces of surface that are far away in proportion to their extent are seen as one dipole, as in
Barill et al. (2018, doi:10.1145/3197517.3201337, first order): a tree holds the dipole of every
box of pieces. :mod:`moseg_core.shape.volume.estimated` makes the tree and asks.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, IntArray


@kernel
def _solid_angle(corners: FloatArray, qx: Any, qy: Any, qz: Any) -> Any:
    """Signed solid angle of a (3, 3) triangle from q; positive from behind its front."""
    ax, ay, az = corners[0, 0] - qx, corners[0, 1] - qy, corners[0, 2] - qz
    bx, by, bz = corners[1, 0] - qx, corners[1, 1] - qy, corners[1, 2] - qz
    cx, cy, cz = corners[2, 0] - qx, corners[2, 1] - qy, corners[2, 2] - qz
    a = np.sqrt(ax * ax + ay * ay + az * az)
    b = np.sqrt(bx * bx + by * by + bz * bz)
    c = np.sqrt(cx * cx + cy * cy + cz * cz)
    triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    below = (
        a * b * c
        + (ax * bx + ay * by + az * bz) * c
        + (bx * cx + by * cy + bz * cz) * a
        + (cx * ax + cy * ay + cz * az) * b
    )
    return 2.0 * np.arctan2(triple, below)


@kernel
def winding_numbers(
    queries: FloatArray,
    places: FloatArray,
    dipoles: FloatArray,
    softening: FloatArray,
    corners: FloatArray,
    starts: IntArray,
    stops: IntArray,
    skips: IntArray,
    box_places: FloatArray,
    box_dipoles: FloatArray,
    box_radii: FloatArray,
    far: float,
    winding: FloatArray,
) -> None:
    """The winding number of a surface around each of some points.

    Parameters
    ----------
    queries : (Q, 3) float
    places, dipoles : (P, 3) float
        Of each piece of surface where it is, and its area times its unit normal; pieces in the
        order of the tree.
    softening : (P,) float
        Squared length ``e^2`` of each piece; only used where there are no corners.
    corners : (P, 3, 3) float, or (0, 3, 3)
        The pieces as triangles; none where they are points.
    starts, stops : (B,) int
        The pieces of each box of the tree, boxes before those that they contain.
    skips : (B,) int
        The number of the next box that is not within this one.
    box_places, box_dipoles : (B, 3) float
        Where the dipole of all pieces of a box is, and their sum.
    box_radii : (B,) float
        Greatest distance of a piece's far end from there.
    far : float
        A box is seen as one dipole from more than so many radii; infinite for the exact sum.
    winding : (Q,) float, written
    """
    for q in range(queries.shape[0]):
        qx, qy, qz = queries[q, 0], queries[q, 1], queries[q, 2]
        angle = 0.0
        box = 0
        while box < starts.shape[0]:
            dx, dy, dz = (
                box_places[box, 0] - qx,
                box_places[box, 1] - qy,
                box_places[box, 2] - qz,
            )
            square = dx * dx + dy * dy + dz * dz
            reach = far * box_radii[box]
            if square > reach * reach:
                dot = dx * box_dipoles[box, 0] + dy * box_dipoles[box, 1] + dz * box_dipoles[box, 2]
                angle += dot / (square * np.sqrt(square))
                box = skips[box]
                continue
            if skips[box] == box + 1:  # a leaf
                for p in range(starts[box], stops[box]):
                    if corners.shape[0] > 0:
                        angle += _solid_angle(corners[p], qx, qy, qz)
                    else:
                        px, py, pz = places[p, 0] - qx, places[p, 1] - qy, places[p, 2] - qz
                        soft = px * px + py * py + pz * pz + softening[p]
                        dot = px * dipoles[p, 0] + py * dipoles[p, 1] + pz * dipoles[p, 2]
                        if soft > 0.0:
                            angle += dot / (soft * np.sqrt(soft))
            box += 1
        winding[q] = angle / (4.0 * np.pi)
