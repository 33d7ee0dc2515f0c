"""A scene written as SVG."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from moseg_core.view.scene import Dot, Line, Scene, Words
from moseg_core.view.svg import encode_svg

SVG = "{http://www.w3.org/2000/svg}"
RED = (200, 0, 10)


def written(*items, title=""):
    return ElementTree.fromstring(encode_svg(Scene(width=90, height=60, items=items, title=title)))


def test_lines_and_dots():
    root = written(
        Line(points=((1.0, 2.256), (3.5, -0.001)), color=RED, width=1.5, name="mean"),
        Dot(center=(10.0, 20.25), radius=2.5, color=RED, name="best"),
        Dot(center=(1.0, 2.0), radius=2.5, color=RED, hollow=True),
    )
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("90", "60", "0 0 90 60")
    (line,) = root.iter(f"{SVG}polyline")
    assert line.get("points") == "1,2.26 3.5,0"
    assert (line.get("stroke"), line.get("stroke-width")) == ("#c8000a", "1.5")
    assert line.get("fill") == "none"
    full, hollow = root.iter(f"{SVG}circle")
    assert [full.get(key) for key in ("cx", "cy", "r", "fill")] == ["10", "20.25", "2.5", "#c8000a"]
    assert (hollow.get("fill"), hollow.get("stroke")) == ("#ffffff", "#c8000a")
    assert [title.text for title in root.iter(f"{SVG}title")] == [None, "mean", "best"]


def test_words():
    level, upward = written(
        Words(text="generation", at=(5.0, 6.0), size=12.0, color=RED, anchor="middle"),
        Words(text="cost", at=(7.0, 8.0), size=12.0, color=RED, upward=True),
    ).iter(f"{SVG}text")
    assert (level.text, level.get("text-anchor"), level.get("transform")) == (
        "generation",
        "middle",
        None,
    )
    assert upward.get("transform") == "rotate(-90 7 8)"


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("<b> & \"c\" 'd' ]]>", "<b> & \"c\" 'd' ]]>"),
        ("</text><script>x</script>", "</text><script>x</script>"),
        ("bell\x07 null\x00\nline \ud800 \uffff", "bell null line"),
        ("Größe 大", "Größe 大"),
    ],
)
def test_texts_are_escaped(text, read):
    root = written(
        Words(text=text, at=(0.0, 0.0), size=9.0, color=RED),
        Dot(center=(0.0, 0.0), radius=1.0, color=RED, name=text),
        title=text,
    )
    assert [e.text for e in root.iter(f"{SVG}text")] == [read]
    assert [e.text for e in root.iter(f"{SVG}title")] == [read, read]
    assert not list(root.iter(f"{SVG}script"))
