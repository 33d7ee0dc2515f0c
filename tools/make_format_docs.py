"""Try which programs find parts, polygons, colours and UVs in the files that moseg writes.

The table in ``docs/formats.md``, between two marks, is what was found::

    <!-- programs: made by tools/make_format_docs.py -->
    <!-- end of programs -->

A ball of quads with texture coordinates and the sample horse, each in two parts, are written in
every format and opened by each program, which reports what is there; what it finds of the ball it
must find of the horse. The programs are large and need no moseg, so they may live elsewhere; each
interpreter is asked for those that it can import::

    python -m venv programs && programs/bin/pip install trimesh pygltflib pyvista meshio lib3mf
    python3.11 -m venv blender && blender/bin/pip install bpy
    python tools/make_format_docs.py programs/bin/python blender/bin/python
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "formats.md"
START = "<!-- programs: made by tools/make_format_docs.py -->"
END = "<!-- end of programs -->"

#: How each program is called, and the package that is imported.
PROGRAMS = {
    "Blender": "bpy",
    "trimesh": "trimesh",
    "pygltflib": "pygltflib",
    "PyVista": "pyvista",
    "meshio": "meshio",
    "lib3mf": "lib3mf",
}
#: Formats, and what moseg writes into each that a program could find.
FORMATS = {
    ".obj": ("parts", "parts as materials", "numbers of parts", "quads", "UVs",
             "colours of parts"),
    ".glb": ("parts", "parts without names", "UVs", "colours of parts"),
    ".ply": ("quads", "labels of faces", "labels of vertices", "colours of faces",
             "colours of vertices"),
    ".vtu": ("quads", "labels of faces", "names of labels"),
    ".3mf": ("parts", "colours of parts"),
}  # fmt: skip
NAMES = ["first", "second"]  # of the parts
Found = dict[str, bool]


# -- What each program finds: these run where it is installed, without moseg -------------------


def in_blender(path: str) -> Found | None:
    """Objects of the name of a part, and what their meshes have."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    readers = {
        ".obj": bpy.ops.wm.obj_import,
        ".ply": bpy.ops.wm.ply_import,
        ".glb": bpy.ops.import_scene.gltf,
    }
    reader = readers.get(Path(path).suffix)
    if reader is None:
        return None
    reader(filepath=path)
    objects = [each for each in bpy.data.objects if each.type == "MESH"]
    meshes = [each.data for each in objects]
    attributes = {(a.name, a.domain) for mesh in meshes for a in mesh.attributes}
    return {
        "parts": sorted(each.name for each in objects) == NAMES,
        "quads": all(len(p.vertices) == 4 for mesh in meshes for p in mesh.polygons),
        "UVs": all(len(mesh.uv_layers) > 0 for mesh in meshes),
        "colours of parts": len({tuple(m.diffuse_color) for x in meshes for m in x.materials}) > 1,
        "colours of vertices": ("Col", "POINT") in attributes,
        "colours of faces": ("Col", "FACE") in attributes,
        "labels of vertices": ("label", "POINT") in attributes,
        "labels of faces": ("label", "FACE") in attributes,
    }


def in_trimesh(path: str) -> Found | None:
    """Geometries of the name of a part, and their visuals; of PLY the raw columns."""
    import numpy as np
    import trimesh

    try:
        scene = trimesh.load_scene(path)
    except (ValueError, NotImplementedError):
        return None
    parts = [scene.geometry[name] for name in sorted(scene.geometry)]
    visuals = [part.visual for part in parts]
    materials = [getattr(visual, "material", None) for visual in visuals]
    raw = parts[0].metadata.get("_ply_raw", {})

    def has(element: str, name: str) -> bool:
        column = raw.get(element, {}).get("data")
        return column is not None and name in (getattr(column, "dtype", None).names or ())

    shades = {tuple(np.asarray(m.main_color)) for m in materials if m is not None}
    shades |= {tuple(v.main_color) for v in visuals if v.kind == "face"}
    return {
        "parts": sorted(scene.graph.nodes_geometry) == NAMES or sorted(scene.geometry) == NAMES,
        "UVs": all(getattr(visual, "uv", None) is not None for visual in visuals),
        "colours of parts": len(shades) > 1,
        "colours of vertices": visuals[0].kind == "vertex",
        "colours of faces": has("face", "red"),
        "labels of vertices": has("vertex", "label"),
        "labels of faces": has("face", "label"),
    }


