"""A batch with its page: drawn by guarded children, once, whatever harms a drawing."""

from __future__ import annotations

import json
from pathlib import Path

from moseg_core.batching.driver import batch
from moseg_core.batching.ledger import read_ledger
from moseg_core.problem.statement import Statement
from tests.batching.planted import OPTIONS, write_shape

PLAIN = Statement(labels=("a", "b"), minimize="narrow(a)")


def test_each_result_is_drawn_and_measured_once(shape_folder):
    for name in ("a", "bb", "broken"):
        write_shape(shape_folder, name)
    given = {"options": OPTIONS, "workers": 1, "page": True}
    done = batch(["models/*.off"], PLAIN, "out", **given)
    assert done.page == Path("out/report.html")
    assert sorted(p.name for p in Path("out/report").iterdir()) == [
        *("a.json", "a.png", "bb.json", "bb.png"),
    ]
    assert Path("out/report/a.png").read_bytes()[:4] == b"\x89PNG"
    page = done.page.read_text()
    assert 'src="report/a.png"' in page
    assert "broken.off" in page
    rows = json.loads(Path("out/report/a.json").read_text())["rows"]
    assert [row["part"] for row in rows] == ["a", "b"]
    ledger = read_ledger(Path("out"))
    assert len(ledger) == 3

    # What is there is taken as it is; what is another result's, or damaged, is made anew.
    kept = Path("out/report/a.png")
    kept.write_bytes(b"mine")
    Path("out/report/bb.json").write_text("{")
    again = batch(["models/*.off"], PLAIN, "out", resume=True, **given)
    assert again.page.read_text() == page
    assert kept.read_bytes() == b"mine"
    assert json.loads(Path("out/report/bb.json").read_text())["rows"]
    assert read_ledger(Path("out")) == ledger


def test_whoever_stops_meanwhile_has_the_results_and_no_page(shape_folder):
    write_shape(shape_folder, "a")
    done = batch(
        *(["models/*.off"], PLAIN, "out"),
        options=OPTIONS,
        workers=1,
        page=True,
        report=lambda progress: progress.done == progress.total == 1,
    )
    assert done.counts == {"ok": 1}
    assert done.page is None
    assert not Path("out/report.html").exists()


def test_a_result_that_cannot_be_drawn_is_told_and_the_page_made(shape_folder):
    for name in ("a", "bb"):
        write_shape(shape_folder, name)
    given = {"options": OPTIONS, "workers": 1}
    batch(["models/*.off"], PLAIN, "out", **given)
    Path("out/a.json").write_text("{")
    told = []
    done = batch(
        *(["models/*.off"], PLAIN, "out"),
        **given,
        resume=True,
        page=True,
        report=lambda progress: told.extend(o for o in progress.news if not o.ok),
    )
    assert [outcome.shape for outcome in told] == ["models/a.off"]
    assert told[0].message.startswith("it has no picture on the page, but a result: ")
    assert done.counts == {"ok": 2}
    assert 'src="report/bb.png"' in done.page.read_text()
