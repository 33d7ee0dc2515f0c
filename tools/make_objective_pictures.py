"""Draw what each basic objective means: where it is low on the left, where it is high on the right.

Run it from anywhere; files are written to ``docs/images/objectives``::

    python tools/make_objective_pictures.py
    python tools/make_objective_pictures.py --output elsewhere thin remote

The numbers in the pictures are values of the objective there. What is drawn for each stands in
:data:`SHOWN`: two calls, each on a labelled shape of :data:`SHAPES`, which are bodies made for it,
or the samples as people labelled them. An objective about one part that is not there is measured on
all parts of the samples, and those of the least and the greatest value are shown.
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import trimesh
from PIL import Image
from trimesh import creation
from trimesh.transformations import rotation_matrix

import moseg_core as moseg

DESTINATION = Path(__file__).resolve().parent.parent / "docs" / "images" / "objectives"
SIZE = (480, 300)
COLOURS = 48
SAMPLES = ("hammer", "horse", "dove", "octopus", "bulldog")


class Labelled(NamedTuple):
    """A shape, the part of each element, and the parts' names."""

    shape: moseg.Shape
    labels: np.ndarray
    names: tuple[str, ...]


# --- samples


@cache
def sample(name: str) -> Labelled:
    """A sample shape as people labelled it."""
    shape = moseg.load(moseg.sample_path(name))
    truth = moseg.read_labels(moseg.sample_labels_path(name), shape.n_elements)
    return Labelled(shape, np.asarray(truth.labels), tuple(truth.names))


def cut_across(name: str, count: int) -> Labelled:
    """A sample cut into pieces along its longest extent, which take turns to be part one or two."""
    shape = sample(name).shape
    along = shape.unit_points[:, int(np.ptp(shape.unit_points, axis=0).argmax())]
    order = np.argsort(np.argsort(along)) * count // shape.n_elements
    return Labelled(shape, order % 2, ("one", "other"))


# --- bodies made for it


def bodies(*meshes: trimesh.Trimesh) -> Labelled:
    """Separate bodies, a part each."""
    whole = trimesh.util.concatenate(meshes)
    labels = np.repeat(np.arange(len(meshes)), [len(mesh.faces) for mesh in meshes])
    return Labelled(moseg.Shape.from_mesh(whole), labels, tuple("abcd"[: len(meshes)]))


def union(*meshes: trimesh.Trimesh) -> trimesh.Trimesh:
    """One body of several that overlap."""
    return trimesh.boolean.union(meshes, engine="manifold")


def box(*sides: float, at: tuple[float, ...] = (0, 0, 0), fine: float = 0.15) -> trimesh.Trimesh:
    """A box around a point."""
    mesh = creation.box(extents=sides).subdivide_to_size(fine)
    mesh.apply_translation(at)
    return mesh


def rod(
    length: float = 3.0, *, radius: float = 0.25, turn: float = 0, at: Any = (0, 0, 0)
) -> trimesh.Trimesh:
    """A rod with round ends along x, turned about z by degrees."""
    mesh = creation.capsule(height=length - 2 * radius, radius=radius, count=[24, 24])
    mesh.apply_translation(-mesh.centroid)
    mesh.apply_transform(rotation_matrix(np.pi / 2, [0, 1, 0]))
    mesh.apply_transform(rotation_matrix(np.radians(turn), [0, 0, 1]))
    mesh.apply_translation(at)
    return mesh


def ellipsoid(*radii: float, at: tuple[float, ...] = (0, 0, 0)) -> trimesh.Trimesh:
    """An ellipsoid."""
    mesh = creation.icosphere(subdivisions=4)
    mesh.apply_scale(radii)
    mesh.apply_translation(at)
    return mesh


def bent(mesh: trimesh.Trimesh, degrees: float) -> trimesh.Trimesh:
    """A body along x bent about z, so that its middle line becomes an arc of as many degrees."""
    mesh = mesh.subdivide_to_size(0.2)
    radius = np.ptp(mesh.vertices[:, 0]) / np.radians(degrees)
    x, y, z = mesh.vertices.T
    around = np.column_stack(
        [(radius - y) * np.sin(x / radius), (radius - y) * np.cos(x / radius), z]
    )
    return trimesh.Trimesh(around, mesh.faces)


