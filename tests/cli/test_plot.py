"""``moseg plot``, and the same curves as an output of ``moseg segment``."""

from __future__ import annotations

import io
import json
from xml.etree import ElementTree

import pytest
from PIL import Image

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def segmented(moseg, mallet, tmp_path):
    """A result, and its curves as the same run wrote them."""
    result, chart = tmp_path / "m.json", tmp_path / "m.svg"
    run = moseg("segment", mallet, "--recipe", "paper_hammer", "-o", result, "-o", chart)
    assert run.code == 0
    return result, chart


def test_draws_the_curves_of_a_result(moseg, segmented, tmp_path):
    result, chart = segmented
    out = tmp_path / "again.svg"
    run = moseg("plot", result, "-o", out)
    assert (run.code, run.out) == (0, "")
    assert f"wrote {out}" in run.err
    assert out.read_bytes() == chart.read_bytes()
    history = json.loads(result.read_text())["history"]
    lengths = {
        line.find(f"{SVG}title").text: len(line.get("points").split())
        for line in ElementTree.parse(out).iter(f"{SVG}polyline")
        if line.find(f"{SVG}title") is not None
    }
    assert lengths["largest step of a centre"] == len(history["seeding"])
    assert lengths["cost"] == len(history["search"])


def test_draws_a_png_twice_as_large(moseg, segmented, tmp_path):
    out = tmp_path / "curves.PNG"
    assert moseg("plot", segmented[0], "-o", out).code == 0
    root = ElementTree.parse(segmented[1]).getroot()
    with Image.open(io.BytesIO(out.read_bytes())) as image:
        assert image.size == (2 * int(root.get("width")), 2 * int(root.get("height")))


def test_says_what_it_cannot_do(moseg, segmented, tmp_path):
    result = segmented[0]
    for words, says in [
        ((result, "-o", tmp_path / "x.pdf"), "written as .svg or .png, not '.pdf'"),
        ((result, "-o", tmp_path / "x"), "written as .svg or .png, not a file without a suffix"),
        ((result, "-o", tmp_path / "no" / "x.svg"), "there is no folder"),
        ((tmp_path / "none.json", "-o", tmp_path / "x.svg"), "cannot be read as a result"),
        ((result,), "--out"),
    ]:
        run = moseg("plot", *words)
        assert run.code == 2
        assert says in run.err
        assert "\n" not in run.err.strip()


@pytest.mark.parametrize("history", [{"search": [3]}, {"search": [{"value": "low"}]}, [1], "x"])
def test_a_damaged_history(moseg, segmented, tmp_path, history):
    document = json.loads(segmented[0].read_text())
    document["history"] = history
    damaged = tmp_path / "damaged.json"
    damaged.write_text(json.dumps(document))
    run = moseg("plot", damaged, "-o", tmp_path / "x.svg")
    assert run.code == 2
    assert "is a damaged result ('history" in run.err
    assert not (tmp_path / "x.svg").exists()