def in_pygltflib(path: str) -> Found | None:
    """Nodes of the name of a part, attributes and materials."""
    from pygltflib import GLTF2

    if Path(path).suffix != ".glb":
        return None
    gltf = GLTF2().load(path)
    primitives = [primitive for mesh in gltf.meshes for primitive in mesh.primitives]
    factors = {tuple(m.pbrMetallicRoughness.baseColorFactor) for m in gltf.materials}
    return {
        "parts": sorted(node.name for node in gltf.nodes if node.mesh is not None) == NAMES,
        "UVs": all(p.attributes.TEXCOORD_0 is not None for p in primitives),
        "colours of parts": len(factors) > 1,
    }


def in_pyvista(path: str) -> Found | None:
    """Arrays of cells and points, and blocks of the name of a part."""
    import pyvista

    try:
        read = pyvista.read(path)
    except (OSError, ValueError):
        return None
    blocks = [read]
    names: list[str] = []
    if isinstance(read, pyvista.MultiBlock):
        blocks = list(read.recursive_iterator(skip_none=True))
        names = [name for name in read.recursive_iterator("names") if name]
    first = blocks[0]
    cells, points = list(first.cell_data), list(first.point_data)
    sizes = {cell.n_points for block in blocks for cell in block.cell}
    return {
        "parts": sorted(names) == NAMES,
        "parts without names": len(blocks) == len(NAMES) and sorted(names) != NAMES,
        "parts as materials": set(NAMES)
        <= set(map(str, first.field_data.get("MaterialNames", ()))),
        "colours of parts": all("BaseColorMultiplier" in block.field_data for block in blocks),
        "quads": sizes == {4},
        "UVs": all(block.active_texture_coordinates is not None for block in blocks),
        "colours of vertices": any("RGB" in name for name in points),
        "colours of faces": any("RGB" in name for name in cells),
        "labels of vertices": "label" in points,
        "labels of faces": "label" in cells,
        "names of labels": sorted(first.field_data) == NAMES,
    }


def in_meshio(path: str) -> Found | None:
    """Data of cells and points."""
    import meshio

    try:
        mesh = meshio.read(path)
    except (meshio.ReadError, SystemExit, ValueError):
        return None
    corners = sum(block.data.size for block in mesh.cells)
    faces = sum(len(block.data) for block in mesh.cells)
    if not corners or max(block.data.max() for block in mesh.cells) >= len(mesh.points):
        return None
    label = mesh.cell_data.get("label", [])
    return {
        "numbers of parts": "obj:group_ids" in mesh.cell_data,
        "quads": corners == 4 * faces,
        "UVs": "obj:vt" in mesh.point_data,
        "colours of vertices": "red" in mesh.point_data,
        "colours of faces": "red" in mesh.cell_data,
        "labels of vertices": "label" in mesh.point_data,
        "labels of faces": sum(map(len, label)) == faces,
        "names of labels": sorted(mesh.field_data) == NAMES,
    }


def in_lib3mf(path: str) -> Found | None:
    """Mesh objects of the name of a part, and base materials."""
    import lib3mf

    if Path(path).suffix != ".3mf":
        return None
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(path)
    objects, names, closed = model.GetMeshObjects(), [], []
    while objects.MoveNext():
        each = objects.GetCurrentMeshObject()
        names.append(each.GetName())
        closed.append(each.IsManifoldAndOriented())
    groups, shades = model.GetBaseMaterialGroups(), set()
    while groups.MoveNext():
        group = groups.GetCurrentBaseMaterialGroup()
        for number in group.GetAllPropertyIDs():
            color = group.GetDisplayColor(number)
            shades.add((color.Red, color.Green, color.Blue))
    return {
        "parts": sorted(names) == NAMES and all(closed) and reader.GetWarningCount() == 0,
        "colours of parts": len(shades) > 1,
    }


LOOK: dict[str, Callable[[str], Found | None]] = {
    "Blender": in_blender,
    "trimesh": in_trimesh,
    "pygltflib": in_pygltflib,
    "PyVista": in_pyvista,
    "meshio": in_meshio,
    "lib3mf": in_lib3mf,
}


