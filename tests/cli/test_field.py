"""``moseg field``: numbers on stdout, files by suffix, and what cannot be asked."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from PIL import Image

import moseg_core
from moseg_core.components.discovery.registry import registry

BUNDLE = """
    from moseg_core import FieldSpec, hookimpl

    @hookimpl
    def moseg_fields():
        return [
            FieldSpec(name="altitude", target="given_fields:altitude", summary="how high"),
            FieldSpec(name="tilted", target="given_fields:tilted"),
            FieldSpec(name="girth", target="given_fields:girth", requires=("volume",)),
        ]
"""
FIELDS = """
    from typing import Annotated
    from moseg_core import Interval, Table

    def altitude(shape, *, factor: Annotated[float, Interval(0, 9)] = 1.0):
        return factor * shape.points[:, 2]

    def tilted(shape, *, toward: Table):
        return shape.points @ [toward["x"], 0.0, toward["more"]["z"]]

    def girth(shape):
        return shape.areas / shape.volume
"""


@pytest.fixture
def fields(site):
    """Two fields, installed until the test ends."""
    site.add("Given", bundles={"given": "given_bundle"}, given_bundle=BUNDLE, given_fields=FIELDS)
    registry.cache_clear()
    yield
    registry.cache_clear()


def test_prints_the_mean_and_the_extremes(moseg, fields, mallet):
    shape = moseg_core.load(mallet)
    height = 2.0 * shape.points[:, 2]
    run = moseg("field", mallet, "altitude(factor=2)", "--json")
    assert run.code == 0, run.err
    told = json.loads(run.out)
    assert (told["field"], told["elements"]) == ("given:altitude(factor=2)", shape.n_elements)
    assert told["least"] == height.min()
    assert told["greatest"] == height.max()
    assert told["mean"] == pytest.approx(height @ shape.areas / shape.area)
    table = moseg("field", mallet, "given:altitude").out.split()
    assert table[:2] == ["given:altitude:", str(shape.n_elements)]
    assert f"{shape.points[:, 2].max():.6g}" in table


def test_a_table_is_that_of_a_recipe(moseg, fields, mallet, tmp_path):
    recipe = tmp_path / "mine.toml"
    recipe.write_text(
        'labels = ["a"]\nminimize = "narrow(a)"\n[given.way]\nx = 2.0\n[given.way.more]\nz = -1\n'
    )
    run = moseg("field", mallet, "tilted(toward=way)", "--recipe", recipe, "--json")
    assert run.code == 0, run.err
    told = json.loads(run.out)
    values = moseg_core.load(mallet).points @ [2.0, 0.0, -1.0]
    assert told["greatest"] == pytest.approx(values.max())
    assert told["field"] == "given:tilted(toward=way)"
    run = moseg("field", mallet, "tilted(toward=wya)", "--recipe", recipe)
    assert (run.code, "unknown table 'wya'; did you mean 'way'?" in run.err) == (2, True)
    run = moseg("field", mallet, "tilted(toward=way)")
    assert (run.code, "parameter 'toward' must be a table, not 'way'" in run.err) == (2, True)


def test_writes_what_is_asked_for(moseg, fields, mallet, tmp_path):
    paths = [tmp_path / f"h.{suffix}" for suffix in ("png", "npy", "csv", "ply")]
    run = moseg("field", mallet, "altitude", *(word for path in paths for word in ("-o", path)))
    assert run.code == 0, run.err
    assert [f"wrote {path}" in run.err for path in paths] == [True] * 4
    shape = moseg_core.load(mallet)
    assert np.load(paths[1]).tolist() == shape.points[:, 2].tolist()
    assert len(paths[2].read_text().splitlines()) == shape.n_elements + 1
    assert moseg_core.load(paths[3]).n_elements == shape.n_elements
    with Image.open(io.BytesIO(paths[0].read_bytes())) as image:
        assert image.size == (1400, 700)


def test_a_field_of_a_cloud_has_a_picture_too(moseg, fields, tmp_path):
    points = np.random.default_rng(0).uniform(-1, 1, (60, 3))
    cloud = tmp_path / "cloud.xyz"
    cloud.write_text("".join(f"{x} {y} {z}\n" for x, y, z in points))
    run = moseg("field", cloud, "altitude", "-o", tmp_path / "c.png", "-o", tmp_path / "c.ply")
    assert run.code == 0, run.err
    assert moseg_core.load(tmp_path / "c.ply").n_elements == 60


def test_one_file_that_fails_takes_no_other_along(moseg, fields, mallet, tmp_path):
    (tmp_path / "full.npy").symlink_to("/dev/full")
    out = tmp_path / "x.csv"
    run = moseg("field", mallet, "altitude", "-o", tmp_path / "full.npy", "-o", out)
    assert (run.code, "a link to '/dev/full'" in run.err, out.exists()) == (1, True, True)
    assert "mean" in run.out


def test_says_what_it_cannot_do(moseg, fields, mallet, open_box, tmp_path):
    for code, words, says in [
        (2, (mallet, "altitud"), "unknown field 'altitud'; did you mean 'altitude'?"),
        (2, (mallet, "altitude(factr=2)"), "unknown parameter 'factr'; did you mean 'factor'?"),
        (2, (mallet, "altitude(factor=10)"), "allowed is 0 to 9"),
        (2, (mallet, "altitude("), "altitude("),
        (2, (mallet, "altitude", "-o", tmp_path / "x.npz"), "did you mean '.npy'?"),
        (2, (mallet, "altitude", "-o", tmp_path / "x"), "written as .png, .ply, .npy, .csv"),
        (2, (mallet, "altitude", "-o", tmp_path / "no" / "x.png"), "there is no folder"),
        (3, (open_box, "girth"), "field 'given:girth' needs an enclosed volume"),
    ]:
        run = moseg("field", *words)
        assert run.code == code, (words, run.err)
        assert says in run.err
    copy = tmp_path / "copy.ply"
    assert moseg("field", mallet, "altitude", "-o", copy).code == 0
    before = copy.read_bytes()
    run = moseg("field", copy, "altitude", "-o", copy)
    assert (run.code, "is read here" in run.err) == (2, True)
    assert copy.read_bytes() == before


def test_a_field_is_listed_and_explained(moseg, fields):
    assert "given:altitude" in moseg("plugin", "list").out
    text = " ".join(moseg("plugin", "explain", "given:girth").out.split())
    assert "needs volume" in text
    assert "moseg field SHAPE given:girth" in text
    (told,) = json.loads(moseg("plugin", "explain", "girth", "--json").out)
    assert told["requires"] == ["volume"]
