"""``moseg render``: pictures of labels from anywhere."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import moseg_core
from moseg_core.cli.render import read_size
from moseg_core.errors import UsageError


@pytest.fixture
def labels(tmp_path):
    """Labels of the open box, by name; one face has none, and one name would not fit a picture."""
    path = tmp_path / "labels.txt"
    names = ["head", "x" * 10_000, "../../<b>\u202eright"]
    lines = [names[k % 3] for k in range(160)]
    path.write_text("\n".join(["unlabelled", *lines[1:]]), encoding="utf-8")
    return path


def test_a_picture_of_labels_says_which_way_is_up(moseg, open_box, labels, tmp_path):
    drawn = []
    for k, words in enumerate(([], ["--up", "-z"], ["--up", "z"])):
        out = tmp_path / f"{k}.png"
        run = moseg("render", open_box, labels, "-o", out, "--size", "600x300", *words)
        assert (run.code, run.out) == (0, ""), run.err
        assert ("guessed; --up says otherwise" in run.err) is (not words)
        with Image.open(out) as image:
            assert (image.size, image.mode) == ((600, 300), "RGB")
            drawn.append(np.asarray(image))
    assert (drawn[1] != drawn[2]).any()  # upside down


def test_the_background_may_be_left_out(moseg, open_box, labels, tmp_path):
    out = tmp_path / "clear.png"
    words = ("--views", "1", "--transparent", "--no-legend", "--size", "300x300")
    assert moseg("render", open_box, labels, "-o", out, *words).code == 0
    with Image.open(out) as image:
        alpha = np.asarray(image.getchannel("A"))
    assert set(alpha[:5].ravel().tolist()) == {0}
    assert alpha[150, 150] == 255
    assert ((alpha > 0) & (alpha < 255)).any()  # smooth along the outline


def test_a_result_is_a_labelling_and_no_shape(moseg, mallet, segmented, tmp_path):
    out = tmp_path / "m.png"
    assert moseg("render", mallet, segmented, "-o", out, "--size", "400x200").code == 0
    assert out.exists()
    run = moseg("render", segmented, mallet, "-o", out)
    assert run.code == 2
    assert (
        f"has labels but no shape; give the shape first: moseg render SHAPE {segmented}" in run.err
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "x.svg"], "a picture is written as .png, not '.svg'"),
        (["-o", "no/x.png"], "there is no folder 'no'"),
        (["-o", "x.png", "--views", "frnt"], "unknown view 'frnt'; did you mean 'front'?"),
        (["-o", "x.png", "--size", "3"], "--size '3' is not understood; write --size 900x400"),
        (["-o", "x.png", "--size", "3x3"], "allowed are 240 x 160 to 4000 x 2000"),
        (["-o", "x.png", "--up", "up"], '"-z"'),
    ],
)
def test_what_is_wrong_is_said_first(moseg, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    run = moseg("render", "none.off", "none.seg", *words)
    assert (run.code, run.out) == (2, "")
    assert message in run.err


def test_sizes_are_read():
    assert read_size(" 900 x 400 ") == (900, 400)
    with pytest.raises(UsageError):
        read_size("-9x40")


def test_numbers_that_are_left_out_are_no_parts(moseg, mallet, tmp_path, monkeypatch):
    drawn = {}

    def draw(geometry, labels, names, **options):
        drawn.update(labels=labels, names=names)
        return b"picture"

    monkeypatch.setattr("moseg_core.cli.render.draw_parts", draw)
    count = moseg_core.load(mallet).n_elements
    labels = tmp_path / "labels.txt"
    labels.write_text("".join(f"{3 if k % 2 else 7}\n" for k in range(count)))
    run = moseg("render", mallet, labels, "-o", tmp_path / "x.png")
    assert run.code == 0, run.err
    assert drawn["names"] == ("3", "7")
    assert drawn["labels"].tolist() == [1 - k % 2 for k in range(count)]
