"""Pictures of a case, and the page that shows them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from moseg_benchmark.cases import BenchmarkCase, CaseResult
from moseg_benchmark.page import draw_case, write_page
from moseg_benchmark.psb import find_models
from moseg_benchmark.tables import Table

from moseg_core import load


def test_a_case_is_drawn_beside_two_people(psb, recipe, tmp_path):
    model = find_models(psb)[0]
    labels = np.arange(load(model.mesh).n_elements) % 3
    case = BenchmarkCase(model=model, method="default", recipe=recipe)
    names = draw_case(case, recipe, labels, tmp_path)
    assert names == ["21-capsule-default-0.png", "21-person-1.png", "21-person-2.png"]
    for name in names:
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_pictures_of_people_that_are_there_stay(psb, recipe, tmp_path):
    model = find_models(psb)[0]
    (tmp_path / "21-person-1.png").write_bytes(b"there")
    labels = np.zeros(load(model.mesh).n_elements, np.int64)
    draw_case(BenchmarkCase(model=model, method="default", recipe=recipe), recipe, labels, tmp_path)
    assert (tmp_path / "21-person-1.png").read_bytes() == b"there"
    assert (tmp_path / "21-person-2.png").read_bytes() != b"there"


def test_the_page_shows_what_has_pictures_and_escapes_names(tmp_path):
    shown = CaseResult(
        model=21, category="Cup", method="default", recipe="a<b", rand_index_error=0.25, cost=3.0
    )
    write_page(
        tmp_path / "index.html",
        title="Agreement",
        tables=[Table("Numbers", ["category", "models"], [["Cup & co", "1"]])],
        failed=["Cup 25, default: no disk"],
        results=[shown, replace(shown, model=25)],
        pictures={shown: ["pictures/a b.png"]},
    )
    page = (tmp_path / "index.html").read_text()
    assert page.count("<figure>") == 1
    assert "Cup 21, a&lt;b, default, seed 0: 1-RI 0.250, cost 3</figcaption>" in page
    assert 'src="pictures/a%20b.png"' in page
    assert "<td>Cup &amp; co</td>" in page
    assert "<li>Cup 25, default: no disk\n" in page
