"""NRRD by pynrrd: what 3D Slicer reads of what moseg writes."""

from __future__ import annotations

import nrrd
import numpy as np
import pytest
from moseg_medical.examples import AFFINE, ell
from moseg_medical.nrrd_files import read_nrrd, write_nrrd

import moseg_core as moseg
from moseg_core import Shape, ShapeError
from moseg_core.testing.fixtures.results import result_on

LPS = np.array([-1.0, -1.0, 1.0])


def header_of(space="left-posterior-superior", signs=LPS, **more):
    return {
        "space": space,
        "space directions": AFFINE[:3, :3].T * signs,
        "space origin": AFFINE[:3, 3] * signs,
        "kinds": ["domain"] * 3,
        "space units": ["mm"] * 3,
        **more,
    }


def saved(tmp_path, values, header, name="scan.nrrd"):
    path = tmp_path / name
    nrrd.write(str(path), values, header)
    return path


def written(shape, tmp_path):
    path = tmp_path / "parts.nrrd"
    moseg.save(result_on(shape), path)
    return nrrd.read(str(path))


@pytest.mark.parametrize(
    ("space", "signs"),
    [
        ("left-posterior-superior", LPS),
        ("LPS", LPS),
        ("right-anterior-superior", np.ones(3)),
        ("left-anterior-superior", np.array([-1.0, 1.0, 1.0])),
    ],
)
def test_a_label_map_lies_where_the_mask_lay(tmp_path, space, signs):
    given = header_of(space, signs, Patient="none", Segment7_Name="old", encoding="raw")
    shape = moseg.load(saved(tmp_path, ell().astype(np.int32), given))
    np.testing.assert_allclose(shape.points, np.argwhere(ell()) @ AFFINE[:3, :3].T + AFFINE[:3, 3])
    assert shape.up == "z"
    numbers, header = written(shape, tmp_path)
    assert numbers.dtype == np.uint8
    np.testing.assert_array_equal(numbers > 0, ell() > 0)
    np.testing.assert_array_equal(header["space directions"], given["space directions"])
    np.testing.assert_array_equal(header["space origin"], given["space origin"])
    for key in ("space", "kinds", "space units", "Patient"):
        assert header[key] == given[key]
    assert header["Segment0_Name"] == "first"
    assert header["Segment1_LabelValue"] == "2"
    assert "Segment7_Name" not in header
    assert moseg.load(tmp_path / "parts.nrrd").fingerprint == shape.fingerprint


def test_cells_have_the_spacings_where_there_are_no_directions(tmp_path):
    shape = moseg.load(saved(tmp_path, ell(), {"spacings": [0.5, 0.5, 3.0]}))
    np.testing.assert_allclose(shape.points, np.argwhere(ell()) * [0.5, 0.5, 3.0])
    bare = moseg.load(saved(tmp_path, ell(), {}, "bare.nrrd"))
    assert bare.up is None
    assert bare.volume == np.count_nonzero(ell())
    assert written(shape, tmp_path)[1]["spacings"].tolist() == [0.5, 0.5, 3.0]


def test_one_layer_of_segments_is_a_label_map_and_several_are_refused(tmp_path):
    directions = [[np.nan] * 3, *(AFFINE[:3, :3].T * LPS).tolist()]
    header = header_of() | {"space directions": np.array(directions)}
    header["kinds"] = ["list", "domain", "domain", "domain"]
    shape = moseg.load(saved(tmp_path, ell()[None], header))
    assert shape.n_elements == np.count_nonzero(ell())
    numbers, back = written(shape, tmp_path)
    assert numbers.shape == ell().shape
    assert back["kinds"] == ["domain"] * 3
    np.testing.assert_array_equal(back["space directions"], AFFINE[:3, :3].T * LPS)
    two = saved(tmp_path, np.stack([ell(), ell()]), header, "two.nrrd")
    with pytest.raises(ShapeError, match=r"a volume of 4 axes.*one label map"):
        moseg.load(two)


def test_from_nifti_to_nrrd_and_back(tmp_path):
    shape = Shape.from_voxels(np.ones((2, 3, 2), bool), pitch=(0.5, 0.5, 3), origin=(1, 2, 3))
    moseg.save(result_on(shape), tmp_path / "a.nrrd")
    again = moseg.load(tmp_path / "a.nrrd")
    np.testing.assert_allclose(again.points, shape.points)
    moseg.save(result_on(again), tmp_path / "b.nii.gz")
    np.testing.assert_allclose(moseg.load(tmp_path / "b.nii.gz").points, shape.points)


def test_equal_results_give_equal_bytes_without_a_date():
    result = result_on(Shape.from_voxels(np.ones((2, 3, 2), bool)))
    data = write_nrrd(result)
    assert data == write_nrrd(result)
    assert b"\n#" not in data.partition(b"\n\n")[0]


def test_values_in_another_file_are_not_looked_for(tmp_path):
    path = tmp_path / "x.nrrd"
    head = "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n"
    path.write_text(head + "data file: /etc/hostname\n\n")
    with pytest.raises(ShapeError, match="keeps its values in another file, '/etc/hostname'"):
        read_nrrd(path)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("sizes: 99999 99999 99999\n", "announces"),
        ("sizes: 2 2 2\n", "is damaged"),
        ("sizes: 2 2\n", "is damaged"),
    ],
)
def test_damaged_headers(tmp_path, lines, message):
    path = tmp_path / "x.nrrd"
    path.write_text(f"NRRD0005\ntype: uint8\ndimension: 3\n{lines}encoding: raw\n\n")
    with pytest.raises(ShapeError, match=message):
        read_nrrd(path)


def test_labels_of_a_map_with_the_names_of_its_segments(tmp_path):
    shape = moseg.load(saved(tmp_path, ell(), header_of()))
    result = result_on(shape)
    moseg.save(result, tmp_path / "parts.nrrd")
    found = moseg.read_labels(tmp_path / "parts.nrrd", shape)
    assert (found.labels.tolist(), found.names) == (result.labels.tolist(), ("first", "second"))
    some = header_of(Segment0_Name="femur", Segment0_LabelValue="2", Segment1_Name="lost")
    partly = moseg.read_labels(saved(tmp_path, ell(), some, "some.nrrd"), shape)
    assert partly.names == ("label 1", "femur")
