"""Which way the elements of a surface face: unit normals that point out of the shape.

A file may orient its faces either way. Of a component of the surface that is closed, the faces
point outward where the volume that they enclose comes out positive (the divergence theorem), and
else they are turned, all of the component together. Of an open component the sign is that of the
volume between it and its centroid: the convex side of a shell is its outside.
"""

from __future__ import annotations

import numpy as np

from moseg_core import Shape
from moseg_learn.neighbourhoods import FloatArray, Neighbourhoods

_ROWS, _COLUMNS = np.triu_indices(3)
"""Of the six numbers of a symmetric matrix."""


def outward_normals(shape: Shape) -> FloatArray:
    """Unit normals of all elements, turned outward component by component.

    Parameters
    ----------
    shape : Shape
        A surface, its faces oriented alike within a component.

    Returns
    -------
    (F, 3) float
        Of length 1; 0 for an element without area.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> away = hammer.points - hammer.frame.center
    >>> bool((outward_normals(hammer) * away).sum(axis=1).mean() > 0)
    True
    """
    geometry = shape.geometry
    corners = geometry.vertices[geometry.triangles]
    twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros((shape.n_elements, 3))
    np.add.at(sums, geometry.triangle_polygon, twice)
    sums *= _signs(shape, sums)[:, None]
    lengths = np.linalg.norm(sums, axis=1)
    normals: FloatArray = sums / np.maximum(lengths, np.finfo(np.float64).tiny)[:, None]
    return normals


def _signs(shape: Shape, sums: FloatArray) -> FloatArray:
    """(F,) float: -1 for elements of components that the file orients inward, else 1."""
    if shape.adjacency is None:
        count, component = 1, np.zeros(shape.n_elements, np.int64)
    else:
        count, component = shape.adjacency.components()
    areas = np.maximum(shape.areas, 1e-12 * shape.areas.mean())
    total = np.bincount(component, areas, count)
    middle = np.stack(
        [np.bincount(component, areas * axis, count) / total for axis in shape.points.T], axis=1
    )
    volumes = np.einsum("ij,ij->i", shape.points - middle[component], sums)
    signs: FloatArray = np.where(np.bincount(component, volumes, count) < 0, -1.0, 1.0)
    return signs[component]


def group_normals(shape: Shape) -> tuple[FloatArray, FloatArray]:
    """Means over each group of elements, computed once and kept with the shape.

    Parameters
    ----------
    shape : Shape
        As the user gave it.

    Returns
    -------
    normals : (K, 3) float
        Of the outward normals ``n``.
    products : (K, 6) float
        Of ``n n'``: xx, xy, xz, yy, yz, zz.
    """
    key = ("learn normals",)
    if key not in shape.made_from:
        hoods, normals = Neighbourhoods.of(shape), outward_normals(shape)
        products = normals[:, _ROWS] * normals[:, _COLUMNS]
        shape.made_from[key] = hoods.of_elements(normals), hoods.of_elements(products)
    kept: tuple[FloatArray, FloatArray] = shape.made_from[key]
    return kept


def unit(vectors: FloatArray) -> FloatArray:
    """(K, 3) float: vectors of length 1; what is next to none stays shorter.

    Examples
    --------
    >>> unit(np.array([[3.0, 0, 4], [0, 0, 0]])).tolist()
    [[0.6, 0.0, 0.8], [0.0, 0.0, 0.0]]
    """
    scaled: FloatArray = vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-9)[:, None]
    return scaled
