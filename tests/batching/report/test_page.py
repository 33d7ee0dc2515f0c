"""The page of a batch: outliers first, failures above, and no text in it is markup."""

from __future__ import annotations

import re
from pathlib import Path

from moseg_core.batching.outcome import BatchResult, Outcome
from moseg_core.batching.report.describing import Description
from moseg_core.batching.report.page import batch_page

HOSTILE = "<script>alert(1)</script>\"'&\ud800"


def result(*outcomes, total=None):
    named = {outcome.shape: outcome for outcome in outcomes}
    return BatchResult(folder=Path("ants"), outcomes=named, total=total or len(named))


def ok(shape, cost=1.0, **more):
    return Outcome(shape=shape, key=shape, kind="ok", cost=cost, files=(f"{shape}.json",), **more)


def described(length):
    rows = {"part": "leg", "elements": 9, "length": length, "shape_diagonal": 1.0}
    return Description(digest="", rows=(rows,))


def shown(page):
    return re.findall(r"<h3>(.*?)</h3>", page)


def test_what_is_unlike_the_others_comes_first_with_what_is_unusual():
    shapes = [f"s{k}.off" for k in range(6)]
    lengths = [0.30, 0.31, 0.29, 0.90, 0.30, 0.32]
    page = batch_page(
        result(*map(ok, shapes)),
        {shape: described(length) for shape, length in zip(shapes, lengths, strict=True)},
        {shape: f"report/{shape}.png" for shape in shapes},
    ).decode()
    assert shown(page)[0] == "s3.off"
    assert "leg</bdi>: length 90 % of the diagonal, usually 30.5 %" in page
    assert 'src="report/s3.off.png"' in page
    assert page.count("unlike the others:") == 6
    assert page.count("<li><i ") == 1  # a legend, since all have the same parts


def test_few_shapes_come_by_cost_and_failures_are_told():
    failed = Outcome(shape="c.off", key="c", kind="timeout", message="took longer than 5 s")
    page = batch_page(result(ok("a", 1.0), ok("b", 2.0), failed, total=9), {}, {}).decode()
    assert shown(page) == ["b", "a"]
    assert "9 shapes: 2 ok, 1 timeout, 6 left" in page
    assert "took longer than 5 s" in page
    assert "unlike the others:" not in page
    assert "<img" not in page


def test_text_of_files_is_no_markup():
    outcome = Outcome(
        shape=HOSTILE, key="k", kind="ok", parts=(HOSTILE,), warnings=(HOSTILE,), files=(HOSTILE,)
    )
    failed = Outcome(shape=HOSTILE + "2", key="k2", kind="crashed", message=HOSTILE * 100)
    rows = ({"part": HOSTILE, "length": 1.0, "shape_diagonal": 1.0},)
    page = batch_page(
        result(outcome, failed),
        {HOSTILE: Description(digest="", rows=rows)},
        {HOSTILE: "report/<x>.png"},
    ).decode()
    assert "<script" not in page
    assert 'src="report/%3Cx%3E.png"' in page
    assert len(page) < 20_000
    assert "default-src 'none'" in page
