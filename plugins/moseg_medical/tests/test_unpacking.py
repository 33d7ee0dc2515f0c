"""Bombs and lies of packed files: refused in a line, within bounds; good masks still read."""

from __future__ import annotations

import bz2
import gzip
import json
import struct
import subprocess
import sys
from pathlib import Path

import nibabel
import numpy as np
import pytest
from moseg_medical.unpacking import unpacked

import moseg_core as moseg
from moseg_core import ReadLimits, ShapeError

#: Reads files one after the other, and tells what became of each, under limits by a factor.
CHILD = """
import json, resource, sys, traceback, warnings

resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
resource.setrlimit(resource.RLIMIT_CPU, (120, 120))
warnings.simplefilter("error")
import moseg_core as moseg

found = {}
for path in json.load(sys.stdin):
    before = resource.getrusage(resource.RUSAGE_SELF)
    try:
        told = str(moseg.load(path).n_elements)
    except moseg.ShapeError as error:
        told = str(error)
    except BaseException:  # what should not be is told, and fails the test
        told = traceback.format_exc()
    after = resource.getrusage(resource.RUSAGE_SELF)
    found[path] = told, after.ru_utime - before.ru_utime, after.ru_maxrss - before.ru_maxrss
print(json.dumps(found))
"""
CUBE = np.pad(np.ones((4, 4, 4), np.uint8), 2)
VALUES = CUBE.tobytes()
EMPTY = bytes(2**25)


def nifti(kind=nibabel.Nifti1Image, **fields):
    """A file whose header says what it should not, by the names of its fields."""
    image = kind(CUBE, np.eye(4))
    data = image.to_bytes()
    length = len(image.header.binaryblock)
    header = kind.header_class(data[:length], check=False)
    for key, value in fields.items():
        header[key] = value
    return header.binaryblock + data[length:]


def nrrd(values=VALUES, *, sizes="8 8 8", encoding="raw", kind="uint8", more=""):
    head = f"type: {kind}\ndimension: {len(sizes.split())}\nsizes: {sizes}\nencoding: {encoding}\n"
    return f"NRRD0005\n{head}{more}\n".encode() + values


def dim(*sizes):
    return [len(sizes), *sizes, *[1] * (7 - len(sizes))]


def extension(size):
    data = nifti(vox_offset=384)
    return data[:348] + bytes([1, 0, 0, 0]) + struct.pack("<ii", size, 6) + bytes(24) + data[352:]


