"""The page of a result in a browser: what is seen, and what clicks, keys and touches do."""

from __future__ import annotations

import re
import shlex

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core.cli import main
from moseg_core.components.cost import Cost
from moseg_core.problem.aggregate import CallValue, Evaluation, TermValue
from moseg_core.samples import sample_labels_path, sample_path
from moseg_core.search.showing import framed
from moseg_core.shape.shape import Shape
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html
from tests import shapes
from tests.browser.conftest import SETTLED, Viewer, content_of

pytestmark = pytest.mark.browser

HANDLE, HEAD = 0, 1


@pytest.fixture(scope="module")
def hammer():
    shape = moseg.load(sample_path("hammer"))
    found = moseg.read_labels(sample_labels_path("hammer"), shape)
    terms = tuple(
        TermValue(
            text=text,
            objective="x:y",
            weight=weight,
            calls=(CallValue(labels=labels, value=value),),
            worst=1.0,
        )
        for text, weight, labels, value in [
            ("narrow(handle)", 3.0, ("handle",), 0.1),
            ("compact(head)", 1.0, ("head",), 0.5),
            ("convex_parts", 1.0, (), 0.05),
        ]
    )
    evaluation = Evaluation(cost=Cost(0, 0.85), terms=terms)
    return content_of(shape, found.labels, found.names, evaluation=evaluation)


@pytest.fixture
def viewer(open_page, hammer):
    return open_page(hammer)


def test_parts_are_seen_in_their_colours(viewer):
    handle, head = viewer.seen(HANDLE), viewer.seen(HEAD)
    assert handle > 15_000
    assert head > 5_000
    assert 1.1 < handle / head < 4.0
    picture = viewer.picture()
    colored = (np.ptp(picture, axis=2) > 60).sum()
    assert handle + head > 0.97 * colored


def test_the_list_says_area_and_cost_worst_first(viewer):
    rows = viewer.page.locator("#parts > tr:not(.detail)")
    assert rows.count() == 2
    words = [rows.nth(k).inner_text().split() for k in range(2)]
    assert words == [
        ["head", "31.3", "%", "9,960", "0.5"],
        ["handle", "68.7", "%", "21,810", "0.3"],
    ]
    terms = viewer.page.locator("#terms tr")
    assert [terms.nth(k).inner_text().split() for k in range(3)] == [
        ["compact(head)", "0.5"],
        ["3", "\N{MULTIPLICATION SIGN}", "narrow(handle)", "0.3"],
        ["convex_parts", "0.05"],
    ]
    assert viewer.text("#cost") == "cost 0.85"


def test_a_click_in_the_list_isolates_and_escape_shows_all(viewer):
    page = viewer.page
    page.click("#parts button:has-text('head')")
    assert viewer.seen(HEAD) > 5_000
    assert viewer.seen(HANDLE) < 100
    assert "compact" in viewer.text("#parts tr.detail:not([hidden])")
    assert viewer.text("#said") == "head alone"
    page.keyboard.press("Escape")
    assert viewer.seen(HANDLE) > 15_000
    assert page.locator("#parts tr.detail:not([hidden])").count() == 0


def test_a_click_on_the_surface_isolates_and_one_beside_it_shows_all(viewer):
    viewer.click(HANDLE)
    assert viewer.seen(HEAD) < 100
    assert viewer.seen(HANDLE) > 15_000
    assert viewer.text("#alone-name") == "handle"
    viewer.page.mouse.click(20, 300)
    assert viewer.seen(HEAD) > 5_000


def test_a_checkbox_hides(viewer):
    viewer.page.uncheck("input[aria-label='show handle']")
    assert viewer.seen(HANDLE) == 0
    assert viewer.seen(HEAD) > 5_000
    viewer.page.click("#reset")
    assert viewer.seen(HANDLE) > 15_000
    assert viewer.page.is_checked("input[aria-label='show handle']")


def test_what_is_under_the_pointer_is_named(viewer):
    viewer.page.mouse.move(*viewer.point_of(HEAD))
    viewer.page.wait_for_selector("#tip:not([hidden])")
    assert viewer.text("#tip").split() == ["head", "31.3", "%"]
    assert viewer.text("#said") == "head, 31.3 % of the area"
    assert viewer.page.locator("#parts tr.hovered").inner_text().split()[0] == "head"
    viewer.page.mouse.move(20, 300)
    viewer.page.wait_for_selector("#tip", state="hidden")


