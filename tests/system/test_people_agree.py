"""How much people agree with each other, over the models of the Princeton Segmentation Benchmark.

Each model was cut by about a dozen people. The mean 1 - Rand Index over all pairs of them is what
an algorithm can hope for at best, and a check on the measure itself: over all 380 models it is
the .103 that Chen, Golovinskiy and Funkhouser 2009 (doi:10.1145/1531326.1531379) print. Here are
the 95 models with ids 1, 5, 9, 13 and 17 of each block of twenty. The mean is taken over the pairs
of a model, then over the models of a category, then over the categories.

Looks for the models in the folder that ``MOSEG_PSB`` names, and is skipped without it.
"""

from __future__ import annotations

import itertools
import os
from pathlib import Path

import numpy as np
import pytest

from moseg_core.agreement import rand_index_error

MODELS = os.environ.get("MOSEG_PSB")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(MODELS is None, reason="MOSEG_PSB does not name the benchmark's folder"),
]

# Of each category the first id and the mean; 261 to 280 are left out by the benchmark.
PEOPLE = {
    "Human": (1, 0.139),
    "Cup": (21, 0.194),
    "Glasses": (41, 0.102),
    "Airplane": (61, 0.110),
    "Ant": (81, 0.016),
    "Chair": (101, 0.078),
    "Octopus": (121, 0.033),
    "Table": (141, 0.074),
    "Teddy": (161, 0.043),
    "Hand": (181, 0.090),
    "Plier": (201, 0.054),
    "Fish": (221, 0.147),
    "Bird": (241, 0.050),
    "Armadillo": (281, 0.078),
    "Bust": (301, 0.248),
    "Mech": (321, 0.104),
    "Bearing": (341, 0.121),
    "Vase": (361, 0.129),
    "Fourleg": (381, 0.159),
}


def among_themselves(model: int) -> float:
    """Mean 1 - Rand Index over all pairs of people who cut one model."""
    files = sorted((Path(MODELS or "") / "seg" / str(model)).glob("*.seg"))
    assert len(files) > 1
    # One integer a line; moseg's own reader looks at every line, which takes 20 s for all.
    people = [np.fromstring(file.read_text(), dtype=np.int64, sep="\n") for file in files]
    return float(np.mean([rand_index_error(*two) for two in itertools.combinations(people, 2)]))


def test_people_agree_as_much_as_they_are_known_to():
    found = {
        category: float(np.mean([among_themselves(first + k) for k in (0, 4, 8, 12, 16)]))
        for category, (first, _) in PEOPLE.items()
    }
    expected = {category: mean for category, (_, mean) in PEOPLE.items()}
    assert found == pytest.approx(expected, abs=0.001)
    assert np.mean(list(found.values())) == pytest.approx(0.104, abs=0.001)
