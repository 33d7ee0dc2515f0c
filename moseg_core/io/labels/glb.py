"""Labels in a GLB file: the nodes, meshes or materials of the scene that triangles belong to.

Of the three the first is taken that tells triangles apart; ``--label-property`` says otherwise
(node, mesh, material). A node without a name is called after its mesh. The triangles of a scene
seldom stand in the order of the shape that they were made from, not in moseg's own either, so they
come with their places (:mod:`moseg_core.io.labels.fitting`). A scene that moseg has turned so that
+y points up is turned back for that.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from moseg_core.io.labels.listing import Listing, Wanted, middles, numbered_names
from moseg_core.io.labels.properties import chosen, plain
from moseg_core.io.read.checked import file_error
from moseg_core.io.read.glb_scene import read_glb, read_glb_pieces, read_glb_up
from moseg_core.shape.up import turn_to_y


def read_glb_labels(path: Path, wanted: Wanted) -> Listing:
    """Read which named part of a scene each triangle belongs to.

    Parameters
    ----------
    path : Path
    wanted : Wanted

    Raises
    ------
    ShapeError
        The file cannot be read, or names nothing.

    Examples
    --------
    >>> import tempfile, trimesh
    >>> scene = trimesh.Scene({"leg": trimesh.creation.box(), "body": trimesh.creation.box()})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "a.glb"
    ...     _ = scene.export(file)
    ...     found = read_glb_labels(file, Wanted(n_elements=24))
    >>> sorted(found.names), len(found.labels)
    (['body', 'leg'], 24)
    """
    pieces = read_glb_pieces(path, limits=wanted.limits)
    sizes = [piece.n_triangles for piece in pieces]
    nodes = [(piece.node or piece.mesh, piece.place) for piece in pieces]
    said = {
        "node": [name for name, _ in nodes],
        "mesh": [piece.mesh for piece in pieces],
        "material": [piece.material for piece in pieces],
    }
    counts = {kind: len({n for n in names if n}) for kind, names in said.items()}
    notes: tuple[str, ...] = ()
    if wanted.properties:
        asked = [plain(name) for name in wanted.properties]
        kind, _ = chosen(path, "kind of names", [k for k, n in counts.items() if n], asked)
        assert kind is not None  # one is asked for
    elif not any(counts.values()):
        raise file_error(path, "has a part without a name; name its nodes, meshes or materials")
    else:
        named = [kind for kind, n in counts.items() if n]
        kind = next((kind for kind in named if counts[kind] > 1), named[0])
        if kind != "node" and counts["node"]:
            notes = (f"{path.name}: labels are its {counts[kind]} {_PLURAL[kind]}",)
    words = said[kind]
    if kind == "node" and not all(words):
        words = [name or f"node {place}" for name, place in nodes]
        notes = (f"{path.name} has nodes without a name, called by their numbers",)
    labels, names = numbered_names(words)
    return Listing(
        labels=np.repeat(labels, sizes),
        names=names,
        of="elements",
        notes=notes,
        # Rows multiplied by a turn from the right are turned back.
        places=middles(read_glb(path, limits=wanted.limits).geometry)
        @ turn_to_y(read_glb_up(path)),
    )


_PLURAL = {"node": "nodes", "mesh": "meshes", "material": "materials"}