def tee(across: bool) -> Labelled:
    """A T of two boxes: cut where they meet, or down the middle."""
    whole = union(box(0.5, 0.5, 2.5), box(2, 0.5, 0.5, at=(0, 0, 1.5))).subdivide_to_size(0.12)
    x, _, z = whole.triangles_center.T
    labels = (z > 1.249) if across else (x > 0)
    return Labelled(moseg.Shape.from_mesh(whole), labels.astype(int), ("a", "b"))


#: Labelled shapes by the names that the list below has for them.
SHAPES: Mapping[str, Callable[[], Labelled]] = {
    **{name: partial(sample, name) for name in SAMPLES},
    "hammer in stripes": lambda: cut_across("hammer", 12),
    "hammer in halves": lambda: cut_across("hammer", 2),
    "octopus in halves": lambda: cut_across("octopus", 2),
    "rod": lambda: bodies(rod()),
    "ball": lambda: bodies(ellipsoid(1, 1, 1)),
    "egg": lambda: bodies(ellipsoid(1.3, 1, 0.9)),
    "plate": lambda: bodies(box(2, 1.6, 0.15)),
    "brick": lambda: bodies(box(2, 1.4, 1)),
    "bent rod": lambda: bodies(bent(rod(4), 200)),
    "spindle": lambda: bodies(union(rod(3, radius=0.2), ellipsoid(0.5, 0.7, 0.7))),
    "flag": lambda: bodies(union(rod(3, radius=0.15), box(1, 1.2, 0.1, at=(0.9, 0.6, 0)))),
    "corner": lambda: bodies(
        union(
            box(2, 0.6, 0.6),
            box(0.6, 1.4, 0.6, at=(0.7, 0.9, 0)),
            box(0.5, 0.4, 1.6, at=(-0.6, 0, 0.8)),
        )
    ),
    "cross": lambda: bodies(union(rod(3), rod(3, turn=90))),
    "rods crossed": lambda: bodies(rod(), rod(turn=90, at=(0, 2, 0))),
    "rods side by side": lambda: bodies(rod(), rod(2, at=(0.4, 1, 0))),
    "rods askew": lambda: bodies(rod(), rod(turn=55, at=(0, 1.8, 0))),
    "rods in line": lambda: bodies(rod(2), rod(1.4, at=(2.2, 0, 0))),
    "bricks alike": lambda: bodies(
        box(1.5, 0.75, 0.5),
        box(1.5, 0.75, 0.5, at=(0, 1.3, 0)),
        box(1.5, 0.75, 0.5, at=(0, 2.6, 0)),
    ),
    "bricks in sizes": lambda: bodies(
        box(1.5, 0.75, 0.5), box(1, 0.5, 1 / 3, at=(0, 1.2, 0)), box(0.6, 0.3, 0.2, at=(0, 2, 0))
    ),
    "bricks of all kinds": lambda: bodies(
        box(1.6, 0.3, 0.3), box(0.8, 0.8, 0.8, at=(0, 1.1, 0)), box(1.4, 1.2, 0.1, at=(0, 2.6, 0))
    ),
    "tee at the joint": lambda: tee(across=True),
    "tee down the middle": lambda: tee(across=False),
}