def test_parts_are_pulled_apart(viewer):
    def gap():
        handle, head = viewer.places_of(HANDLE)[:, 1], viewer.places_of(HEAD)[:, 1]
        low, high = sorted([handle, head], key=lambda columns: columns.mean())
        return np.quantile(high, 0.01) - np.quantile(low, 0.99)

    before = gap()
    viewer.page.locator("#explode").fill("60")
    assert gap() > before + 30


def test_lines_are_drawn_and_can_be_left_out(viewer):
    def dark():
        return (viewer.picture().max(axis=2) < 50).sum()

    boundary = dark()
    assert boundary > 20
    viewer.page.click("#boundaries")
    assert dark() < 0.2 * boundary
    plain = viewer.picture()
    viewer.page.click("#wires")
    changed = np.abs(viewer.picture() - plain).max(axis=2) > 12
    assert changed.sum() > 5_000


def test_arrows_turn_and_plus_comes_nearer(viewer):
    page = viewer.page
    page.focus("canvas")
    first = viewer.picture()
    page.keyboard.press("ArrowLeft")
    turned = viewer.picture()
    assert (np.abs(turned - first).max(axis=2) > 40).sum() > 2_000
    page.keyboard.press("ArrowRight")
    assert (np.abs(viewer.picture() - first).max(axis=2) > 40).sum() < 200
    before = viewer.seen(HANDLE)
    page.keyboard.press("-")
    assert viewer.seen(HANDLE) < 0.9 * before
    page.keyboard.press("0")
    assert viewer.seen(HANDLE) == pytest.approx(before, rel=0.02)


def test_a_drag_turns_and_is_no_click(viewer):
    first = viewer.picture()
    x, y = viewer.point_of(HANDLE)
    viewer.page.mouse.move(x, y)
    viewer.page.mouse.down()
    viewer.page.mouse.move(x + 80, y + 10, steps=4)
    viewer.page.mouse.up()
    viewer.page.mouse.move(2, 2)
    assert (np.abs(viewer.picture() - first).max(axis=2) > 40).sum() > 2_000
    assert viewer.page.is_hidden("#alone")


def test_tab_goes_through_the_parts(viewer):
    page = viewer.page
    page.focus("#theme")
    reached = []
    for _ in range(4):
        page.keyboard.press("Tab")
        reached.append(
            page.evaluate("document.activeElement.ariaLabel || document.activeElement.textContent")
        )
    assert reached == ["show head", "head", "show handle", "handle"]
    page.keyboard.press("Enter")
    assert viewer.seen(HEAD) < 100


def test_the_parts_are_a_table_and_the_scene_has_words(viewer):
    page = viewer.page
    assert page.get_by_role("table", name="Parts").count() == 1
    assert page.get_by_role("rowheader", name="handle", exact=True).count() == 1
    label = page.get_attribute("canvas", "aria-label")
    assert label == "hammer in 3D, cut into handle, head; the parts are listed in the table"
    assert page.get_attribute("#said", "aria-live") == "polite"


def test_a_click_places_a_centre_that_the_command_line_takes(viewer, hammer, tmp_path, capsys):
    page, point = viewer.page, viewer.point_of(HANDLE)
    page.click("#place")
    assert viewer.text("#centers-of") == "head"  # the worst
    before = viewer.text("#centers-line")
    page.click("#parts button:has-text('handle')")
    assert viewer.text("#centers-of") == "handle"
    page.mouse.click(*point)
    viewer.settle()
    line, pins = viewer.text("#centers-line"), viewer.text("#pins-line")
    assert line != before
    _, centers = shlex.split(line)
    place = np.array([float(x) for x in re.match(r"handle=([^h]*),head=", centers)[1].split(",")])
    _, pin = shlex.split(pins)
    element = int(pin.removeprefix("handle="))
    shape = hammer.shape
    assert hammer.labels[element] == HANDLE
    assert np.linalg.norm(shape.points[element] - place) < 0.02 * shape.frame.scale
    search = "--recipe paper_hammer --seeder given --restarts 1 --workers 1 --quiet"
    words = ["segment", str(sample_path("hammer")), *shlex.split(f"{search} {line} {pins}")]
    words += ["--optimizer", "pattern_search(max_evaluations=2)", "-o", str(tmp_path / "x.seg")]
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 0, capsys.readouterr().err
    assert np.loadtxt(tmp_path / "x.seg", dtype=int)[element] == HANDLE


