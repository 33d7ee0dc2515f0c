"""Pages opened in a real browser: Chromium without a screen or a network, drawing in software.

Needs playwright (the extra "browser") and Chromium (Debian's package ``chromium``, or the path in
``MOSEG_CHROMIUM``). Where either lacks, tests are skipped and say why; where ``MOSEG_BROWSER`` is
"required", as in CI, they fail.
"""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from moseg_core.view.page.content import PageContent, middle_places
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html
from moseg_core.view.palette import linear_light, part_colors

SOFTWARE = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
SOFTWARE += ["--enable-unsafe-swiftshader"]
DESKTOP = {"width": 1000, "height": 640}

#: Resolves when nothing is left to draw. A predicate that playwright polls would need an "eval",
#: which the page's policy forbids.
SETTLED = """async () => {
    const { stage } = moseg.viewer;
    const frame = () => new Promise((done) => requestAnimationFrame(() => done()));
    for (let quiet = 0, last = -1; quiet < 3; ) {
        await frame();
        quiet = last > 0 && stage.frames === last && !stage.asked ? quiet + 1 : 0;
        last = stage.frames;
    }
}"""


def lacking(reason: str) -> None:
    """Skip a test that cannot run here; in CI it fails."""
    if os.environ.get("MOSEG_BROWSER") == "required":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[..., Any]]:
    """Start a browser with further arguments."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        lacking("playwright is not installed; the extra 'browser' brings it")
    path = os.environ.get("MOSEG_CHROMIUM") or shutil.which("chromium")
    if path is None:
        lacking("there is no chromium; 'apt-get install chromium' brings it")
    with sync_playwright() as playwright:
        started = []

        def start(*more: str) -> Any:
            started.append(
                playwright.chromium.launch(executable_path=path, args=[*SOFTWARE, *more])
            )
            return started[-1]

        yield start
        for browser in started:
            browser.close()


@pytest.fixture(scope="session")
def browser(launch: Callable[..., Any]) -> Any:
    return launch()


class Viewer:
    """A page that is open, with what it has complained about and asked for."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.complaints: list[str] = []
        self.requests: list[str] = []
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("console", lambda said: said.type == "error" and self.complaints.append(said.text))
        page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        page.on("request", lambda request: self.requests.append(request.url))

    def settle(self) -> None:
        self.page.evaluate(SETTLED)

    def picture(self) -> np.ndarray:
        """(h, w, 3) what is seen of the scene, above the tools that lie over it."""
        self.settle()
        box = self.page.locator("canvas").bounding_box()
        shot = self.page.screenshot(clip={**box, "height": box["height"] - 76})
        return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)

    def places_of(self, part: int) -> np.ndarray:
        """(n, 2) row and column of the pixels that have the hue of a part, whatever the light."""
        count = len(self.page.evaluate("moseg.viewer.page.parts"))
        return np.argwhere(hue(self.picture()) @ hue(part_colors(count)[part]) > 0.998)

    def seen(self, part: int) -> int:
        """How many pixels show a part."""
        return len(self.places_of(part))

    def point_of(self, part: int) -> tuple[float, float]:
        """A place in the window in the midst of what is seen of a part."""
        places = self.places_of(part)
        shown = {tuple(place) for place in places.tolist()}
        middle = places.mean(axis=0)
        for row, column in places[np.argsort(np.abs(places - middle).sum(axis=1))].tolist():
            around = {(row + i, column + j) for i in (-4, 0, 4) for j in (-4, 0, 4)}
            if around <= shown:
                box = self.page.locator("canvas").bounding_box()
                return box["x"] + column + 0.5, box["y"] + row + 0.5
        raise AssertionError(f"part {part} is not to be seen")

    def click(self, part: int, **options: Any) -> None:
        """Click on the surface of a part."""
        self.page.mouse.click(*self.point_of(part), **options)
        self.page.mouse.move(2, 2)
        self.settle()

    def text(self, selector: str) -> str:
        found: str = self.page.inner_text(selector)
        return found


def hue(color: Any) -> np.ndarray:
    """Direction of a colour in linear light, which shading leaves alone."""
    light = linear_light(np.asarray(color, np.uint8))
    return light / np.maximum(np.linalg.norm(light, axis=-1, keepdims=True), 1e-9)


@pytest.fixture
def open_page(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Viewer]]:
    """Open a page, or the page of some content; what it complains about fails the test."""
    opened: list[Viewer] = []

    def open_(content: PageContent | bytes, *, most: int = 200_000, **context: Any) -> Viewer:
        page = content
        if isinstance(content, PageContent):
            page = page_html(page_document(content, most_triangles=most))
        path = tmp_path / f"page{len(opened)}.html"
        path.write_bytes(page)
        options = {"viewport": DESKTOP, "offline": True, **context}
        viewer = Viewer(browser.new_context(**options).new_page())
        viewer.page.goto(path.as_uri())
        viewer.settle()
        opened.append(viewer)
        return viewer

    yield open_
    for viewer in opened:
        viewer.page.context.close()
        assert viewer.complaints == []
        assert [url for url in viewer.requests if not url.startswith(("file:", "data:"))] == []


def content_of(shape: Any, labels: Any, names: tuple[str, ...], **more: Any) -> PageContent:
    """A labelled shape with centres to begin with."""
    labels = np.asarray(labels, np.int64)
    centers = middle_places(shape, labels, len(names))
    return PageContent(shape=shape, labels=labels, names=names, centers=centers, **more)