def look(paths: Sequence[str]) -> None:
    """Print, as the last line, what each program that is installed here finds in some files."""
    report: dict[str, Any] = {}
    for program, package in PROGRAMS.items():
        try:
            import_module(package)
        except ImportError:
            continue
        found = {path: LOOK[program](path) for path in paths}
        report[program] = {"version": metadata.version(package), "found": found}
    print("\n" + json.dumps(report))


# -- The files and the table: these need moseg --------------------------------------------------


def write_files_into(folder: Path) -> dict[str, list[Path]]:
    """Files of all formats by shape."""
    import moseg_core as moseg
    from moseg_core.testing.fixtures.results import result_on

    ball = folder / "quads.obj"
    ball.write_text(quad_ball())
    written: dict[str, list[Path]] = {}
    for name, path in (("ball", ball), ("horse", moseg.sample_path("horse"))):
        result = result_on(moseg.load(path))
        written[name] = [folder / f"{name}{suffix}" for suffix in FORMATS]
        for file in written[name]:
            moseg.save(result, file)
    return written


def quad_ball(steps: int = 6) -> str:
    """An OBJ file of the six sides of a cube, blown up to a ball, each with a texture square."""
    import numpy as np

    ticks = np.tan(np.linspace(-np.pi / 4, np.pi / 4, steps + 1))
    u, v = (each.reshape(-1) for each in np.meshgrid(ticks, ticks, indexing="ij"))
    number = np.arange(len(u)).reshape(steps + 1, -1)
    square = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    lines = []
    for side in range(6):
        sign = 1.0 if side < 3 else -1.0
        points = np.roll(np.stack([np.full(len(u), sign), u, sign * v], axis=1), side % 3, axis=1)
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        lines += ["v " + " ".join(map(repr, row)) for row in points.tolist()]
        lines += [
            "vt " + " ".join(map(repr, row)) for row in (np.stack([u, v], 1) / 2 + 0.5).tolist()
        ]
        corners = square.reshape(-1, 4) + len(u) * side + 1
        lines += ["f " + " ".join(f"{c}/{c}" for c in row) for row in corners.tolist()]
    return "\n".join(lines) + "\n"


def table(interpreters: Sequence[str]) -> str:
    """The table of programs and formats."""
    with tempfile.TemporaryDirectory() as folder:
        written = write_files_into(Path(folder))
        files = [str(file) for each in written.values() for file in each]
        reports: dict[str, Any] = {}
        for interpreter in interpreters:
            command = [interpreter, __file__, "--look", *files]
            run = subprocess.run(command, capture_output=True, text=True, check=True)
            reports |= json.loads(run.stdout.strip().splitlines()[-1])
    programs = [name for name in PROGRAMS if name in reports]
    rows = [["", *(f"{name} {reports[name]['version']}" for name in programs)]]
    rows.append(["---"] * len(rows[0]))
    for place, suffix in enumerate(FORMATS):
        cells = []
        for name in programs:
            ball, horse = (reports[name]["found"][str(files[place])] for files in written.values())
            cells.append(cell(suffix, ball, horse, f"{name}, {suffix}"))
        rows.append([f"`{suffix}`", *cells])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def cell(suffix: str, ball: Found | None, horse: Found | None, where: str) -> str:
    """What a program finds in files of a format, in words."""
    if (ball is None) != (horse is None):
        raise SystemExit(f"{where}: one shape is read, and the other is not")
    if ball is None or horse is None:
        return "not read"
    found = [what for what in FORMATS[suffix] if ball.get(what)]
    # The horse has triangles without UVs; all else must be there too.
    lost = [what for what in found if what not in ("quads", "UVs") and not horse.get(what)]
    if lost:
        raise SystemExit(f"{where}: found in the ball, but not in the horse: {', '.join(lost)}")
    return ", ".join(found) or "the surface alone"


def main(interpreters: Sequence[str]) -> None:
    """Write the table into the page."""
    text = PAGE.read_text()
    before, rest = text.split(START)
    _, after = rest.split(END)
    PAGE.write_text(f"{before}{START}\n\n{table(interpreters)}\n\n{END}{after}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--look"]:
        look(sys.argv[2:])
    else:
        main(sys.argv[1:] or [sys.executable])
