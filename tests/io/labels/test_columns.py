"""Columns of text: headers, delimiters, which column, and what is no label."""

from __future__ import annotations

from pathlib import Path

import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.labels.columns import read_columns
from moseg_core.io.labels.listing import Wanted

PATH = Path("x.csv")
THREE = Wanted(n_elements=3, n_vertices=5, noun="face")


def read(text, wanted=THREE):
    return read_columns(PATH, text, wanted)


@pytest.mark.parametrize(
    "text",
    [
        "1\n0\n2\n",
        "1\n0\n2",
        "1 0 2\n",
        "1,0,2\n",
        "1;\n0;\n2;\n",
        "label\n1\n0\n2\n",
        '"label"\n"1"\n"0"\n"2"\n',
        "# label\n1\n0\n2\n",
        "# one\n# two\n1\n# three\n0\n2\n",
        "% MATLAB\n1.0\n0.0\n2.0\n",
        "1e0\n0e0\n2E0\n",
        "face label\n0 1\n1 0\n2 2\n",
        "face\tlabel\n2\t2\n0\t1\n1\t0\n",
        "0 1\n1 0\n2 2\n",
        "1 1\n2 0\n3 2\n",
        "x,y,z,label\n0,0,0,1\n0,0,1,0\n0,1,0,2\n",
        "0 0 0.5 1\n0 0 1.5 0\n0 1 0.5 2\n",
        "q,part\n0.5,1\n0.5,0\n0.7,2\n",
        "face,q,label\n0,9,1\n1,9,0\n2,9,2\n",
        ",0\n0,1\n1,0\n2,2\n",
        ",label\n2,2\n1,0\n0,1\n",
    ],
)
def test_numbers(text):
    assert read(text).labels.tolist() == [1, 0, 2]


@pytest.mark.parametrize(
    "text",
    [
        "upper arm\nleg\nupper arm\n",
        "label\nupper arm\nleg\nupper arm\n",
        "face,label\n0,upper arm\n1,leg\n2,upper arm\n",
        "q,label\n7,upper arm\n7,leg\n8,upper arm\n",
        ",part\n0,upper arm\n1,leg\n2,upper arm\n",
        '"face","label"\n0,"upper arm"\n1,"leg"\n2,"upper arm"\n',
    ],
)
def test_names(text):
    found = read(text)
    assert (found.labels.tolist(), found.names) == ([0, 1, 0], ("upper arm", "leg"))


def test_a_quoted_name_may_hold_the_delimiter():
    assert read('face,label\n0,"arm, upper"\n1,leg\n2,leg\n').names == ("arm, upper", "leg")


def test_a_name_that_is_usual_for_labels_is_no_header_where_all_lines_are_labels():
    assert read("part\nleg\npart\n").names == ("part", "leg")


FOUR = Wanted(n_elements=4, n_vertices=4, noun="face")


@pytest.mark.parametrize(
    ("header", "of"),
    [
        ("vertex,label", "vertices"),
        ("Vertex_ID,label", "vertices"),
        ("points,label", "vertices"),
        ("id,vertex_label", "vertices"),
        ("face,label", "elements"),
        ("polygon,label", "elements"),
        ("vertex,face_label", "vertices"),
        ("id,label", "unsaid"),
    ],
)
def test_what_a_header_says_that_it_labels(header, of):
    found = read(f"{header}\n0,7\n3,5\n1,7\n2,7\n", FOUR)
    assert (found.labels.tolist(), found.of) == ([7, 7, 7, 5], of)


def test_some_vertices_are_counted_as_such():
    found = read("vertex,label\n0,7\n4,5\n")
    assert (found.labels.tolist(), found.of) == ([7, -1, -1, -1, 5], "vertices")
    assert read("vertex,label\n1,7\n5,5\n").notes == ("x.csv counts vertices from 1",)


def test_a_header_without_ids_says_it_too():
    assert read("vertex_label\n7\n7\n5\n5\n", FOUR).of == "vertices"
    assert read("face_label\n7\n7\n5\n5\n", FOUR).of == "elements"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("face,label\n" + "".join(f"{k},0\n" for k in range(5)), "there are 3, counted from 0"),
        ("vertex,label\n0,7\n6,5\n", "to vertex 6, but there are 5"),
    ],
)
def test_ids_of_what_is_not_there_are_refused(text, message):
    with pytest.raises(ShapeError, match=message):
        read(text)


def test_points_are_the_elements_of_a_cloud_and_of_what_is_only_a_number():
    text = "point,label\n0,7\n1,5\n2,7\n"
    assert read(text, Wanted(n_elements=3, n_vertices=3, noun="point")).of == "elements"
    assert read(text, Wanted(n_elements=3)).of == "unsaid"
    with pytest.raises(ShapeError, match="not known how many"):
        read(text.replace("point", "vertex"), Wanted(n_elements=3))


def test_rows_that_count_vertices():
    found = read("vertex,label\n" + "".join(f"{k},{k % 2}\n" for k in range(5)))
    assert found.labels.tolist() == [0, 1, 0, 1, 0]


def test_what_is_left_out_has_no_label():
    assert read("face,label\n2,7\n").labels.tolist() == [-1, -1, 7]
    assert read("face,label\n0,\n1,3\n2,nan\n").labels.tolist() == [-1, 3, -1]


@pytest.mark.parametrize(
    ("asked", "labels"),
    [("q", [4, 5, 6]), ("2", [4, 5, 6]), ("1", [1, 0, 2]), ("Q", [4, 5, 6])],
)
def test_a_column_may_be_asked_for(asked, labels):
    wanted = Wanted(n_elements=3, properties=(asked,))
    assert read("label,q\n1,4\n0,5\n2,6\n", wanted).labels.tolist() == labels


def test_the_choice_of_a_column_is_said():
    assert read("0 0 0.5 1\n0 0 1.5 0\n0 1 0.5 2\n").notes == (
        "x.csv: labels are the last of 4 columns",
    )
    assert "not 'object'" in read("label,object\n1,4\n0,5\n2,6\n").notes[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0\n1 2\n2\n", "x.csv, line 2: expected one label, found 2 words"),
        ("\n0 1\n1\n", "x.csv, line 3: expected 2 columns as in the lines before, found 1 words"),
        ("0 5\n9 5\n", "x.csv, line 1: expected one label, found 2 words"),
        ("0\n1\n\nleg\n", "x.csv, line 4: 'leg' is not an integer, which the labels before or"),
        ("0\n0.5\n1\n", "x.csv, line 2: the label 0.5 is not a whole number"),
        ("0\n1_0\n1\n", "x.csv, line 2: '1_0' is not an integer"),
        ("q,r,s\n1,2,3\n1,2,3\n1,2,3\n", "x.csv has 3 columns: q, r, s; say which holds the lab"),
        ("1 2 3 4 5\n" * 3, "x.csv has 5 columns; say which holds the labels, by its name or its"),
        ("face,label\n0,1\n0,2\n", "x.csv gives face 0 the label '0' and the label '0'; a face"),
        ("face,label\n9,1\n", "x.csv gives the label '9' to face 9, but there are 3, counted fr"),
    ],
)
def test_what_is_refused(text, message):
    with pytest.raises(ShapeError) as caught:
        read(text)
    assert str(caught.value).startswith(message)


def test_nothing_is_no_labels():
    assert read("# nothing\n").labels.tolist() == []
