"""Labels in numpy's files."""

from __future__ import annotations

import io
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest

from moseg_core.io.labels.arrays import read_npy, read_npz
from moseg_core.io.labels.listing import Wanted
from moseg_core.shape.shape import Shape

WANTED = Wanted(n_elements=3, n_vertices=5, noun="face")
MINE = Wanted(n_elements=3, properties=("mine",))


def npy(array) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def npz(**arrays) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **{name: np.array(array) for name, array in arrays.items()})
    return stream.getvalue()


@pytest.mark.parametrize(
    "array",
    [
        np.array([1, 0, 1], np.uint8),
        np.array([1.0, 0.0, 1.0], ">f4"),
        np.array([True, False, True]),
        np.array([[1], [0], [1]]),
        np.array([[1, 0, 1]]),
        np.array(["1", "0", "1"]),
        np.array([[0.5, 0, 0, 1], [0, 0.5, 0, 0], [0, 0, 0.5, 1]]),
    ],
)
def test_rows(array, as_file):
    assert read_npy(as_file("x.npy", npy(array)), WANTED).labels.tolist() == [1, 0, 1]


def test_names(as_file):
    found = read_npy(as_file("x.npy", npy(np.array(["leg", "", "arm"]))), WANTED)
    assert (found.labels.tolist(), found.names) == ([0, -1, 1], ("leg", "arm"))


def test_damaged_bytes_are_read_or_refused(damages):
    for contents in (npy(np.array(["leg", "arm", "leg"])), npy(np.array([1, 0, 1]))):
        assert damages(lambda path: read_npy(path, WANTED), "x.npy", contents) > 20
    archive = npz(labels=[1, 0, 1], names=["arm", "leg"])
    assert damages(lambda path: read_npz(path, WANTED), "x.npz", archive) > 100


def test_a_grid_lists_the_cells_that_have_a_label(as_file):
    grid = np.array([[[2, -1], [0, -1]], [[-1, -1], [1, 1]]])
    for array in (grid, grid.astype(float)):
        found = read_npy(as_file("x.npy", npy(array)), WANTED)
        assert found.labels.tolist() == [2, 0, 1, 1]


@pytest.mark.parametrize("elements", ["solid", "surface"])
def test_of_a_grid_the_cells_count_that_are_elements(elements, as_file):
    grid = np.arange(64).reshape(4, 4, 4)
    shape = Shape.from_voxels(grid % 5 > 0).with_elements(elements)
    path = as_file("x.npy", npy(np.where(grid % 7, grid, -1)))
    found = read_npy(path, Wanted.of(shape)).labels
    assert found.tolist() == [k if k % 7 else -1 for k in grid[tuple(shape.geometry.cells.T)]]


@pytest.mark.parametrize(
    "arrays",
    [
        {"labels": [1, 0, 1]},
        {"arr_0": [1, 0, 1]},
        {"vertices": np.zeros((5, 3)), "seg": [1, 0, 1]},
        {"vertices": np.zeros((5, 3)), "faces": np.zeros((3, 3), int), "q": [1, 0, 1]},
        {"part_id": [1.0, 0.0, 1.0], "areas": [0.5, 0.5, 0.5]},
        {"labels": [9, 9, 9], "mine": [1, 0, 1]},
    ],
)
def test_archives(arrays, as_file):
    wanted = MINE if "mine" in arrays else WANTED
    assert read_npz(as_file("x.npz", npz(**arrays)), wanted).labels.tolist() == [1, 0, 1]


@pytest.mark.parametrize("name", ["names", "label_names", "classes"])
def test_names_in_an_archive(name, as_file):
    found = read_npz(as_file("x.npz", npz(labels=[1, 0], **{name: ["arm", "leg"]})), WANTED)
    assert (found.labels.tolist(), found.names) == ([1, 0], ("arm", "leg"))


@pytest.mark.parametrize(
    ("reader", "contents", "message"),
    [
        (
            read_npy,
            npy(np.zeros((3, 5))),
            " holds float64 of shape (3, 5) instead of a row of whol",
        ),
        (read_npy, npy(np.zeros((2, 2, 2, 2))), " holds float64 of shape (2, 2, 2, 2) instead of"),
        (read_npy, npy(np.array([0.5])), " gives face 0 the label 0.5; labels are whole numbers"),
        (read_npz, npz(a=[0, 0, 0], b=[1, 1, 1]), " has no array 'labels' but a, b; say which"),
        (
            read_npz,
            npz(**{f"a{k}": [k] for k in range(14)}),
            " has no array 'labels' but a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11 and 2",
        ),
        (read_npz, npz(labels=[0], names=[1]), " has an array 'names' that is not a row of texts"),
        (read_npz, b"PK", " is no whole .npz file ("),
    ],
)
def test_what_is_refused(reader, contents, message, refusal):
    assert refusal(lambda path: reader(path, WANTED), "x.npz", contents).startswith(message)


@pytest.mark.parametrize(
    ("name", "of"), [("vertex_labels", "vertices"), ("face_labels", "elements"), ("seg", "unsaid")]
)
def test_an_array_may_say_what_it_labels(name, of, as_file):
    wanted = Wanted(n_elements=4, n_vertices=4, noun="face")
    assert read_npz(as_file("x.npz", npz(**{name: [7, 7, 5, 5]})), wanted).of == of


def archive(members, compression=zipfile.ZIP_DEFLATED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", compression) as file:
        for name, data in members.items():
            file.writestr(name, data)
    return stream.getvalue()


def test_an_archive_that_unpacks_to_too_much_is_not_unpacked(refusal):
    bomb = archive({"labels.npy": npy(np.zeros(10**7, np.int64))})
    assert len(bomb) < 10**5
    said = refusal(lambda path: read_npz(path, WANTED), "x.npz", bomb)
    assert " unpacks to 80000128 bytes, more than " in said
    found = read_npz_of(bomb, Wanted(n_elements=10**7))
    assert len(found.labels) == 10**7


def read_npz_of(data, wanted):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.npz"
        path.write_bytes(data)
        return read_npz(path, wanted)


@pytest.mark.parametrize(
    "members",
    [
        {"labels.npy": b"no array"},
        {"labels": b"no array"},
        {"labels.npy": npy(np.array([1, 0, 1]))[:-1]},
        {"labels.npy": b""},
        {"../../etc/passwd": b"root"},
        {},
    ],
)
@pytest.mark.parametrize("compression", [zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_members_that_are_no_arrays_are_refused(members, compression, refusal, damages):
    data = archive(members, compression)
    assert refusal(lambda path: read_npz(path, WANTED), "x.npz", data)
    assert damages(lambda path: read_npz(path, WANTED), "x.npz", data) > 20


def test_a_matrix_without_columns_is_no_row_of_labels(refusal):
    said = refusal(lambda path: read_npy(path, WANTED), "x.npy", npy(np.zeros((3, 0))))
    assert said.startswith(" holds float64 of shape (3, 0) instead of a row of whole labels")
