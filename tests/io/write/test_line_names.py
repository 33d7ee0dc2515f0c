"""Names on one line: good ones stay, bad ones become good and stay apart."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.write.line_names import line_names


def test_good_names_stay_and_others_make_room_for_them():
    names = ["head", "left arm", "body/leg", "größe", "con", "../../x", "<b>&\"'", "x" * 10_000]
    assert line_names(names) == names
    assert line_names(["a\nb", "a\rb", "a_b"]) == ["a_b_2", "a_b_3", "a_b"]
    assert line_names(["", " ", "part"]) == ["part_2", "part_3", "part"]
    assert line_names(["a#b", "a b"], also="#") == ["a_b", "a b"]
    assert line_names(["\ud800", "\x00", "a\u2028b"]) == ["_", "__2", "a_b"]


@given(names=st.lists(st.text(st.characters()), unique=True, max_size=6))
def test_any_names_become_different_lines_of_text(names):
    found = line_names(names, also="#")
    assert len(set(found)) == len(names)
    for name in found:
        assert name
        assert name.encode().decode().splitlines() == [name]
        assert "#" not in name
