"""A result as MJCF, MuJoCo's own format: a body for each part, within one for the whole.

(https://mujoco.readthedocs.io/en/stable/XMLreference.html.) Every body has a geom to be seen, in
group 2, that collides with nothing, and its convex hull in group 3, hidden by default, that does;
mass and inertia are given for density 1 (:mod:`moseg_robotics.bodies`). The bodies have no joints:
the whole stands where it is until the user gives the outer body a ``<freejoint/>``, or one of the
inner ones a joint. The numbers are those of the shape.
"""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from moseg_core import Result
from moseg_robotics.bodies import MOST_VERTICES, Body, bodies_of, mesh_files, number, turn_upright


def write_mjcf(
    result: Result, *, name: str, hull_vertices: int = MOST_VERTICES
) -> dict[str, bytes]:
    """A result as an MJCF file, with its meshes in a folder beside it.

    Parameters
    ----------
    result : Result
    name : str
        Of the file, with its suffix.
    hull_vertices : int
        The greatest number of vertices of a hull, 4 or more.

    Returns
    -------
    dict of str to bytes

    Raises
    ------
    UsageError
        No part has any extent.
    """
    stem = name.rpartition(".")[0]
    folder = f"{stem}_meshes"
    root, bodies = bodies_of(result, root=stem, hull_vertices=hull_vertices)
    model = Xml.Element("mujoco", model=root)
    model.append(
        Xml.Comment(" A body for each part. Lengths are the shape's; masses are for density 1. ")
    )
    Xml.SubElement(model, "compiler", meshdir=folder, angle="radian")
    asset = Xml.SubElement(model, "asset")
    world = Xml.SubElement(model, "worldbody")
    whole = Xml.SubElement(world, "body", name=root)
    if any(turn := turn_upright(result.shape.up)):
        whole.set("euler", number(*turn))
    for body in bodies:
        # What is seen may be open; MuJoCo asks for a volume of everything else.
        Xml.SubElement(asset, "mesh", name=body.name, file=f"{body.name}.obj", inertia="shell")
        Xml.SubElement(asset, "mesh", name=body.hull_name, file=f"{body.hull_name}.stl")
        rgba = number(*body.color.round(4), 1.0)
        Xml.SubElement(asset, "material", name=body.name, rgba=rgba)
        whole.append(Xml.Comment(f" {body.remark} "))
        whole.append(_element(body))
    Xml.indent(model)
    text = Xml.tostring(model, encoding="utf-8", xml_declaration=True) + b"\n"
    return {name: text, **mesh_files(bodies, folder)}


def _element(body: Body) -> Xml.Element:
    element = Xml.Element("body", name=body.name, pos=number(*body.center))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    Xml.SubElement(
        element,
        "inertial",
        pos="0 0 0",
        mass=number(body.mass),
        fullinertia=number(xx, yy, zz, xy, xz, yz),
    )
    Xml.SubElement(
        element,
        "geom",
        name=body.name,
        type="mesh",
        mesh=body.name,
        material=body.name,
        contype="0",
        conaffinity="0",
        group="2",
    )
    Xml.SubElement(
        element,
        "geom",
        name=body.hull_name,
        type="mesh",
        mesh=body.hull_name,
        material=body.name,
        group="3",
    )
    return element
