"""The slider over the search in a browser: what is seen on the way, and at the end again."""

from __future__ import annotations

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core.components.cost import Cost
from moseg_core.samples import sample_labels_path, sample_path
from moseg_core.search.incumbents import Incumbent
from moseg_core.view.page.steps import SearchSteps, Step
from tests.browser.conftest import SETTLED, content_of

pytestmark = pytest.mark.browser

HANDLE, HEAD = 0, 1
COSTS = 2.5, 1.25, 1.0


@pytest.fixture(scope="module")
def hammer():
    """A search that began with the names exchanged and then had nearly everything one part."""
    shape = moseg.load(sample_path("hammer"))
    found = moseg.read_labels(sample_labels_path("hammer"), shape)
    labels = np.asarray(found.labels, np.int64)
    ends = np.array([shape.points[labels == k].mean(axis=0) for k in (HANDLE, HEAD)])
    nearly = np.where(np.arange(len(labels)) < 8, HEAD, HANDLE)
    before = tuple(
        Step(
            stage=stage,
            evaluations=10**k,
            cost=Cost(int(k == 1), cost),
            labels=row,
            places=places,
            parts=np.arange(2),
        )
        for k, (stage, cost, row, places) in enumerate(
            zip(("start", "search"), COSTS, (1 - labels, nearly), (ends[::-1], ends), strict=False)
        )
    )
    centers = moseg.Centers(positions=ends, weights=np.ones(2))
    last = Incumbent(stage="end", evaluations=2345, cost=Cost(0, COSTS[2]), centers=centers)
    search = SearchSteps(before=before, last=last, refined=True)
    return content_of(shape, labels, found.names, search=search)


@pytest.fixture
def viewer(open_page, hammer):
    return open_page(hammer)


def said(viewer):
    return viewer.text("#steps-said").split("\n")


def marks(viewer):
    return viewer.page.evaluate(
        "moseg.viewer.stage.markers.children.map((m) => [m.userData.part, m.position.toArray()])"
    )


def test_the_page_opens_with_the_result(viewer):
    handle, head = viewer.seen(HANDLE), viewer.seen(HEAD)
    assert handle > 1.1 * head > 5_000
    assert said(viewer) == ["result", "2,345 evaluations", "cost 1", "boundaries refined"]
    assert marks(viewer) == []


def test_each_step_is_seen_with_its_centres_and_the_end_is_as_before(viewer):
    handle, head = viewer.seen(HANDLE), viewer.seen(HEAD)
    slider = viewer.page.locator("#steps")
    slider.fill("0")
    assert said(viewer) == ["start", "1 evaluation", "cost 2.5"]
    # The marks of the centres cover a little.
    assert viewer.seen(HANDLE) == pytest.approx(head, rel=0.03)
    assert viewer.seen(HEAD) == pytest.approx(handle, rel=0.03)
    first = dict(marks(viewer))
    slider.fill("1")
    assert said(viewer) == ["search", "10 evaluations", "cost 1.25", "1 part empty"]
    assert viewer.seen(HANDLE) > 0.95 * (handle + head)
    second = dict(marks(viewer))
    assert second[HANDLE] == pytest.approx(first[HEAD])
    assert second[HEAD] != pytest.approx(first[HEAD])
    slider.fill("2")
    assert (viewer.seen(HANDLE), viewer.seen(HEAD)) == (handle, head)
    assert marks(viewer) == []


def test_arrows_move_the_slider_and_screen_readers_hear_the_step(viewer):
    page, slider = viewer.page, viewer.page.locator("#steps")
    assert page.get_by_role("slider", name="How the search went").count() == 1
    slider.focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("ArrowLeft")
    viewer.settle()
    assert slider.get_attribute("aria-valuetext") == "1 of 3: start, 1 evaluation, cost 2.5"
    assert viewer.seen(HEAD) > 1.1 * viewer.seen(HANDLE)
    page.keyboard.press("End")
    viewer.settle()
    assert viewer.seen(HANDLE) > 1.1 * viewer.seen(HEAD)


