"""A scene as SVG: the text of the drawing, sharp at any size.

The file needs nothing from elsewhere: no style sheet, no script, and whatever sans-serif font the
reader has. Every line and dot with a name carries it as a ``<title>``, which browsers show under
the pointer and screen readers say. Coordinates have two decimals; equal scenes give equal bytes.

SVG 1.1, https://www.w3.org/TR/SVG11/.
"""

from __future__ import annotations

from xml.sax.saxutils import escape, quoteattr

from moseg_core.view.legend import one_line
from moseg_core.view.scene import Color, Dot, Item, Line, Scene

_FONT = "Helvetica, Arial, sans-serif"


def encode_svg(scene: Scene) -> bytes:
    """Write a scene as an SVG file.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    bytes
        UTF-8. Characters that cannot be drawn are left out of texts, the others escaped.

    Examples
    --------
    >>> from moseg_core.view.scene import Line
    >>> rule = Line(points=((0.0, 1.0), (8.0, 1.0)), color=(0, 0, 0), name="a < b")
    >>> print(encode_svg(Scene(width=8, height=2, items=(rule,))).decode())
    <svg xmlns="http://www.w3.org/2000/svg" width="8" height="2" viewBox="0 0 8 2" role="img">
    <title></title>
    <rect width="8" height="2" fill="#ffffff"/>
    <polyline points="0,1 8,1" fill="none" stroke="#000000" stroke-width="1"
      stroke-linejoin="round" stroke-linecap="round"><title>a &lt; b</title></polyline>
    </svg>
    """
    width, height = scene.width, scene.height
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"'
        f' viewBox="0 0 {width} {height}" role="img">',
        f"<title>{_escaped(scene.title)}</title>",
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        *map(_element, scene.items),
        "</svg>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _element(item: Item) -> str:
    """The element that draws one item."""
    if isinstance(item, Line):
        points = " ".join(f"{_number(x)},{_number(y)}" for x, y in item.points)
        look = (
            f'points="{points}" fill="none" stroke="{_hex(item.color)}"'
            f' stroke-width="{_number(item.width)}" stroke-linejoin="round" stroke-linecap="round"'
        )
        return _named("polyline", look, item.name)
    if isinstance(item, Dot):
        x, y = item.center
        fill = "#ffffff" if item.hollow else _hex(item.color)
        look = (
            f'cx="{_number(x)}" cy="{_number(y)}" r="{_number(item.radius)}" fill="{fill}"'
            f' stroke="{_hex(item.color)}"'
        )
        return _named("circle", look, item.name)
    x, y = item.at
    turn = f' transform="rotate(-90 {_number(x)} {_number(y)})"' if item.upward else ""
    return (
        f'<text x="{_number(x)}" y="{_number(y)}" font-family={quoteattr(_FONT)}'
        f' font-size="{_number(item.size)}" fill="{_hex(item.color)}"'
        f' text-anchor="{item.anchor}"{turn}>{_escaped(item.text)}</text>'
    )


def _named(tag: str, look: str, name: str) -> str:
    title = f"<title>{_escaped(name)}</title>" if name else ""
    return f"<{tag} {look}>{title}</{tag}>" if title else f"<{tag} {look}/>"


def _escaped(text: str) -> str:
    return escape(one_line(text))


def _number(value: float) -> str:
    """A length with at most two decimals, the shortest way."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _hex(color: Color) -> str:
    return "#" + "".join(f"{channel:02x}" for channel in color)
