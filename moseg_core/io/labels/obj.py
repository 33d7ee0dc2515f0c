"""Labels in an OBJ file: the groups, objects or materials that face lines stand under.

Of the three the first is taken that tells faces apart: ``g``, then ``o``, then ``usemtl``;
``--label-property`` says otherwise (``g``, ``o``, ``usemtl``, or in words). A face before the first
statement, or under one without a name, has no label. Faces are counted as
:mod:`moseg_core.io.read.obj` counts them.
"""

from __future__ import annotations

from pathlib import Path

from moseg_core.io.labels.listing import Listing, Wanted, middles, numbered_names
from moseg_core.io.labels.properties import chosen, plain
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.obj import read_obj
from moseg_core.io.read.text_rows import text_rows

_KINDS = {b"g": "group", b"o": "object", b"usemtl": "material"}
_LEAST_CORNERS = 3  # of a face; others are edges, which are no elements


def read_obj_labels(path: Path, wanted: Wanted) -> Listing:
    r"""Read the names under which the faces of an OBJ file stand.

    Parameters
    ----------
    path : Path
    wanted : Wanted

    Raises
    ------
    ShapeError
        The file cannot be read, is no mesh, or names nothing.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "a.obj"
    ...     vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
    ...     _ = file.write_text(f"{vertices}g leg\nf 1 2 3\ng body\nf 2 4 3\n")
    ...     found = read_obj_labels(file, Wanted(n_elements=2))
    >>> found.labels.tolist(), found.names
    ([0, 1], ('leg', 'body'))
    """
    places = middles(read_obj(path).geometry)
    rows, _ = text_rows(read_file(path), continuation=True)
    current: dict[str, str | None] = dict.fromkeys(_KINDS.values())
    said: dict[str, list[str | None]] = {kind: [] for kind in current}
    for row in rows:
        stated = _KINDS.get(row[0])
        if stated is not None:
            current[stated] = b" ".join(row[1:]).decode("utf-8", "replace") or None
        elif row[0] in (b"f", b"fo") and len(row) > _LEAST_CORNERS:
            for each, names in said.items():
                names.append(current[each])
    read = {kind: numbered_names(words) for kind, words in said.items()}
    counts = {kind: len(found) for kind, (_, found) in read.items() if found}
    notes: tuple[str, ...] = ()
    if wanted.properties:
        asked = [_KINDS.get(name.encode(), plain(name)) for name in wanted.properties]
        kind, _ = chosen(path, "kind of names", list(counts), asked)
        assert kind is not None  # one is asked for
    elif not counts:
        raise file_error(
            path,
            "names no groups (g), objects (o) or materials (usemtl) that could be labels; export it"
            " with groups, or give a file of labels",
        )
    else:
        kind = next((kind for kind, n in counts.items() if n > 1), next(iter(counts)))
        others = [f"{n} {each}s" for each, n in counts.items() if each != kind and n > 1]
        if others:
            notes = (
                f"{path.name}: labels are its {counts[kind]} {kind}s, not its"
                f" {' or '.join(others)}; --label-property says which",
            )
    labels, found = read[kind]
    return Listing(labels=labels, names=found, of="elements", notes=notes, places=places)