def test_shift_and_click_places_a_centre_of_the_part_there(viewer):
    viewer.page.keyboard.down("Shift")
    viewer.page.mouse.click(*viewer.point_of(HEAD))
    viewer.page.keyboard.up("Shift")
    viewer.settle()
    assert viewer.text("#centers-of") == "head"
    assert viewer.text("#pins-line").startswith("--pin 'head=")
    assert viewer.page.is_hidden("#alone")
    viewer.page.click("[data-copy=centers-line]")
    viewer.page.wait_for_selector("[data-copy=centers-line]:text-matches('Copied|Selected')")


def test_a_centre_that_is_placed_on_exploded_parts_is_on_the_shape(viewer, hammer):
    viewer.page.locator("#explode").fill("50")
    viewer.page.keyboard.down("Shift")
    viewer.page.mouse.click(*viewer.point_of(HEAD))
    viewer.page.keyboard.up("Shift")
    place = np.array(viewer.page.evaluate("moseg.viewer.centers.places.get(1)"))
    nearest = np.linalg.norm(hammer.shape.points - place, axis=1).min()
    assert nearest < 0.02 * hammer.shape.frame.scale


def test_hostile_names_do_nothing_but_stand_there(open_page, box):
    names = (
        "</script><script>window.hacked = 1</script>",
        "<img src=x onerror='window.hacked = 1'>",
        "\u202eright to left",
        "x" * 10_000,
        "it's, two=\nlines",
    )
    viewer = open_page(content_of(box, np.arange(22) % 5, names))
    page = viewer.page
    shown = page.evaluate(
        "[...document.querySelectorAll('#parts .name')].map((n) => n.textContent)"
    )
    assert sorted(shown) == sorted(names)
    for button in page.locator("#parts button").all():
        button.click()
    page.click("#place")
    assert "cannot be said in --centers" in viewer.text("#centers-problem")
    assert page.evaluate("window.hacked") is None
    assert page.locator("img").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth") <= 1000
    panel = page.evaluate(
        "(({ scrollWidth: all, clientWidth: room }) => all - room)(document.querySelector('aside'))"
    )
    assert panel <= 0


def test_nothing_is_loaded_even_where_a_script_would(viewer):
    refused = viewer.page.evaluate(
        """async () => {
            const told = new Promise((done) => {
                const tell = (event) => done(event.effectiveDirective);
                document.addEventListener("securitypolicyviolation", tell);
            });
            await fetch("https://example.org/").catch(() => null);
            return told;
        }"""
    )
    assert refused == "connect-src"
    viewer.complaints.clear()  # the browser says so on its console


