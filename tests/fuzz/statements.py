"""Sound files that are no shapes: labels in every form, a result, a recipe; all of the box."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np

from tests.fuzz.seeds import (
    Seed,
    box,
    ell,
    glb,
    nifti,
    npy,
    npz,
    nrrd,
    obj,
    off,
    ply_header,
    rows,
    scene,
    stl,
)

NAMES = ("head", "handle")
LABELS = [0] * 20 + [1] * 24
"""Of the 44 triangles of the box."""

BOX_FILE = "box.off"
"""The shape beside a result."""


def box_file() -> dict[str, bytes]:
    return {BOX_FILE: off(*box())}


@cache
def fingerprint() -> str:
    """Of the box, as a result has it."""
    from moseg_core import Shape

    return Shape.from_mesh(*box()).fingerprint


def result() -> dict[str, Any]:
    """A result on the box, as moseg writes it."""
    calls = [{"labels": ["head"], "value": 0.25}], [{"labels": ["handle"], "value": 0.5}]
    terms = [
        {
            "term": f"{name}({label})",
            "objective": f"basic:{name}",
            "weight": 1.0,
            "value": called[0]["value"],
            "weighted": called[0]["value"],
            "worst": 1.0,
            "calls": called,
        }
        for name, label, called in zip(("narrow", "flat"), NAMES, calls, strict=True)
    ]
    return {
        "format": "moseg-result/1",
        "shape": {
            "name": "box",
            "file": BOX_FILE,
            "elements": 44,
            "fingerprint": fingerprint(),
            "notes": [],
        },
        "problem": {"labels": list(NAMES), "minimize": "narrow(head) + flat(handle)"},
        "cost": {"value": 0.75, "empty": [], "broken_pins": 0},
        "terms": terms,
        "parts": [
            {"label": name, "elements": n, "area": n / 2, "center": [k, 1.0, 0.5], "weight": 1.0}
            for k, (name, n) in enumerate(zip(NAMES, (20, 24), strict=True))
        ],
        "method": {
            "parameterization": "core:voronoi",
            "seeder": "core:kmeans(outliers=0.001)",
            "labeler": "core:hungarian",
            "optimizer": "core:pattern_search",
            "settings": "default",
            "resolution": "2000",
            "restarts": "8",
            "finalists": "2",
        },
        "dimension": {"free": 8, "all": 8},
        "seed": 0,
        "reason": "seconds",
        "warnings": ["the search ended on its limit (seconds); a longer one may find better"],
        "versions": {
            "basic:flat": "moseg-objectives-basic 0.1.0",
            "basic:narrow": "moseg-objectives-basic 0.1.0",
            "core:voronoi": "moseg-core 0.1.0",
        },
        "history": {
            "seeding": [{"round": 1, "largest_step": 0.25}],
            "search": [{"evaluations": 1, "value": 0.75, "empty": 0, "step": 0.2}],
        },
        "labels": LABELS,
    }


def result_bytes(document: Any) -> bytes:
    return json.dumps(document, indent=1).encode()


RECIPE = """\
description = "a head across a narrow handle"
labels = ["head", "handle"]
minimize = "3*narrow(handle) + perpendicular(handle, head) + is(head, given=head)"
seeder = "kmeans"
optimizer = "pattern_search(expansion=2)"
resolution = 2000
restarts = 4

[given.head]
area = "0.3+-0.1"

