"""Names and colours of labels, in forms that other programs can read whatever a label is called."""

from __future__ import annotations

import shlex

import numpy as np
from moseg_medical.label_names import label_descriptions, plain_name, segment_keys

from moseg_core import part_colors

HOSTILE = ['a"b', "two\nlines", "", "x" * 10_000, "Segment1_Name:=no", "\u202egel", "<script>"]


def test_every_description_is_one_line_with_eight_words():
    lines = [line for line in label_descriptions(HOSTILE).splitlines() if not line.startswith("#")]
    assert len(lines) == len(HOSTILE) + 1
    for k, line in enumerate(lines):
        number, *rest, name = shlex.split(line.replace("'", "_"))
        assert int(number) == k
        assert len(rest) == 6
        assert all(0 <= int(word) <= 255 for word in rest)
        assert 0 < len(name) <= 200


def test_keys_are_on_one_line_each():
    keys = segment_keys(HOSTILE, (4, 5, 6))
    assert {key for key in keys if key.endswith("_Name")} == {
        f"Segment{k}_Name" for k in range(len(HOSTILE))
    }
    assert not [value for value in keys.values() if "\n" in value]
    assert keys["Segment2_LabelValue"] == "3"
    assert keys["Segment2_Extent"] == "0 3 0 4 0 5"
    assert len({keys[f"Segment{k}_Color"] for k in range(len(HOSTILE))}) == len(HOSTILE)


def test_parts_have_the_colours_of_pictures():
    names = [str(k) for k in range(20)]
    rows = [line.split()[:4] for line in label_descriptions(names).splitlines()[6:]]
    keys = segment_keys(names, (4, 5, 6))
    for k, color in enumerate(part_colors(20).tolist()):
        assert list(map(int, rows[k])) == [k + 1, *color]
        segment = np.array(keys[f"Segment{k}_Color"].split(), float)
        assert np.rint(255 * segment).tolist() == color


def test_what_is_plain_stays():
    assert plain_name("Femur, rechts (ö)") == "Femur, rechts (ö)"
