"""A small collection in the benchmark's layout: a capsule in three positions, two parts."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from moseg_core import load_recipe, registry, save_labels


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


LEARNER = """\
from moseg_benchmark.label_matching import piece_counts
from moseg_core import Labelling, LearnerSpec, Method, Recipe, Statement, hookimpl


def counted(examples, *, weight=1.0, refiner="none"):
    named = [(e.shape, Labelling(labels=e.labels, names=e.names)) for e in examples]
    counts = {piece_counts(*example)["two"] for example in named}
    most = max(counts)
    names = [f"two{k + 1}" for k in range(most)] if most > 1 else ["two"]
    sets = [f"two{{{n}}}" for n in sorted(counts)]
    several = len(counts) > 1
    return Recipe(
        name="counted",
        statement=Statement(
            labels=("one", f"two{{{min(counts)}..{most}}}") if several else ("one", *names),
            variants=tuple(("one", text) for text in sets) if several else (),
            minimize=f"{weight:g}*narrow(one) + narrow(two*)",
            search=Method(
                optimizer="pattern_search(threshold=0.05)",
                refiner=None if refiner == "none" else refiner,
                restarts=1,
                resolution=100,
            ),
        ),
        learned_from=tuple(sorted(e.shape.name for e in examples)),
    )


@hookimpl
def moseg_learners():
    return [LearnerSpec(name="counted", target="counting_bundle:counted")]
"""


@pytest.fixture
def learner(tmp_path, monkeypatch):
    """A learner that is installed while a test runs: it counts parts, and wants them narrow."""
    site = tmp_path / "site"
    (site / "moseg_counting-1.0.dist-info").mkdir(parents=True)
    (site / "counting_bundle.py").write_text(LEARNER)
    header = "Metadata-Version: 2.1\nName: moseg-counting\nVersion: 1.0\n"
    (site / "moseg_counting-1.0.dist-info" / "METADATA").write_text(header)
    entry = "[moseg]\ncounting = counting_bundle\n"
    (site / "moseg_counting-1.0.dist-info" / "entry_points.txt").write_text(entry)
    monkeypatch.syspath_prepend(str(site))
    importlib.invalidate_caches()
    registry.cache_clear()
    yield "counted"
    sys.modules.pop("counting_bundle", None)
    monkeypatch.undo()
    importlib.invalidate_caches()
    registry.cache_clear()


@pytest.fixture(scope="session")
def members(tmp_path_factory) -> Path:
    """Cups 21, 22 and 24 with two ends, 23 with one, 25 of a single name, 26 without names."""
    data = tmp_path_factory.mktemp("members")
    for name in ("off", "seg", "labels"):
        (data / name).mkdir()
    for k, number in enumerate(range(21, 27)):
        mesh = trimesh.creation.capsule(height=3.5 + 0.25 * k, radius=0.5, count=[12, 10])
        middle = mesh.triangles_center[:, 2]
        thirds = np.digitize(middle, np.quantile(middle, [1 / 3, 2 / 3])).astype(np.int64)
        write_off(data / "off" / f"{number}.off", mesh.vertices, mesh.faces)
        (data / "seg" / str(number)).mkdir()
        for person, parts in enumerate((thirds, np.minimum(thirds, 1))):
            save_labels(parts, data / "seg" / str(number) / f"{number}_{person}.seg")
        ends = {23: thirds == 2, 25: thirds < 0}.get(number, thirds != 1).astype(np.int64)
        if number != 26:
            path = data / "labels" / f"{number}_labels.txt"
            save_labels(ends, path, names=["one", "two"])
    return data
