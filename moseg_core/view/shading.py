"""Light and lines on one view of a shape, over its z-buffer (:mod:`moseg_core.view.raster`).

- The light is diffuse, from over the viewer's left shoulder, over a soft ambient, on the side of a
  face that is seen, whichever way the face is wound; hollows are darker, by how far a place lies
  behind the mean depth around it (Luft, Colditz and Deussen 2006, doi:10.1145/1141911.1142016).
- Dark lines are drawn where parts meet, along the outline, and where one thing is in front of
  another.

Light is computed and averaged in proportion to its energy, so that edges are smooth.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from moseg_core.shape.geometry import Geometry
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray
from moseg_core.view.camera import Camera
from moseg_core.view.palette import linear_light
from moseg_core.view.raster import interpolate, rasterize

# Right, up and towards the viewer.
_KEY_LIGHT = np.array([-0.50, 0.55, 0.67])
_AMBIENT, _FROM_ABOVE, _DIFFUSE = 0.27, 0.12, 0.74


def draw_view(
    mesh: Geometry,
    labels: IntArray,
    shades: IntArray,
    normals: FloatArray,
    colors: npt.NDArray[np.uint8],
    camera: Camera,
    samples: int,
    transparent: bool,
) -> npt.NDArray[np.uint8]:
    """One view of a shape whose elements have colours.

    Parameters
    ----------
    mesh : Geometry
    labels : (F,) int
        Lines are drawn where they differ.
    shades : (F,) int
        The row of `colors` that each element has.
    normals : (T, 3, 3) float
        Of each corner of each triangle (:func:`moseg_core.view.normals.corner_normals`).
    colors : (n, 3) uint8
    camera : Camera
        Its size is `samples` times that of the view.
    samples : int
        Samples per pixel and direction.
    transparent : bool
        Whether there is nothing behind the shape, or white.

    Returns
    -------
    (h, w, 4) uint8
        Red, green, blue and how much of a pixel is covered, sRGB.
    """
    seen = camera.project(mesh.vertices)[mesh.triangles]
    triangle, depth = rasterize(seen, camera.width, camera.height)
    normal = normals @ camera.rotation.T
    facing = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])[:, 2]
    # y runs down on the picture, so that what faces the viewer has a negative area there.
    normal[facing > 0.0] *= -1.0

    shown = triangle >= 0
    element = mesh.triangle_polygon[triangle[shown]]
    part, shade = np.full((2, *triangle.shape), -1, np.int32)
    part[shown], shade[shown] = labels[element], shades[element]
    light = _light(interpolate(triangle, seen, normal))
    light *= _hollows(depth, shown, samples)
    light *= _lines(part, depth, samples)

    palette = np.concatenate([linear_light(colors), np.ones((1, 3))]).astype(np.float32)
    view = np.ones((camera.height // samples, camera.width // samples, 4))
    covered = _averaged(shown.astype(np.float64), samples)
    behind = 0.0 if transparent else 1.0
    for channel in range(3):
        shaded = np.where(shown, palette[:, channel][shade] * light, behind)
        view[:, :, channel] = _averaged(shaded, samples)
    if transparent:
        view[:, :, :3] /= np.maximum(covered, 1e-9)[:, :, None]
    drawn = _srgb(view)
    if transparent:
        drawn[:, :, 3] = np.rint(covered * 255.0)
    return drawn


def _averaged(values: FloatArray, samples: int) -> FloatArray:
    """(h, w) mean of the samples of each pixel."""
    height, width = (side // samples for side in values.shape)
    mean: FloatArray = values.reshape(height, samples, width, samples).mean(axis=(1, 3))
    return mean


def _light(normal: FloatArray) -> npt.NDArray[np.float32]:
    """(h, w) light on surfaces with these normals, in view directions; about 0.2 to 1.1."""
    flat = normal.reshape(-1, 3)
    length = np.maximum(np.sqrt(np.einsum("pi,pi->p", flat, flat)), 1e-12)
    key = np.maximum(flat @ (_KEY_LIGHT / np.linalg.norm(_KEY_LIGHT)) / length, 0.0)
    light: FloatArray = _AMBIENT + _FROM_ABOVE * flat[:, 1] / length + _DIFFUSE * key
    return light.reshape(normal.shape[:2]).astype(np.float32)


def _hollows(depth: FloatArray, shown: BoolArray, samples: int) -> npt.NDArray[np.float32]:
    """(h, w) factor on the light, below 1 where the surface lies behind what is around it."""
    middle = samples // 2
    mask = shown[middle::samples, middle::samples].astype(np.float64)
    near = np.where(mask > 0.0, depth[middle::samples, middle::samples], 0.0)
    radius = 0.03 * min(mask.shape)
    weight = np.maximum(ndimage.gaussian_filter(mask, radius), 1e-6)
    mean = ndimage.gaussian_filter(near, radius) / weight
    spread = np.repeat(np.repeat(mean, samples, axis=0), samples, axis=1)
    behind = np.where(shown, spread - depth, 0.0) / (radius * samples)
    factor: npt.NDArray[np.float32] = (1.0 - 0.45 * np.clip(behind / 2.5, 0.0, 1.0)).astype(
        np.float32
    )
    return factor


def _lines(part: Int32Array, depth: FloatArray, samples: int) -> npt.NDArray[np.float32]:
    """(h, w) factor on the light that draws the lines."""
    shown = part >= 0
    meet, outline, step = (np.zeros(part.shape, np.bool_) for _ in range(3))
    jump = 0.012 * min(part.shape)
    z = np.where(shown, depth, 0.0)
    for axis in (0, 1):
        lower, upper = _neighbors(axis, 1)
        both = shown[lower] & shown[upper]
        differ = both & (part[lower] != part[upper])
        meet[lower] |= differ
        meet[upper] |= differ
        edge = shown[lower] != shown[upper]
        outline[lower] |= edge
        outline[upper] |= edge
        # A step is a bend of the depth, not a slope: a plane seen at a glance is none.
        before, after = _neighbors(axis, 2)
        center = tuple(slice(1, -1) if a == axis else slice(None) for a in (0, 1))
        inside = shown[before] & shown[center] & shown[after]
        step[center] |= inside & (np.abs(z[before] - 2.0 * z[center] + z[after]) > jump)
    thick = ndimage.binary_dilation(meet, iterations=max(1, samples // 2))
    factor = np.ones(part.shape, np.float32)
    factor[step] = 0.45
    factor[outline] = 0.35
    factor[thick] = 0.12
    return factor


def _neighbors(axis: int, distance: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Index of all samples but the last, and of all but the first, along an axis."""
    everything = slice(None)
    lower, upper = slice(None, -distance), slice(distance, None)
    if axis == 0:
        return (lower, everything), (upper, everything)
    return (everything, lower), (everything, upper)


def _srgb(light: FloatArray) -> npt.NDArray[np.uint8]:
    """Light of 0 to 1 as sRGB values of 0 to 255."""
    light = np.clip(light, 0.0, 1.0)
    value = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(value * 255.0).astype(np.uint8)