[parts.head]
labels = ["left", "right"]
minimize = "similar(left, right) + short_boundaries"
"""


def _named_lines() -> bytes:
    """As in the labelled Princeton benchmark: a name, then numbers of faces from 1."""
    spans = range(1, 21), range(21, 45)
    lines = (f"{n}\n{' '.join(map(str, s))}\n" for n, s in zip(NAMES, spans, strict=True))
    return "".join(lines).encode()


def _labelled_ply() -> bytes:
    vertices, faces = box()
    head = ply_header(24, 44).replace(b"end_header", b"property int label\nend_header")
    listed = [(3, *face, label) for face, label in zip(faces, LABELS, strict=True)]
    return head + (rows(vertices) + rows(listed)).encode()


def _grouped_obj() -> bytes:
    lines = obj(*box()).decode().splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if line.startswith("f "))
    marked = [*lines[:first], "g head\n", *lines[first : first + 20], "g handle\n"]
    return "".join([*marked, *lines[first + 20 :]]).encode()


def _solids_stl() -> bytes:
    vertices, faces = box()
    head, handle = stl(vertices, faces[:20]), stl(vertices, faces[20:])
    return head.replace(b" box", b" head") + handle.replace(b" box", b" handle")


def _parted_glb() -> bytes:
    vertices, faces = box()
    document, binary = scene(vertices, faces)
    views = document["bufferViews"]
    start, cut = views[0]["byteLength"], 20 * 12
    views[1:] = [
        {"buffer": 0, "byteOffset": start, "byteLength": cut},
        {"buffer": 0, "byteOffset": start + cut, "byteLength": len(binary) - start - cut},
    ]
    accessor = document["accessors"].pop()
    document["accessors"] += [
        {**accessor, "bufferView": 1, "count": 60},
        {**accessor, "bufferView": 2, "count": 72},
    ]
    document["meshes"] = [
        {"primitives": [{"attributes": {"POSITION": 0}, "indices": k}]} for k in (1, 2)
    ]
    document["nodes"] = [{"mesh": k, "name": name} for k, name in enumerate(NAMES)]
    document["scenes"] = [{"nodes": [0, 1]}]
    return glb(document, binary)


def _lines(items: list[Any]) -> bytes:
    return "".join(f"{item}\n" for item in items).encode()


def _words() -> list[str]:
    return [NAMES[label] for label in LABELS]


def _map() -> dict[str, int]:
    return {str(k): label for k, label in enumerate(LABELS)}


def _groups() -> dict[str, list[int]]:
    return {name: [k for k, x in enumerate(LABELS) if x == i] for i, name in enumerate(NAMES)}


LABEL_SEEDS = [
    Seed(
        format=f"labels, {name}", suffix=suffix, data=data, elements=n, counted=counted, text=text,
        task="labels",
    )
    for name, suffix, data, n, counted, text in (
        ("seg", ".seg", lambda: _lines(LABELS), 44, False, True),
        ("txt", ".txt", lambda: _lines(_words()), 44, False, True),
        ("named lines", ".lab", _named_lines, 44, False, True),
        ("csv", ".csv", lambda: b"face,label\n" + rows(list(enumerate(LABELS)),
          between=",").encode(),
         44, False, True),
        ("json list", ".json", lambda: json.dumps(LABELS).encode(), 44, True, True),
        ("json map", ".json", lambda: json.dumps(_map()).encode(), 44, True, True),
        ("json groups", ".json", lambda: json.dumps(_groups()).encode(), 44, True, True),
        ("npy", ".npy", lambda: npy(np.array(LABELS)), 44, True, False),
        ("npz", ".npz", lambda: npz(labels=np.array(LABELS), names=np.array(NAMES)),
         44, True, False),
        ("ply", ".ply", _labelled_ply, 44, True, True),
        ("obj", ".obj", _grouped_obj, 44, False, True),
        ("stl", ".stl", _solids_stl, 44, True, True),
        ("glb", ".glb", _parted_glb, 44, True, False),
        ("nifti", ".nii", lambda: nifti(ell()), 10, True, False),
        ("nrrd", ".nrrd", lambda: nrrd(ell()), 10, True, False),
    )
]  # fmt: skip
"""A sound labelling in each form."""

OTHER_SEEDS = [
    Seed(
        format="result", suffix=".json", data=lambda: result_bytes(result()), elements=44,
        counted=True, text=True, task="result", beside=box_file(),
    ),
    Seed(
        format="recipe", suffix=".toml", data=RECIPE.encode, elements=3, counted=False, text=True,
        task="recipe",
    ),
    Seed(
        format="expression", suffix=".expression", elements=3, counted=False, text=True,
        data=lambda: b"3*narrow(handle) + perpendicular(handle, head)\n + is(head, area=0.3+-0.1)",
        task="expression",
    ),
]  # fmt: skip
