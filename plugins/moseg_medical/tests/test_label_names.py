"""Names and colours of labels, in forms that other programs can read whatever a label is called."""

from __future__ import annotations

import itertools
import shlex

from moseg_medical.label_names import colors, label_descriptions, plain_name, segment_keys

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


def test_neighbours_have_other_colours_and_all_are_colours():
    found = colors(40)
    assert len(set(found)) == 40
    assert all(0 <= channel <= 1 for color in found for channel in color)
    apart = [
        sum(abs(a - b) for a, b in zip(p, q, strict=True)) for p, q in itertools.pairwise(found)
    ]
    assert min(apart) > 0.2


def test_what_is_plain_stays():
    assert plain_name("Femur, rechts (ö)") == "Femur, rechts (ö)"
