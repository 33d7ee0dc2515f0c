"""``moseg tune`` in a browser: sliders, a centre that is moved, and what is kept."""

from __future__ import annotations

import pytest

import moseg_core as moseg
from moseg_core.tune.server import Destinations, TuneServer
from tests.browser.conftest import Viewer
from tests.tune.conftest import serving, small_session

pytestmark = pytest.mark.browser

STEM, BAR = 0, 1


class Tuner:
    """A page that is served, in a browser."""

    def __init__(self, viewer, session):
        self.viewer, self.page, self.session = viewer, viewer.page, session

    def slide(self, term, steps):
        """Move a slider by the keyboard, in its steps of a quarter of a doubling."""
        slider = self.page.locator("#tune-terms input").nth(term)
        slider.focus()
        for _ in range(abs(steps)):
            slider.press("ArrowRight" if steps > 0 else "ArrowLeft")

    def press(self, button):
        """Press a button after which the page loads itself anew."""
        with self.page.expect_navigation():
            self.page.click(button)
        self.viewer.settle()


@pytest.fixture
def tune(browser, tmp_path):
    session = small_session()
    destinations = Destinations(recipe=tmp_path / "mine.toml", example=tmp_path / "tee.json")
    server = TuneServer(session, destinations, say=lambda line: None)
    with serving(server), browser.new_context(viewport={"width": 1000, "height": 640}) as context:
        viewer = Viewer(context.new_page())
        viewer.page.goto(server.url)
        viewer.settle()
        yield Tuner(viewer, session)
        assert viewer.complaints == []
        assert all(request.startswith(server.url) for request in viewer.requests)


def test_a_weight_is_changed_searched_with_saved_and_taken_back(tune, tmp_path):
    page = tune.page
    tune.slide(0, 8)
    assert page.locator("#tune-terms output").all_inner_texts() == ["4", "2", "1"]
    tune.slide(2, -30)
    assert page.locator("#tune-terms output").all_inner_texts() == ["4", "2", "off"]
    tune.press("#tune-on")
    assert tune.session.weights == (4.0, 2.0, 0.0)
    assert page.locator("#tune-terms output").all_inner_texts() == ["4", "2", "off"]
    page.click("#tune-recipe")
    page.get_by_text(f"wrote {tmp_path / 'mine.toml'}").wait_for()
    saved = moseg.load_recipe(str(tmp_path / "mine.toml")).statement
    assert saved.minimize == "4*narrow(stem) + 2*narrow(bar)"
    page.click("#tune-example")
    page.get_by_text(f"wrote {tmp_path / 'tee.json'}").wait_for()
    tune.press("#tune-back")
    assert page.locator("#tune-terms output").all_inner_texts() == ["1", "2", "1"]
    assert page.locator("#tune-back").is_disabled()


def test_a_centre_that_was_clicked_is_where_the_search_begins(tune):
    page, viewer = tune.page, tune.viewer
    x, y = viewer.point_of(BAR)
    page.click(f"#parts tr[data-part='{BAR}'] button")  # chosen, so that its centre is placed
    viewer.settle()
    page.keyboard.down("Shift")
    page.mouse.click(x, y)
    page.keyboard.up("Shift")
    assert page.locator("#tune-moved").inner_text() == "Moved: bar"
    page.check("#tune-hold")
    element = page.evaluate("[...moseg.viewer.centers.elements.values()][0]")
    tune.press("#tune-on")
    position = tune.session.result.centers.positions[BAR]
    assert position == pytest.approx(tune.session.shape.points[element])


def test_the_shape_is_looked_at_from_where_it_was(tune):
    page = tune.page
    page.locator("canvas").focus()
    for _ in range(5):
        page.keyboard.press("ArrowLeft")
    tune.viewer.settle()
    before = page.evaluate("moseg.viewer.stage.lookingFrom().from")
    tune.press("#tune-anew")
    assert page.evaluate("moseg.viewer.stage.lookingFrom().from") == pytest.approx(before, abs=0.01)


def test_what_the_server_refuses_is_shown(tune):
    page = tune.page
    for term in range(3):
        tune.slide(term, -40)
    page.click("#tune-on")
    page.get_by_text("every term has weight 0").wait_for()
    tune.viewer.complaints.clear()  # the browser logs every answer that is a refusal
    assert page.locator("#tune-on").is_enabled()
