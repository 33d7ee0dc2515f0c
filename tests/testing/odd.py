"""Components with nothing wrong that are unlike most, and one that takes its process with it."""

from __future__ import annotations

import math
import os
from typing import Annotated

import numpy as np

from moseg_core.components.constraint_function import constraint
from moseg_core.components.objectives import Traits, objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.language import Target


@constraint(start=[0.3, 1.0])
def opposite(free):
    """A constraint that is a function: two centres at equal distances from the middle."""
    x, w = free
    return [[x, 0.0, 0.0, w], [-x, 0.0, 0.0, w]]


class Share:
    """An objective that is an object of a class of its own, with state."""

    traits = Traits(arity="unary", range=(0.0, 1.0), invariant_to=frozenset({"rigid", "order"}))
    parameters = ()

    def __init__(self, power):
        self.power = power

    def __call__(self, part, /):
        return (part.area / part.shape.area) ** self.power


share = Share(2.0)


@objective(range=(0, 1), invariant_to=("rigid", "scale", "reflection", "order", "tessellation"))
def of_single_precision(part: Part) -> float:
    """An objective that returns a number of numpy's, of less than double precision."""
    return np.float32(part.area / part.shape.area)


@objective(range=(0, 1))
def near(part: Part, *, share: Annotated[float, Interval(0, 1)], sharp: bool = False) -> float:
    """An objective with a parameter that must be given."""
    apart = min(1.0, abs(part.area / part.shape.area - share))
    return apart if sharp else apart**2


@objective(range=(0, math.inf), invariant_to=["rigid", "scale", "reflection"])
def sized(
    part: Part,
    *,
    area: Annotated[Target, Interval(0, 1)],
    length: Target | None = None,
    slender: Annotated[Target | None, Interval(0)] = Target(0.3, 0.2),
) -> float:
    """An objective with targets: one that must be given, one without bounds, one by default."""
    found = area.cost(part.area / part.shape.area)
    if length is not None:
        found += length.ratio_cost(float(part.scales[0]) / part.shape.area**0.5)
    if slender is not None:
        found += slender.cost(float(part.scales[1] / part.scales[0]))
    return found


@objective(range=(0, 1), invariant_to=["labels"])
def four(first: Part, second: Part, third: Part, fourth: Part) -> float:
    """An objective on more parts than the zoo has."""
    areas = [part.area for part in (first, second, third, fourth)]
    return min(areas) / max(areas)


def height(shape, *, factor: Annotated[float, Interval(0.0, 10.0)] = 1.0):
    """A field with a parameter: where along the file's third axis, some times."""
    return factor * shape.points[:, 2]


def thirds(shape):
    """A field without parameters: a third of the height."""
    return shape.points[:, 2] / 3.0


def skewed(shape):
    """A field that looks at triangles, the volume and neighbours; all but triangles may lack."""
    corners = shape.geometry.vertices[shape.geometry.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.bincount(
        shape.geometry.triangle_polygon, np.linalg.norm(across, axis=1) / 2, shape.n_elements
    )
    known = (shape.volume is not None) + (shape.adjacency is not None)
    return area / shape.area + known


class Remote:
    """A field that is an object: how far from the centroid, in units of the shape."""

    def __call__(self, shape, *, power: Annotated[float, Interval(0.5, 4.0)] = 1.0):
        middle = shape.areas @ shape.points / shape.area
        away = np.linalg.norm(shape.points - middle, axis=1) / shape.area**0.5
        return away**power


remote = Remote()


def known_fields(parameters):
    """Which fields `level` reads, by its parameters."""
    return ("given:skewed", "given:height") if parameters.get("askew") else ("given:height",)


@objective(fields=known_fields)
def level(part: Part, *, askew: bool = False) -> float:
    """An objective that reads a field, and another one where it is asked to."""
    spread = part.field("given:height", factor=2.0).spread
    return spread + (part.field("given:skewed").mean if askew else 0.0)


@objective(fields=("given:skewed",))
def steep(part: Part) -> float:
    """An objective whose field needs a surface, which the objective itself does not."""
    return part.field("given:skewed").mean


def times(given):
    """Of what `raised` is the mean, which it is not where it is turned upside down."""
    if given.get("upside_down"):
        return None
    return "given:height", {"factor": given.get("factor", 1.0)}


@objective(fields=("given:height",), mean_of=times)
def raised(
    part: Part, *, factor: Annotated[float, Interval(0, 10)] = 1.0, upside_down: bool = False
) -> float:
    """An objective that is the mean of a field, by its parameters, but for one of them."""
    mean = part.field("given:height", factor=factor).mean
    return -mean if upside_down else mean


@objective(requires=("adjacency",), invariant_to=("rigid", "order"))
def ragged(part: Part) -> float:
    """An objective on the boundary of a part."""
    return part.boundary.length**2 / part.area


@objective(requires=("adjacency",), fields=("given:height",))
def at_edges(segmentation: Segmentation) -> float:
    """An objective on all boundaries, by a field along them."""
    boundaries = segmentation.boundaries
    return boundaries.mean("given:height") if boundaries.length > 0 else 0.0


def end(part):
    """A measure that ends its process."""
    os._exit(1)
