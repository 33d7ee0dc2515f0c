"""The page on speed is made of what was measured."""

from __future__ import annotations

import copy

import pytest

from tools.growth_plot import growth_plot, meshes
from tools.make_speed_page import page


def record(job, what, unit, *runs):
    middle = sorted(runs)[len(runs) // 2]
    numbers = {"median": middle, "least": min(runs), "greatest": max(runs)}
    return {"job": job, "what": what, "unit": unit, **numbers, "runs": list(runs)}


def growing(faces, seconds):
    stages = [f", one process: {stage}" for stage in ("read", "fields", "search", "polish")]
    ends = (": seconds", *stages)
    times = [record("growth", f"{faces}{end}", "s", seconds) for end in ends]
    memory = record("growth", f"{faces}: memory", "GB", seconds / 10)
    return [record("growth", f"{faces}: faces", "faces", faces), *times, memory]


@pytest.fixture
def run():
    jobs = ("record", "growth", "objectives")
    return {
        "machine": {
            **{"processor": "Fast 3", "cores": 2, "memory": 7.9, "system": "Linux"},
            **{"python": "3.12.1", "packages": {"numpy": "2.0"}, "day": "2026-01-02"},
            "commit": "abc",
        },
        "mesh": {"name": "horse", "elements": 9670},
        "repeat": 3,
        "jobs": {job: f"What {job} is." for job in jobs},
        "records": [
            record("record", "paper_horse: seconds", "s", 1.5, 1.25, 2.0),
            record("record", "paper_horse: final cost", "cost", 7.179542),
            *growing(9000, 2.0),
            *growing(90000, 4.0),
            record("growth", "search, 100000 : 10000 faces", ": 1", 2.0),
            record("objectives", "basic:is", "us", 12345.6),
            record("objectives", "basic:is, all parts at once", "us", 0.01234),
        ],
    }


def test_figures_come_with_their_range_and_unit(run):
    text = page([run], "Of a busy day.")
    assert "Of a busy day." in " ".join(text.split())
    assert "Fast 3, 2 cores, 8 GB of memory" in text
    assert "| paper_horse: seconds | 1.50 s (1.25 to 2.00) |" in text
    assert "| its final cost, seeds 0 and on | 7.17954 |" in text
    assert "| basic:is | 12,346 µs | 0.0123 µs |" in text


def test_two_runs_stand_side_by_side(run):
    second = copy.deepcopy(run)
    second["records"][0] = record("record", "paper_horse: seconds", "s", 99.96)
    text = page([run, second])
    assert "| paper_horse: seconds | 1.50 s (1.25 to 2.00) | 100 s |" in text
    assert "| seconds | 2.00 s / 2.00 s | 4.00 s / 4.00 s |" in text


def test_meshes_have_a_column_each(run):
    text = page([run])
    assert "|  | 9,000 faces | 90,000 faces |" in text
    assert "| one process: search | 2.00 s | 4.00 s |" in text
    assert "| search, 100000 : 10000 faces | 2.00 : 1 |" in text
    assert "| hammer of 90000 faces, read to written | 4.00 s |" in text


def test_the_plot_has_a_point_for_each_mesh_and_curve(run):
    assert meshes(run) == [9000, 90000]
    drawn = growth_plot(run).decode()
    # In the legend one more.
    assert drawn.count("<circle") == 6 * (len(meshes(run)) + 1)
    assert "<title>search</title>" in drawn
