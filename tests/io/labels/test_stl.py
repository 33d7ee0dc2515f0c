"""Solids and attributes of STL files."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.labels.listing import Wanted
from moseg_core.io.labels.stl import read_stl_labels

WANTED = Wanted(n_elements=3)
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


def text(*solids: tuple[str, int]) -> str:
    """Solids with so many facets each, every facet one higher."""
    made, height = "", 0.0
    for name, count in solids:
        made += f"solid {name}\n"
        for _ in range(count):
            corners = [f"vertex {x} {y} {height}\n" for x, y, _ in CORNERS]
            made += f"  facet normal 0 0 1\nouter loop\n{''.join(corners)}endloop\nendfacet\n"
            height += 1.0
        made += f"endsolid {name}\n"
    return made


def binary(attributes) -> bytes:
    kind = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    rows = np.zeros(len(attributes), kind)
    rows["corners"], rows["attribute"] = CORNERS, attributes
    return bytes(80) + np.uint32(len(rows)).tobytes() + rows.tobytes()


def test_solids_are_named_labels(as_file):
    found = read_stl_labels(as_file("x.stl", text(("leg", 2), ("upper arm", 1))), WANTED)
    assert (found.labels.tolist(), found.names) == ([0, 0, 1], ("leg", "upper arm"))
    np.testing.assert_allclose(found.places[:, 2], [0, 1, 2])
    assert found.notes == ()


@pytest.mark.parametrize("over", [b"\0", b"\0" * 512, b"\x1a"])
def test_bytes_behind_a_text_leave_it_text(over, as_file):
    contents = text(("leg", 2), ("arm", 1)).encode() + over
    found = read_stl_labels(as_file("x.stl", contents), WANTED)
    assert (found.labels.tolist(), found.names) == ([0, 0, 1], ("leg", "arm"))


def test_bytes_behind_the_triangles_leave_their_attributes(as_file):
    found = read_stl_labels(as_file("x.stl", binary([4, 2, 4]) + b"\r\n"), WANTED)
    assert found.labels.tolist() == [4, 2, 4]


def test_solids_of_one_name_among_others_are_one(as_file):
    solids = text(("leg", 1), ("arm", 1), ("leg", 1))
    assert read_stl_labels(as_file("x.stl", solids), WANTED).labels.tolist() == [0, 1, 0]


@pytest.mark.parametrize("names", [("ascii", "ascii"), ("", ""), ("leg", "")])
def test_solids_without_names_of_their_own_are_numbered(names, as_file):
    solids = text((names[0], 1), ("empty", 0), (names[1], 2))
    found = read_stl_labels(as_file("x.stl", solids), WANTED)
    assert (found.labels.tolist(), found.names) == ([0, 1, 1], None)
    assert found.notes == ("x.stl: its solids have no names of their own, and are numbered",)


def test_attributes_of_a_binary_file(as_file):
    found = read_stl_labels(as_file("x.stl", binary([7, 31744, 7])), WANTED)
    assert (found.labels.tolist(), found.names) == ([7, 31744, 7], None)
    assert found.notes == ("x.stl: labels are the attributes of its triangles",)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (text(("whole", 3)), " has one solid, which tells no faces apart"),
        (binary([0, 0, 0]), " is binary, and so names no solids, and the attributes of its tri"),
        (text(("a", 1), ("b", 1))[:-20], " ends within a triangle; it is cut off"),
        (b"", " is empty"),
    ],
)
def test_what_tells_nothing_apart_is_refused(contents, message, refusal):
    assert message in refusal(lambda path: read_stl_labels(path, WANTED), "x.stl", contents)