#: By the name of the file its bytes, and what is said of it.
BAD = {
    "goes_on.nii.gz": (gzip.compress(nifti() + EMPTY, 1), "unpacks to more than the 864 bytes"),
    "goes_on_gz.nrrd": (
        nrrd(gzip.compress(EMPTY, 1), encoding="gzip"),
        "unpacks to more than the 512 bytes",
    ),
    "goes_on_bz2.nrrd": (nrrd(bz2.compress(EMPTY), encoding="bz2"), "unpacks to more than the 512"),
    "longer.nrrd": (
        nrrd(gzip.compress(CUBE.tobytes() * 8), encoding="gz"),
        "unpacks to 4096 bytes instead of 512",
    ),
    "cells.nii.gz": (gzip.compress(nifti(dim=dim(16384, 16384, 4096))), "--limit grid_cells="),
    "cells.nii": (nifti(dim=dim(16384, 16384, 4096)), "cut off or damaged"),
    "cells_2.nii.gz": (
        gzip.compress(nifti(nibabel.Nifti2Image, dim=dim(2**20, 2**20, 2**20))),
        "--limit grid_cells=",
    ),
    "cells.nrrd": (nrrd(sizes="16384 16384 4096", encoding="gzip"), "--limit grid_cells="),
    "wide.nii.gz": (
        gzip.compress(nifti(dim=dim(512, 512, 1000), datatype=64, bitpix=64)),
        "--limit unpacked_bytes=",
    ),
    "wide.nrrd": (
        nrrd(
            bz2.compress(b""),
            sizes="512 512 1000",
            encoding="bz2",
            kind="double",
            more="endian: big\n",
        ),
        "--limit unpacked_bytes=",
    ),
    "negative.nii": (nifti(dim=dim(-8, 8, 8)), "-8 x 8 x 8; it is damaged"),
    "axes.nii": (nifti(dim=[9, 8, 8, 8, 1, 1, 1, 1]), "cut off or damaged"),
    "no_axes.nii": (nifti(dim=[-3, 8, 8, 8, 1, 1, 1, 1]), "no axes"),
    "negative.nrrd": (nrrd(sizes="-8 8 -8"), "-8 x 8 x -8 cells; it is damaged"),
    "axes.nrrd": (nrrd(sizes=" ".join(65 * ["1"])), "is damaged"),
    "digits.nrrd": (nrrd(sizes=5000 * "9" + " 1 1"), "is damaged"),
    "begin_nan.nii.gz": (gzip.compress(nifti(vox_offset=np.nan)), "not a NIfTI file"),
    "begin_inf.nii": (nifti(vox_offset=np.inf), "not a NIfTI file"),
    "begin_far.nii.gz": (gzip.compress(nifti(vox_offset=1e38)), "--limit unpacked_bytes="),
    "begin_negative.nii": (nifti(vox_offset=-5), "begin at byte -5"),
    "affine_nan.nii": (nifti(srow_x=[np.nan, 0, 0, 0], sform_code=1), "numbers that are none"),
    "affine_far.nii.gz": (gzip.compress(nifti(srow_x=[1, 0, 0, 3e38])), "told apart"),
    "affine_flat.nii": (nifti(srow_x=[0, 0, 0, 0], sform_code=1), "a positive pitch"),
    "turned.nii": (nifti(quatern_b=3e38, sform_code=0, qform_code=1), "not a NIfTI file"),
    "affine_far.nrrd": (
        nrrd(more="space: LPS\nspace directions: (1e300,0,0) (0,1,0) (0,0,1)\n"),
        "beyond what can be measured",
    ),
    "origin.nrrd": (
        nrrd(
            more="space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (nan,0,0)\n"
        ),
        "beyond what can be measured",
    ),
    "extension.nii": (extension(0), "not a NIfTI file"),
    "scaled.nii": (nifti(scl_slope=3e38), "numbers up to 3e+38"),
    "cut.nii.gz": (gzip.compress(nifti())[:-9], "cannot be unzipped"),
    "cut_early.nii.gz": (gzip.compress(nifti())[:40], "cannot be unzipped"),
    "cut.nii": (nifti()[:-9], "cut off or damaged"),
    "cut_header.nii": (nifti()[:300], "not a NIfTI file"),
    "cut_gz.nrrd": (nrrd(gzip.compress(CUBE.tobytes())[:-9], encoding="gz"), "cannot be unzipped"),
    "cut_bz2.nrrd": (nrrd(bz2.compress(CUBE.tobytes())[:-9], encoding="bz2"), "cannot be unz"),
    "twice.nii.gz": (gzip.compress(gzip.compress(nifti())), "not a NIfTI file"),
    "text.nii": (b"garbage " * 1000, "not a NIfTI file"),
    "lines.nrrd": (nrrd(more=f"line skip: {2**40}\n"), "it is to skip"),
    "lines_gz.nrrd": (nrrd(encoding="gz", more=f"line skip: {2**40}\n"), "it is to skip"),
    "bytes.nrrd": (nrrd(more=f"byte skip: {2**40}\n"), "is damaged"),
    "bytes_gz.nrrd": (nrrd(encoding="gz", more=f"byte skip: {2**40}\n"), "--limit unpacked"),
    "device.nrrd": (nrrd(b"", more="data file: /dev/zero\n"), "in another file, '/dev/zero'"),
    "up.nrrd": (nrrd(b"", more="datafile: ../../x.raw\n"), "in another file, '../../x.raw'"),
    "device_2.nrrd": (nrrd(b"", more="Data File: /dev/zero\n"), "is damaged"),
    "garbage.nrrd": (nrrd(b"garbage " * 1000, encoding="text"), "is damaged"),
    "few.nrrd": (nrrd(b"1 2 3", encoding="ascii"), "is damaged"),
    "block.nrrd": (nrrd(kind="block"), "is damaged"),
    "hex.nrrd": (nrrd(encoding="hex"), "Unsupported encoding"),
    "long_line.nrrd": (b"NRRD0005\n" + bytes(10**6), "is damaged"),
}


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What became of each file, in one child process under limits."""
    folder = tmp_path_factory.mktemp("bad")
    for name, (data, _) in BAD.items():
        (folder / name).write_bytes(data)
    paths = [str(folder / name) for name in BAD]
    ended = subprocess.run(
        [sys.executable, "-c", CHILD],
        input=json.dumps(paths),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stderr == ""
    return {Path(path).name: found for path, found in json.loads(ended.stdout).items()}


@pytest.mark.parametrize("name", BAD)
def test_a_file_that_lies_is_refused_in_a_line_within_bounds(told, name):
    message, seconds, kilobytes = told[name]
    assert BAD[name][1] in message
    assert "\n" not in message
    assert name in message
    assert seconds < 5.0  # of the processor; all but imports takes milliseconds
    assert kilobytes < 200_000


def test_good_masks_of_200_cells_along_each_side_are_read(tmp_path):
    ball = np.linalg.norm(np.indices((200, 200, 200)) - 99.5, axis=0) < 50
    values = gzip.compress(ball.astype("u1").tobytes(order="F"), 1)
    files = {
        "ball.nii.gz": gzip.compress(
            nibabel.Nifti1Image(ball.astype("f4"), np.eye(4)).to_bytes(), 1
        ),
        "ball.nrrd": nrrd(values, sizes="200 200 200", encoding="gzip"),
    }
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
        shape = moseg.load(tmp_path / name)
        np.testing.assert_array_equal(shape.geometry.occupied, ball)


@pytest.mark.parametrize(
    ("values", "more"),
    [
        (gzip.compress(b"1234567" + CUBE.tobytes()), "byte skip: 7\n"),
        (gzip.compress(b"1234567" + CUBE.tobytes()), "byte skip: -1\n"),
        (b"one\ntwo\n" + gzip.compress(CUBE.tobytes()), "line skip: 2\n"),
    ],
    ids=["bytes", "all but the values", "lines"],
)
def test_what_is_to_be_skipped_before_packed_values(tmp_path, values, more):
    (tmp_path / "x.nrrd").write_bytes(nrrd(values, encoding="gzip", more=more))
    assert moseg.load(tmp_path / "x.nrrd").n_elements == 64


def test_limits_are_the_users_to_set(tmp_path):
    path = tmp_path / "x.nii.gz"
    path.write_bytes(gzip.compress(nifti()))
    shape = moseg.load(path)
    for limits, name in (
        (ReadLimits(unpacked_bytes=800), "unpacked_bytes=800"),
        (ReadLimits(grid_cells=511), "grid_cells=511"),
        (ReadLimits(cells=63), "cells=63"),
    ):
        with pytest.raises(ShapeError, match=name):
            moseg.load(path, limits=limits)
    assert shape.n_elements == 64


def test_a_stream_is_unpacked_no_further_than_it_should_be():
    packed = gzip.compress(EMPTY)
    with pytest.raises(ShapeError, match="unpacks to more than the 10 bytes"):
        unpacked(Path("x"), packed, "gzip", announced=10, limits=ReadLimits())
    few = unpacked(Path("x"), gzip.compress(b"ab"), "gzip", announced=10, limits=ReadLimits())
    assert few.read() == b"ab"
