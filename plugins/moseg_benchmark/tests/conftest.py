"""A small collection in the benchmark's layout: a capsule in three positions, two parts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from moseg_core import load_recipe, save_labels


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
def psb(tmp_path_factory) -> Path:
    """Models 21 and 25 (Cup), 381 (Fourleg), with three, two and no people."""
    data = tmp_path_factory.mktemp("psb")
    for name in ("off", "seg", "labels"):
        (data / name).mkdir()
    mesh = trimesh.creation.capsule(height=4.0, radius=0.5, count=[20, 16])
    middle = mesh.triangles_center[:, 2]
    thirds = np.digitize(middle, np.quantile(middle, [1 / 3, 2 / 3]))
    for number in (21, 25, 381):
        write_off(data / "off" / f"{number}.off", mesh.vertices + number, mesh.faces)
    people = {21: (thirds, thirds > 0, thirds), 25: (thirds, thirds == 1)}
    for number, segmentations in people.items():
        (data / "seg" / str(number)).mkdir()
        for k, segmentation in enumerate(segmentations):
            path = data / "seg" / str(number) / f"{number}_{k}.seg"
            save_labels(segmentation.astype(np.int64), path)
        named = data / "labels" / f"{number}_labels.txt"
        save_labels((thirds != 1).astype(np.int64), named, names=["one", "two"])
    (data / "off" / "notes.off").write_text("not a model")
    (data / "off" / "265.off").write_text("of a category that the benchmark does not have")
    (data / "capsule.toml").write_text(RECIPE)
    return data


@pytest.fixture(scope="session")
def recipe(psb):
    """The recipe of the capsule."""
    return load_recipe(str(psb / "capsule.toml"))
