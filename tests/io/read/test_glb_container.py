"""The container of a GLB file: header, chunks, JSON."""

from __future__ import annotations

import pytest

from moseg_core.io.read.glb_scene import read_glb
from tests.io.read.glb_files import one_node, pack


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", " is empty; export it again"),
        (b"PK\3\4", " is not a GLB file (no 'glTF' at the beginning)"),
        (b'{"asset": {}}', " has no faces"),
        (b'{"asset": {"version": "1.0"}}', " has glTF version 1.0; export it as version 2"),
        (b"{]", " has damaged JSON ("),
        (b"glTF\2\0\0\0", " ends within its header; it is cut off"),
        (b"glTF\1" + one_node()[5:], " has glTF version 1; export it as version 2"),
        (one_node()[:-1], " bytes, but there are "),
        (one_node()[:8] + b"\x0c\0\0\0" + one_node()[12:], " bytes, but there are "),
        (
            one_node()[:12] + b"\xff\xff\0\0" + one_node()[16:],
            " has a chunk that runs past its end",
        ),
        (one_node()[:16] + b"BIN\0" + one_node()[20:], " does not begin with a JSON chunk"),
        (pack(b"{,}", b""), " has damaged JSON ("),
        (pack(b"\xff\xfe{}", b""), " has damaged JSON ("),
        (pack(b"[" * 100_000, b""), " has damaged JSON ("),
        (pack([], b""), " has JSON that is no object"),
        (pack({}, b""), " has no faces"),
    ],
)
def test_containers_that_are_wrong_are_refused_with_the_reason(contents, message, refusal):
    assert message in refusal(read_glb, "bad.glb", contents)


def test_empty_chunks_behind_the_others_are_looked_at_once(as_file):
    # A million of them: no copy of the rest is made for each.
    whole = one_node() + 1_000_000 * (bytes(4) + b"WHAT")
    whole = whole[:8] + len(whole).to_bytes(4, "little") + whole[12:]
    assert read_glb(as_file("x.glb", whole)).n_elements > 0


def test_a_file_that_is_cut_off_is_never_read(accepted_cuts):
    contents = one_node()
    assert accepted_cuts(read_glb, "cut.glb", contents, range(0, len(contents), 2)) == {}


def test_bytes_behind_the_end_are_passed_over(as_file):
    plain = one_node()
    shape = read_glb(as_file("more.glb", plain + b"anything"))
    assert shape.n_elements == 4
    assert shape.notes[0] == "bytes behind the end of the file: 8; passed over"
    longer = plain[:8] + (len(plain) + 6).to_bytes(4, "little") + plain[12:] + bytes(6)
    shape = read_glb(as_file("more.glb", longer))
    assert shape.notes[0] == "bytes behind the last chunk: 6; passed over"
