r"""Position: where in the whole shape a place lies, and which way it faces.

The surroundings of a chair's back are like those of its seat; what tells them apart is that one
lies outside and faces along the chair, the other amid it and faces across. Positions are told from
the shape's own centre and axes, so that they do not change when it is moved, turned or reflected.

With the distance ``q`` of a place from the centroid, its outward unit normal ``n`` and the
covariance ``C`` of the surface, whose greatest eigenvalue is ``l``, they are ::

    from_center    |q|
    lengthwise     sqrt(q.C q / l)
    from_axis      sqrt(q.(1 - C / l) q)
    outward        n.q / |q|
    facing_along   n.C n / tr C
    facing_across  n.C^-1 n / tr C^-1

On a rod the second is the distance from its middle along the axis, and the third that from the
axis. Coordinates along principal axes would say the same, but those of a vase or a box are not
determined where two axes are alike; these are steady functions of the covariance, and do not care.
"""

from __future__ import annotations

import numpy as np

from moseg_core import Shape
from moseg_learn.neighbourhoods import FloatArray, Neighbourhoods
from moseg_learn.normals import group_normals, unit

POSITIONS = (
    *("from_center", "lengthwise", "from_axis"),
    *("outward", "facing_along", "facing_across"),
)
"""What there is to know of a position, in the order of the columns of :func:`positions`."""

_FLAT = 1e-4
"""What eigenvalues of the covariance are at least, as a share of their sum: a sheet has one of 0,
whose inverse would be all that counts."""


def positions(shape: Shape) -> FloatArray:
    """All quantities of the position of each group of elements.

    Parameters
    ----------
    shape : Shape
        As the user gave it: a surface of which is known which elements touch.

    Returns
    -------
    (K, 6) float
        In the order of :data:`POSITIONS`; distances in diagonals, `outward` from -1 to 1, the last
        two from 0 to 1.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> from_center = positions(hammer)[:, POSITIONS.index("from_center")]
    >>> bool(0 < from_center.min() < from_center.max() < 1)
    True
    """
    hoods = Neighbourhoods.of(shape)
    share = hoods.areas / hoods.areas.sum()
    points = hoods.groups.points / shape.box_diagonal
    away = points - share @ points
    values, axes = np.linalg.eigh((away * share[:, None]).T @ away)
    values = np.maximum(values, _FLAT * values.sum() + np.finfo(np.float64).tiny)
    squared = (away @ axes) ** 2
    distance = np.linalg.norm(away, axis=1)
    facing = unit(group_normals(shape)[0])
    facing_squared = (facing @ axes) ** 2
    return np.column_stack(
        [
            distance,
            np.sqrt(squared @ (values / values[-1])),
            np.sqrt(np.maximum(squared @ (1.0 - values / values[-1]), 0.0)),
            np.einsum("ij,ij->i", facing, unit(away)),
            facing_squared @ values / values.sum(),
            facing_squared @ (1.0 / values) / (1.0 / values).sum(),
        ]
    )
