"""Labels in an STL file: the solids of a text file, or the attributes of a binary one.

A text file may hold several solids, one behind the other, each with a name. Names that are all the
same, or missing, tell nothing: then the solids are numbered. The two bytes behind each triangle of
a binary file mean what its program likes, a colour or a number of a part; they are labels where
they differ.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from moseg_core.io.labels.listing import Listing, Wanted, middles, numbered_names
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.stl import read_stl, stl_contents
from moseg_core.types import FloatArray


def read_stl_labels(path: Path, wanted: Wanted) -> Listing:
    r"""Read the solid of each triangle.

    Parameters
    ----------
    path : Path
    wanted : Wanted

    Raises
    ------
    ShapeError
        The file cannot be read, is no mesh, or does not tell its triangles apart.

    Examples
    --------
    >>> import tempfile
    >>> corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0"
    >>> facet = f"facet normal 0 0 1\nouter loop\n{corners}\nendloop\nendfacet\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "a.stl"
    ...     solids = [f"solid {name}\n{facet}endsolid {name}\n" for name in ("leg", "body")]
    ...     _ = file.write_text("".join(solids))
    ...     found = read_stl_labels(file, Wanted(n_elements=2))
    >>> found.labels.tolist(), found.names
    ([0, 1], ('leg', 'body'))
    """
    places = middles(read_stl(path).geometry)
    found = stl_contents(path, read_file(path))
    if found.records is not None:
        return _of_attributes(path, found.records["attribute"], places)
    solids: list[str] = []
    sizes: list[int] = []
    for line in found.text.splitlines():
        words = line.split()
        keyword = words[0].lower() if words else b""
        if keyword == b"solid":
            solids.append(b" ".join(words[1:]).decode("utf-8", "replace"))
            sizes.append(0)
        elif keyword == b"endfacet" and sizes:
            sizes[-1] += 1
    solids = [name for name, size in zip(solids, sizes, strict=True) if size]
    sizes = [size for size in sizes if size]
    if len(solids) < 2:
        raise file_error(
            path,
            "has one solid, which tells no faces apart; export each part as a solid of its own, or"
            " give a file of labels",
        )
    number = np.repeat(np.arange(len(solids)), sizes)
    if len(set(solids)) == 1 or not all(solids):
        note = f"{path.name}: its solids have no names of their own, and are numbered"
        return Listing(labels=number, of="elements", notes=(note,), places=places)
    labels, names = numbered_names(solids)
    return Listing(labels=labels[number], names=names, of="elements", places=places)


def _of_attributes(path: Path, attributes: npt.NDArray[np.integer], places: FloatArray) -> Listing:
    """A label for each value of the two bytes behind the triangles."""
    if len(np.unique(attributes)) < 2:
        raise file_error(
            path,
            "is binary, and so names no solids, and the attributes of its triangles are all alike;"
            " export it as text with a solid for each part, or give a file of labels",
        )
    note = f"{path.name}: labels are the attributes of its triangles"
    return Listing(labels=attributes.astype(np.int64), of="elements", notes=(note,), places=places)
