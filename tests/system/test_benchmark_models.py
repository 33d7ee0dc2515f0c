"""Real models: a cow of the Princeton Segmentation Benchmark under the recipe paper_horse.

Looks for the models in the folder that ``MOSEG_PSB`` names, and is skipped without it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import moseg_core as moseg

MODELS = os.environ.get("MOSEG_PSB")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(MODELS is None, reason="MOSEG_PSB does not name the benchmark's folder"),
]


def test_a_cow_is_cut_into_connected_parts_with_equal_bytes(tmp_path):
    model = Path(MODELS or "") / "off" / "381.off"
    for run in ("1", "2"):
        subprocess.run(
            [
                *(sys.executable, "-m", "moseg_core", "segment", str(model)),
                *("--recipe", "paper_horse", "-o", str(tmp_path / f"{run}.json"), "--quiet"),
            ],
            env={**os.environ, "PYTHONHASHSEED": run},
            check=True,
        )
    first, second = ((tmp_path / f"{run}.json").read_bytes() for run in ("1", "2"))
    assert first == second
    document = json.loads(first)
    assert document["cost"]["empty"] == []
    assert document["reason"] == "converged"
    shape = moseg.load(model)
    segmentation = moseg.Segmentation.from_labels(shape, np.array(document["labels"]), 6)
    assert [part.n_components for part in segmentation.parts] == [1] * 6
    problem = moseg.Problem(document["problem"]["labels"], document["problem"]["minimize"])
    again = problem.evaluate(shape, document["labels"])
    assert again.cost.value == pytest.approx(document["cost"]["value"], rel=1e-12)


@pytest.mark.parametrize("path", sorted((Path(MODELS or "") / "off").glob("*.off")), ids=str)
def test_every_model_is_read_whole(path):
    shape = moseg.load(path)
    assert shape.volume is not None
    assert shape.n_elements == int(path.read_text().split()[2])
    assert shape.adjacency.components()[0] == 1
