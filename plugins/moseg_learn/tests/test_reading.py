from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_learn.reading import read_example, split_word

from moseg_core import ShapeError, UsageError, save_labels


@pytest.fixture
def folder(tmp_path):
    """A box as .off, with labels of several formats; the same as .glb of two named nodes."""
    box = trimesh.creation.box()
    box.export(tmp_path / "box.off")
    labels = (box.triangles_center[:, 2] > 0.4).astype(np.int64)
    save_labels(labels, tmp_path / "box_labels.txt", names=["crate", "lid"])
    save_labels(labels, tmp_path / "box.seg")
    scene = trimesh.Scene()
    for k, name in enumerate(("crate", "lid")):
        piece = box.submesh([np.flatnonzero(labels == k)], append=True)
        scene.add_geometry(piece, node_name=name, geom_name=name)
    scene.export(tmp_path / "box.glb")
    return tmp_path


def test_shape_and_labels_are_read(folder):
    example = read_example(f"{folder}/box.off={folder}/box_labels.txt")
    assert (example.shape.name, example.names) == ("box", ("crate", "lid"))
    assert np.bincount(example.labels).tolist() == [10, 2]


def test_a_scene_bears_its_labels_itself(folder):
    example = read_example(str(folder / "box.glb"))
    assert dict(zip(example.names, np.bincount(example.labels).tolist(), strict=True)) == {
        "crate": 10,
        "lid": 2,
    }


def test_numbers_get_the_names_that_are_said(folder):
    word = f"{folder}/box.off={folder}/box.seg"
    with pytest.raises(UsageError, match="--names body,leg"):
        read_example(word)
    assert read_example(word, names=["crate", "lid"]).borne == ("crate", "lid")
    with pytest.raises(UsageError, match="has the label 1, but there are 1 names: crate"):
        read_example(word, names=["crate"])


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("box.off", "has no labels; write box.off=LABELS"),
        ("box.off=", "write SHAPE=LABELS"),
        ("=box.seg", "write SHAPE=LABELS"),
    ],
)
def test_words_of_another_form_are_refused(word, message):
    with pytest.raises(UsageError, match=message):
        split_word(word)


def test_what_is_wrong_with_the_files_is_said(folder):
    with pytest.raises(UsageError, match=r"there is no file '.*bix\.off'"):
        read_example(f"{folder}/bix.off={folder}/box.seg")
    trimesh.creation.icosphere(subdivisions=1).export(folder / "ball.off")
    with pytest.raises(ShapeError, match=r"example '.*ball\.off=.*of this very shape"):
        read_example(f"{folder}/ball.off={folder}/box.seg", names=["a", "b"])
    trimesh.creation.box().export(folder / "plain.ply")
    with pytest.raises(ShapeError, match="has no property 'label'"):
        read_example(str(folder / "plain.ply"))


def test_what_is_said_of_the_labels_is_told_and_some_may_be_missing(folder):
    labels = folder / "some.csv"
    labels.write_text("face,label,mine\n" + "".join(f"{k},{k % 2},{k % 3}\n" for k in range(10)))
    said = []
    example = read_example(f"{folder}/box.off={labels}", names=["a", "b"], tell=said.append)
    assert example.labels.tolist() == [0, 1] * 5 + [-1, -1]
    assert said == ["some.csv: 2 of 12 faces are unlabelled and left out"]
    word = f"{folder}/box.off={labels}"
    example = read_example(word, names=["a", "b", "c"], label_property=["mine"])
    assert example.borne == ("a", "b", "c")


def test_groups_of_a_shape_are_its_labels(folder):
    path = folder / "tile.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ng left\nf 1 2 3\ng right\nf 2 4 3\n")
    example = read_example(str(path))
    assert (example.labels.tolist(), example.names) == ([0, 1], ("left", "right"))