def test_keys_at_the_scene_and_reset(viewer):
    page = viewer.page
    page.locator("canvas").focus()
    page.keyboard.press(",")
    page.keyboard.press(",")
    viewer.settle()
    assert said(viewer)[0] == "start"
    page.keyboard.press(".")
    viewer.settle()
    assert said(viewer)[0] == "search"
    page.click("#reset")
    viewer.settle()
    assert said(viewer)[0] == "result"
    assert page.input_value("#steps") == "2"


def test_it_plays_to_the_end_and_can_be_paused(viewer):
    page = viewer.page
    assert page.get_by_role("button", name="Play the search").count() == 1
    press = "document.getElementById('steps-play').click();"
    page.evaluate(press + press)  # at one moment, so that no step passes between them
    assert page.input_value("#steps") == "0"
    assert page.get_attribute("#steps-play", "aria-pressed") == "false"
    page.evaluate(
        """() => {
            window.heard = [];
            const node = document.getElementById("steps-said");
            const hear = () => window.heard.push(node.firstChild.textContent);
            new MutationObserver(hear).observe(node, { childList: true });
            document.getElementById("steps").value = 2;
            document.getElementById("steps-play").click();
        }"""
    )
    page.wait_for_selector("#steps-play[aria-pressed='false']")
    viewer.settle()
    assert page.evaluate("window.heard") == ["start", "search", "result"]
    assert viewer.seen(HANDLE) > 1.1 * viewer.seen(HEAD)


def test_what_is_isolated_hidden_exploded_and_hovered_stays_so(viewer):
    page = viewer.page
    page.click("#parts button:has-text('head')")
    page.locator("#steps").fill("0")
    assert viewer.seen(HANDLE) < 100
    assert viewer.seen(HEAD) > 10_000
    page.mouse.move(*viewer.point_of(HEAD))
    page.wait_for_selector("#tip:not([hidden])")
    assert viewer.text("#tip").split() == ["head"]  # its share is that of the result


def test_a_centre_is_placed_on_the_way_too(viewer, hammer):
    page = viewer.page
    page.locator("#steps").fill("0")
    viewer.settle()
    page.keyboard.down("Shift")
    page.mouse.click(*viewer.point_of(HEAD))
    page.keyboard.up("Shift")
    place = np.array(page.evaluate("moseg.viewer.centers.places.get(1)"))
    nearest = np.linalg.norm(hammer.shape.points - place, axis=1).min()
    assert nearest < 0.02 * hammer.shape.frame.scale
    page.keyboard.press("Escape")
    assert len(marks(viewer)) == 2  # those of the step again


def test_a_phone_has_room_for_it_and_takes_touches(open_page, hammer):
    viewer = open_page(
        hammer, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    page, slider = viewer.page, viewer.page.locator("#steps")
    box = slider.bounding_box()
    assert box["height"] >= 44
    assert box["y"] + box["height"] < 844
    assert box["x"] + box["width"] <= 390
    page.touchscreen.tap(box["x"] + 3, box["y"] + box["height"] / 2)
    page.evaluate(SETTLED)
    assert said(viewer)[0] == "start"
    assert page.evaluate("document.documentElement.scrollWidth") == 390


def test_without_steps_there_is_no_slider(open_page, box):
    viewer = open_page(content_of(box, np.arange(22) % 2, ("one", "two")))
    assert viewer.page.is_hidden("#steps-section")
    assert viewer.page.is_hidden("#steps-deed")


def test_a_search_of_its_own_is_shown(open_page, tmp_path):
    shape = moseg.load(sample_path("hammer"))
    problem = moseg.Problem(["handle", "head"], "narrow(handle) + compact(head)")
    few = "pattern_search(max_evaluations=60)"
    result = moseg.segment(shape, problem, optimizer=few, resolution=300)
    path = tmp_path / "own.html"
    moseg.save(result, path)
    viewer = open_page(path.read_bytes())
    viewer.page.locator("#steps").fill("0")
    assert said(viewer)[0] == "start"
    assert viewer.seen(HANDLE) + viewer.seen(HEAD) > 20_000
    assert len(marks(viewer)) == 2
