"""The table of programs in docs/formats.md has a row for each format that was tried."""

from __future__ import annotations

import re

import moseg_core as moseg
from tools.make_format_docs import END, FORMATS, LOOK, PAGE, PROGRAMS, START, cell, quad_ball


def test_the_table_has_all_formats_and_programs():
    lines = PAGE.read_text().split(START)[1].split(END)[0].strip().splitlines()
    assert [re.match(r"\| `(.*?)`", line)[1] for line in lines[2:]] == list(FORMATS)
    programs = [re.sub(r" [\d.]+$", "", each.strip()) for each in lines[0].split("|")[2:-1]]
    assert programs == list(PROGRAMS) == list(LOOK)


def test_the_ball_is_closed_and_of_quads_with_a_texture(tmp_path):
    path = tmp_path / "ball.obj"
    path.write_text(quad_ball(3))
    shape = moseg.load(path)
    assert shape.geometry.offsets[-1] == 4 * shape.n_elements
    assert shape.geometry.appearance.texture is not None
    assert 3.0 < shape.volume < 4.2


def test_what_is_found_in_words():
    ball = {"parts": True, "quads": True, "UVs": True}
    assert cell(".obj", ball, {"parts": True}, "here") == "parts, quads, UVs"
    assert cell(".obj", {}, {}, "here") == "the surface alone"
    assert cell(".obj", None, None, "here") == "not read"
