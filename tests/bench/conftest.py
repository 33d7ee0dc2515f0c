"""A small collection in the benchmark's layout: a capsule in three positions, two parts."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io import encode_named_labels, encode_seg
from tests import shapes


def write_off(path, vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path.write_text("\n".join(lines) + "\n")


RECIPE = """\
labels = ["one", "two1", "two2"]
minimize = "narrow(one) + narrow(two*) + convex_parts"
optimizer = "pattern_search(threshold=0.05)"
restarts = 1
"""


@pytest.fixture(scope="session")
def psb(tmp_path_factory):
    """Models 21 and 25 (Cup), 381 (Fourleg), with three, two and no people."""
    data = tmp_path_factory.mktemp("psb")
    for name in ("off", "seg", "labels"):
        (data / name).mkdir()
    vertices, faces = shapes.bent_capsule(24, 10)
    vertices = np.asarray(vertices)
    middle = np.array([vertices[list(face)].mean(axis=0)[0] for face in faces])
    thirds = np.digitize(middle, np.quantile(middle, [1 / 3, 2 / 3]))
    for number in (21, 25, 381):
        write_off(data / "off" / f"{number}.off", vertices + number, faces)
    people = {21: (thirds, thirds > 0, thirds), 25: (thirds, thirds == 1)}
    for number, segmentations in people.items():
        (data / "seg" / str(number)).mkdir()
        for k, segmentation in enumerate(segmentations):
            path = data / "seg" / str(number) / f"{number}_{k}.seg"
            path.write_bytes(encode_seg(segmentation.astype(np.int64)))
        named = encode_named_labels((thirds != 1).astype(np.int64), ["one", "two"])
        (data / "labels" / f"{number}_labels.txt").write_bytes(named)
    (data / "off" / "notes.off").write_text("not a model")
    (data / "off" / "265.off").write_text("of a category that the benchmark does not have")
    recipe = data / "capsule.toml"
    recipe.write_text(RECIPE)
    return data
