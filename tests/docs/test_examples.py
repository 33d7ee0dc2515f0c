"""The examples run as they say, write what they say and only that, and find what they are about."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

EXAMPLES = Path(__file__).parents[2] / "examples"


def numbers(pattern: str, text: str) -> list[float]:
    """What the group of a pattern holds, each time that it is found."""
    return [float(number) for number in re.findall(pattern, text, re.MULTILINE)]


def finds_a_head_of_a_third(told: str) -> bool:
    return 0.25 < numbers(r"^head: (\d+)%", told)[0] / 100 < 0.4


def finds_upright_legs(told: str) -> bool:
    return max(numbers(r"^leg\d: upright (\S+),", told)) < 0.1


def cuts_the_head_in_two(told: str) -> bool:
    return min(numbers(r"^head/\w+: (\S+)%", told)) > 5


def finds_the_points_of_the_head(told: str) -> bool:
    handle, head = numbers(r": (\d+) points", told)
    return 0.2 < head / (handle + head) < 0.4


def finds_equal_wings(told: str) -> bool:
    one, other = numbers(r"^wing\d: (\S+)%", told)
    return one > 20 and abs(one - other) <= 0.2


def begins_with_its_own_seeder(told: str) -> bool:
    return "seeded by mine:strung" in told


#: For each example what its output has to show.
SHOWS = {
    "own_objective": finds_upright_legs,
    "own_seeder": begins_with_its_own_seeder,
    "parts_of_parts": cuts_the_head_in_two,
    "point_cloud": finds_the_points_of_the_head,
    "segment_hammer": finds_a_head_of_a_third,
    "symmetric_animal": finds_equal_wings,
}


def test_every_example_is_tested():
    assert sorted(SHOWS) == sorted(path.stem for path in EXAMPLES.glob("*.py"))


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWS)
def test_an_example_does_what_it_says(name, tmp_path):
    script = EXAMPLES / f"{name}.py"
    folder, elsewhere = tmp_path / "folder", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    done = subprocess.run(
        [sys.executable, "-W", "error", script, folder],
        cwd=elsewhere,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert SHOWS[name](done.stdout), done.stdout

    essay = script.read_text(encoding="utf-8").split('"""')[1]
    assert f"python examples/{name}.py FOLDER" in essay
    written = re.findall(r"``([\w.]+\.(?:png|svg|html|glb|ply|json))``", essay)
    assert sorted(written) == sorted(path.name for path in folder.iterdir())
    assert not list(elsewhere.iterdir())
    for path in folder.glob("*.png"):
        with Image.open(path) as picture:
            assert len(picture.convert("RGB").getcolors(1 << 24)) > 100  # something is to be seen
