"""A result as URDF: a link for each part, fixed to one root (http://wiki.ros.org/urdf/XML).

Every link has its piece of the surface to be seen, its convex hull to collide, and mass and
inertia for density 1 (:mod:`moseg_robotics.bodies`). A link's frame is in its centre of mass. All
joints are fixed: which parts move is for the user to say, by changing a joint's type. URDF counts
in metres; the numbers are those of the shape. Meshes are named relative to the file.
"""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from trimesh.transformations import euler_matrix

from moseg_core import Result
from moseg_robotics.bodies import MOST_VERTICES, Body, bodies_of, mesh_files, number, turn_upright


def write_urdf(
    result: Result, *, name: str, hull_vertices: int = MOST_VERTICES
) -> dict[str, bytes]:
    """A result as a URDF file, with its meshes in a folder beside it.

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
    robot = Xml.Element("robot", name=root)
    robot.append(
        Xml.Comment(
            " A link for each part. Lengths are the shape's, read as metres; masses are for"
            " density 1. "
        )
    )
    Xml.SubElement(robot, "link", name=root)
    for body in bodies:
        robot.append(Xml.Comment(f" {body.remark} "))
        robot.append(_link(body, folder))
        robot.append(_joint(body, root, turn_upright(result.shape.up)))
    Xml.indent(robot)
    text = Xml.tostring(robot, encoding="utf-8", xml_declaration=True) + b"\n"
    return {name: text, **mesh_files(bodies, folder)}


def _link(body: Body, folder: str) -> Xml.Element:
    link = Xml.Element("link", name=body.name)
    inertial = Xml.SubElement(link, "inertial")
    Xml.SubElement(inertial, "origin", xyz="0 0 0", rpy="0 0 0")
    Xml.SubElement(inertial, "mass", value=number(body.mass))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    moments = {"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}
    Xml.SubElement(inertial, "inertia", {key: number(value) for key, value in moments.items()})
    for kind, file in (("visual", f"{body.name}.obj"), ("collision", f"{body.hull_name}.stl")):
        shown = Xml.SubElement(link, kind, name=file.rpartition(".")[0])
        Xml.SubElement(shown, "origin", xyz="0 0 0", rpy="0 0 0")
        geometry = Xml.SubElement(shown, "geometry")
        Xml.SubElement(geometry, "mesh", filename=f"{folder}/{file}")
        if kind == "visual":
            material = Xml.SubElement(shown, "material", name=body.name)
            Xml.SubElement(material, "color", rgba=number(*body.color.round(4), 1.0))
    return link


def _joint(body: Body, root: str, turn: tuple[float, float, float]) -> Xml.Element:
    joint = Xml.Element("joint", name=f"{root}_to_{body.name}", type="fixed")
    Xml.SubElement(joint, "parent", link=root)
    Xml.SubElement(joint, "child", link=body.name)
    rotation = euler_matrix(*turn)[:3, :3]  # type: ignore[no-untyped-call]
    place = rotation @ body.center
    Xml.SubElement(joint, "origin", xyz=number(*place), rpy=number(*turn))
    return joint
