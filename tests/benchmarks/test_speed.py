"""The benchmark of record runs, and writes what the page is made of."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from moseg_core.samples import sample_path
from moseg_core.shape.shape import Shape
from tests import shapes

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import speed
from speed_jobs import JOBS, processes
from speed_jobs.growth import RATIOS, STAGES
from speed_jobs.literal import squared_distance_to_ellipsoid
from speed_jobs.records import Record, Request, alternating
from speed_jobs.subdivision import cut_up, small_hammer, write_mesh


def test_all_jobs_are_listed_with_what_they_measure(capsys):
    speed.main(["--list"])
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(JOBS)
    assert all(len(line.split()) > 3 for line in lines)


def test_a_job_is_written_as_records(tmp_path, capsys):
    target = tmp_path / "found.json"
    mesh = str(sample_path("hammer"))
    speed.main([mesh, "--only", "flood", "--repeat", "1", "--json", str(target)])
    found = json.loads(target.read_text())
    assert found["mesh"] == {"name": "hammer", "elements": 8410}
    assert set(found["jobs"]) == {"flood"}
    assert {"processor", "cores", "memory", "python", "packages"} <= set(found["machine"])
    records, printed = found["records"], capsys.readouterr().out
    assert all(record["what"] in printed for record in records)
    assert len({record["what"] for record in records}) == len(records) == 12
    for record in records:
        assert list(record) == ["job", "what", "unit", "median", "least", "greatest", "runs"]
        assert len(record["runs"]) == 1
        assert record["median"] == record["least"] == record["greatest"] == record["runs"][0] > 0


def test_a_job_that_fails_does_not_end_the_others(tmp_path, monkeypatch, capsys):
    def breaks(request):
        """It is started, and breaks."""
        yield Record(job="breaks", what="started", unit="s", runs=(1.0,))
        raise RuntimeError("no more")

    def works(request):
        """It works, in an empty folder."""
        yield Record(
            job="works", what="files", unit="", runs=(len(list(request.folder.iterdir())),)
        )

    monkeypatch.setattr(speed, "JOBS", {"breaks": breaks, "works": works})
    target = tmp_path / "found.json"
    with pytest.raises(SystemExit, match="failed: breaks"):
        speed.main(["--json", str(target)])
    assert "failed: no more" in capsys.readouterr().out
    records = json.loads(target.read_text())["records"]
    assert [(each["job"], each["median"]) for each in records] == [("breaks", 1.0), ("works", 0)]


@pytest.mark.parametrize("wrong", [["--only", "fold"], ["--repeat", "0"]])
def test_what_there_is_not_is_refused(wrong, capsys):
    with pytest.raises(SystemExit):
        speed.main(wrong)
    assert "error" in capsys.readouterr().err


def test_a_record_says_how_much_its_runs_vary():
    document = Record(job="a", what="b", unit="s", runs=(3.0, 1.0, 2.0)).document()
    assert (document["median"], document["least"], document["greatest"]) == (2.0, 1.0, 3.0)


def test_calls_are_made_in_turn():
    made, ticks = [], iter(range(100))
    calls = [lambda: made.append("a"), lambda: made.append("b")]
    times = alternating(calls, 3, scale=10.0, clock=lambda: float(next(ticks)))
    assert made == ["a", "b"] * 3
    assert times == [(10.0,) * 3] * 2


def test_a_process_is_watched_with_its_children_and_without_this_one(tmp_path):
    request = Request(mesh=Path(), folder=tmp_path)
    child = "bytearray(200_000_000); import time; time.sleep(0.3)"
    parent = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {child!r}])"
    few = processes.run([sys.executable, "-c", "pass"], request)
    many = processes.run([sys.executable, "-c", parent], request)
    # Less than this process, which has numpy, has itself.
    assert few.memory < 0.05 < 0.2 < many.memory < 0.3
    assert many.wall > 0.3
    failing = "import sys; print('no such thing', file=sys.stderr); sys.exit(3)"
    with pytest.raises(RuntimeError, match=r"ended with 3: no such thing"):
        processes.run([sys.executable, "-c", failing], request)


def test_each_stage_of_a_run_is_a_search_or_around_it(tmp_path):
    request, mesh = Request(mesh=Path(), folder=tmp_path), tmp_path / "small.ply"
    write_mesh(small_hammer(np.random.default_rng(0)), mesh)
    short = ("--restarts", "1", "--seeder", "kmeans")
    _, stages = processes.run_by_stage(
        [processes.segmenting(mesh, "hammer", request, *short)], request
    )
    around = {stage for name in ("read", "write", "start and rest") for stage in STAGES[name]}
    assert {"fields", "seeds and labels", "search", "read", "write", "rest"} <= set(stages)
    assert set(stages) <= {*processes.SEARCH, *around}
    assert processes.final_cost(request) > 0


def test_a_mesh_is_cut_up_without_a_change_of_the_surface():
    box = Shape.from_mesh(*shapes.box(3, 2, 1))
    fine = cut_up(box, 3)
    assert fine.n_elements == 9 * len(box.geometry.triangles)
    assert fine.areas.sum() == pytest.approx(22)
    assert fine.volume == pytest.approx(6)


def test_small_hammers_are_closed_and_differ():
    rng = np.random.default_rng(0)
    volumes = [small_hammer(rng).volume for _ in range(3)]
    assert min(volumes) > 0
    assert len(set(volumes)) == 3


def test_the_stages_that_are_compared_are_measured():
    assert {name for names in RATIOS.values() for name in names} <= set(STAGES)
    summed = {stage for names in RATIOS.values() for name in names for stage in STAGES[name]}
    assert summed <= {*processes.SEARCH}


def test_the_literal_distance_to_an_ellipsoid_is_that_to_its_nearest_point():
    radii = [3.0, 2.0, 1.0]
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 1000), np.linspace(-np.pi / 2, np.pi / 2, 500))
    surface = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1) * radii
    for point in ([4.0, 1.0, 0.5], [0.3, 0.2, 0.1], [-1.0, 2.5, -2.0]):
        least = ((surface - point) ** 2).sum(axis=-1).min()
        assert squared_distance_to_ellipsoid(point, radii) == pytest.approx(least, abs=1e-4)