def test_a_phone_shows_scene_and_list_and_takes_touches(open_page, hammer):
    viewer = open_page(
        hammer, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    page = viewer.page
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    tools, canvas = page.locator("#tools").bounding_box(), page.locator("canvas").bounding_box()
    assert tools["x"] >= 0
    assert tools["x"] + tools["width"] <= 390
    assert canvas["height"] > 350
    assert page.locator("#parts tr").first.bounding_box()["y"] < 844
    assert viewer.seen(HANDLE) > 3_000
    page.touchscreen.tap(*viewer.point_of(HEAD))
    assert viewer.seen(HANDLE) < 50
    # What covers the shape at its lower end would hide it.
    assert viewer.seen(HEAD) > 2_000


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_dark_as_the_system_is_and_as_the_button_says(open_page, hammer, scheme):
    viewer = open_page(hammer, color_scheme=scheme)

    def brightness():
        shot = viewer.picture()
        return shot[:30, :30].mean(), float(
            viewer.page.evaluate("getComputedStyle(document.body).backgroundColor.match(/\\d+/)[0]")
        )

    dark, light = ((0, 100), (180, 256))
    first, second = (dark, light) if scheme == "dark" else (light, dark)
    assert all(first[0] < value < first[1] for value in brightness())
    viewer.page.click("#theme")
    assert all(second[0] < value < second[1] for value in brightness())
    assert viewer.seen(HANDLE) > 15_000


def test_points_and_cells_are_seen_and_clicked(open_page):
    ball = np.random.default_rng(0).normal(size=(4000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    cloud = Shape.from_points(ball)
    grid = Shape.from_voxels(np.ones((6, 4, 4), bool))
    for shape, halves in [(cloud, ball[:, 2] > 0), (grid, grid.points[:, 0] > 3)]:
        viewer = open_page(content_of(shape, halves, ("one", "other")))
        both = viewer.seen(0), viewer.seen(1)
        assert min(both) > 5_000
        viewer.page.keyboard.down("Shift")
        viewer.page.mouse.click(*viewer.point_of(1))
        viewer.page.keyboard.up("Shift")
        element = int(re.search(r"other=(\d+)", viewer.text("#pins-line"))[1])
        assert halves[element]
        viewer.page.keyboard.press("Escape")
        viewer.page.mouse.move(2, 2)
        viewer.click(0)
        assert viewer.seen(1) < 0.05 * both[1]


def test_a_thinned_mesh_says_so_and_knows_the_elements_of_the_input(open_page):
    shape = Shape.from_mesh(*shapes.rectangle(10.0, 8.0, 80, 64))
    left = shape.points[:, 0] < 5
    viewer = open_page(content_of(shape, ~left, ("left", "right")), most=1500)
    assert re.search(r"draws 1,\d{3} of 10,240 triangles", viewer.text("#notes"))
    viewer.page.keyboard.down("Shift")
    viewer.page.mouse.click(*viewer.point_of(1))
    viewer.page.keyboard.up("Shift")
    element = int(re.search(r"right=(\d+)", viewer.text("#pins-line"))[1])
    assert not left[element]
    place = np.array(viewer.page.evaluate("moseg.viewer.centers.places.get(1)"))
    assert np.linalg.norm(shape.points[element] - place) < 0.6


def test_a_notebook_shows_it_in_its_frame(browser, hammer):
    frame = framed(page_html(page_document(hammer)))
    context = browser.new_context(viewport={"width": 900, "height": 700}, offline=True)
    page = context.new_page()
    viewer = Viewer(page)
    page.set_content(f"<!doctype html><body>{frame}</body>")
    inner = page.frames[1]
    inner.wait_for_selector("#parts button:has-text('head')")
    inner.evaluate(SETTLED)
    inner.click("#parts button:has-text('head')")
    inner.evaluate(SETTLED)
    assert inner.inner_text("#alone-name") == "head"
    assert viewer.complaints == []
    context.close()


def test_without_webgl_the_tables_are_there(launch, hammer, tmp_path):
    (tmp_path / "page.html").write_bytes(page_html(page_document(hammer)))
    context = launch("--disable-3d-apis").new_context(offline=True)
    page = context.new_page()
    page.goto((tmp_path / "page.html").as_uri())
    page.wait_for_selector("#failure:not([hidden])")
    assert "cannot draw in 3D" in page.inner_text("#failure")
    assert page.locator("#parts > tr:not(.detail)").count() == 2
    context.close()


def test_a_surface_that_is_divided_anew_is_drawn_so(viewer):
    """What a page does that goes on with a search."""
    viewer.page.click("#wires")
    whole = viewer.seen(HANDLE) + viewer.seen(HEAD)
    viewer.page.evaluate("moseg.viewer.stage.setLabels(moseg.viewer.stage.labels.map(() => 1))")
    assert viewer.seen(HANDLE) < 50
    assert viewer.seen(HEAD) > 0.9 * whole
    x, y = viewer.point_of(HEAD)
    box = viewer.page.locator("canvas").bounding_box()
    assert (
        viewer.page.evaluate(f"moseg.viewer.stage.partAt({x - box['x']}, {y - box['y']})") == HEAD
    )