#: Of an objective a call of low and one of high value, each with the shape that it is on.
SHOWN: Mapping[str, tuple[tuple[str, str], tuple[str, str]]] = {
    "narrow": (("rod", "narrow(a)"), ("ball", "narrow(a)")),
    "flat": (("plate", "flat(a)"), ("ball", "flat(a)")),
    "compact": (("ball", "compact(a)"), ("rod", "compact(a)")),
    "planar_symmetric": (("brick", "planar_symmetric(a)"), ("corner", "planar_symmetric(a)")),
    "axial_symmetric": (("spindle", "axial_symmetric(a)"), ("flag", "axial_symmetric(a)")),
    "rotational_symmetric": (
        ("cross", "rotational_symmetric(a, n=4)"),
        ("flag", "rotational_symmetric(a, n=4)"),
    ),
    "ellipsoidal": (("egg", "ellipsoidal(a)"), ("bent rod", "ellipsoidal(a)")),
    "convex": (("brick", "convex(a)"), ("bent rod", "convex(a)")),
    "area_fraction": (
        ("horse", "area_fraction(head, min=0.1, max=0.4)"),
        ("horse", "area_fraction(leg1, min=0.1, max=0.4)"),
    ),
    "is": (
        ("horse", "is(leg1, area=0.09+-0.03, thickness=0.07+-0.02)"),
        ("horse", "is(body, area=0.09+-0.03, thickness=0.07+-0.02)"),
    ),
    "perpendicular": (
        ("rods crossed", "perpendicular(a, b)"),
        ("rods side by side", "perpendicular(a, b)"),
    ),
    "parallel": (("rods side by side", "parallel(a, b)"), ("rods crossed", "parallel(a, b)")),
    "coaxial": (("rods in line", "coaxial(a, b)"), ("rods askew", "coaxial(a, b)")),
    "above": (
        ("horse", 'above(head, leg1, up="y")'),
        ("horse", 'above(leg1, head, up="y")'),
    ),
    "similar_proportions": (
        ("bricks alike", "similar_proportions(a, b, c)"),
        ("bricks of all kinds", "similar_proportions(a, b, c)"),
    ),
    "similar": (
        ("bricks in sizes", "similar(a, b, c)"),
        ("bricks of all kinds", "similar(a, b, c)"),
    ),
    "touching": (("horse", "touching(body, head)"), ("horse", "touching(leg3, head)")),
    "apart": (("horse", "apart(leg1, leg2)"), ("horse", "apart(head, body)")),
    "convex_parts": (
        ("tee at the joint", "convex_parts"),
        ("tee down the middle", "convex_parts"),
    ),
    "short_boundaries": (("hammer", "short_boundaries"), ("hammer in stripes", "short_boundaries")),
    "creased_boundaries": (
        ("hammer", "creased_boundaries"),
        ("hammer in halves", "creased_boundaries"),
    ),
    "separate_parts": (("hammer", "separate_parts"), ("hammer in stripes", "separate_parts")),
    "even_parts": (("octopus", "even_parts"), ("octopus in halves", "even_parts")),
}


# --- what is drawn


class Half(NamedTuple):
    """One half of a picture: the shape, the parts that are meant, the call and its value."""

    labelled: Labelled
    meant: tuple[str, ...]
    call: str
    value: float


def half(labelled: Labelled, call: str) -> Half:
    """The half that shows a call."""
    problem = moseg.Problem(labelled.names, call)
    value = problem.evaluate(labelled.shape, labelled.labels).cost.value
    inside = call.partition("(")[2].rstrip(")").split(", ")
    meant = tuple(word for word in inside if word and "=" not in word)
    return Half(labelled, meant, call, value)


def low_and_high(objective: str) -> tuple[Half, Half]:
    """What to show of an objective."""
    if objective in SHOWN:
        (low, low_call), (high, high_call) = SHOWN[objective]
        return half(SHAPES[low](), low_call), half(SHAPES[high](), high_call)
    halves = sorted(_on_samples(objective), key=lambda shown: shown.value)
    return halves[0], halves[-1]


def _on_samples(objective: str) -> Iterator[Half]:
    for name in SAMPLES:
        for part in sample(name).names:
            yield half(sample(name), f"{objective}({part})")


def picture(objective: str) -> Image.Image:
    """The two halves beside each other."""
    whole = Image.new("RGB", (2 * SIZE[0], SIZE[1]))
    for place, shown in enumerate(low_and_high(objective)):
        shape, labels, names = shown.labelled
        if shown.meant and set(shown.meant) != set(names):
            kept = [names.index(name) for name in shown.meant]
            labels = np.select([labels == place for place in kept], range(len(kept)), len(kept))
            names = (*shown.meant, "others")
        drawn = moseg.render_picture(
            shape.geometry,
            labels,
            names,
            title=f"{objective}: {shown.value if shown.value > 1e-6 else 0:.2g}",
            size=SIZE,
            up="y" if shape.name in SAMPLES else "z",
        )
        whole.paste(Image.open(io.BytesIO(drawn)).convert("RGB"), (place * SIZE[0], 0))
    return whole.quantize(COLOURS)


def basic_objectives() -> list[str]:
    """The names of all basic objectives, in the order of their bundle."""
    known = moseg.registry().components("objective")
    return [component.spec.name for component in known if component.bundle == "basic"]


def main() -> None:
    """Write one picture for each objective."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("objectives", nargs="*", metavar="NAME", help="all where none is given")
    parser.add_argument("--output", type=Path, default=DESTINATION, help="folder to write to")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    for objective in arguments.objectives or basic_objectives():
        picture(objective).save(arguments.output / f"{objective}.png", optimize=True)


if __name__ == "__main__":
    main()
