"""``moseg benchmark psb`` on real models: cups without a recipe, with the known numbers.

Looks for the models in the folder that ``MOSEG_PSB`` names, and is skipped without it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

MODELS = os.environ.get("MOSEG_PSB")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(MODELS is None, reason="MOSEG_PSB does not name the benchmark's folder"),
]


def test_cups(tmp_path):
    report = tmp_path / "report"
    done = subprocess.run(
        [
            *(sys.executable, "-m", "moseg_core", "benchmark", "psb", "--data", str(MODELS)),
            *("--category", "Cup", "--recipe-for", "none", "--quiet", "-o", str(report)),
        ],
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stderr == ""
    line = next(line for line in done.stdout.splitlines() if line.startswith("Cup"))
    assert line.split()[:3] == ["Cup", "5", "0.194"]
    rows = json.loads((report / "report.json").read_text())["rows"]
    assert [(row["model"], row["method"]) for row in rows] == [
        (model, method) for model in (21, 25, 29, 33, 37) for method in ("people", "k-means")
    ]
    # A handle is small and a body is round: clusters of equal size do badly, people well.
    clusters = [row["rand_index_error"] for row in rows if row["method"] == "k-means"]
    assert min(clusters) > 0.4
