"""NIfTI by nibabel: what a doctor's programs read of what moseg writes."""

from __future__ import annotations

import gzip

import nibabel
import numpy as np
import pytest
from moseg_medical.examples import AFFINE, ell, example
from moseg_medical.nifti import read_nifti, write_nifti

import moseg_core as moseg
from moseg_core import Shape, ShapeError
from moseg_core.testing.fixtures.results import result_on


def saved(tmp_path, image, name="scan.nii.gz"):
    path = tmp_path / name
    nibabel.save(image, path)
    return path


def written(shape, tmp_path, name="parts.nii.gz"):
    path = tmp_path / name
    moseg.save(result_on(shape), path)
    return nibabel.load(path)


@pytest.mark.parametrize("name", ["scan.nii", "scan.nii.gz", "a.b.NII.GZ"])
@pytest.mark.parametrize("kind", [nibabel.Nifti1Image, nibabel.Nifti2Image])
def test_a_label_map_lies_where_the_mask_lay(tmp_path, name, kind):
    image = kind(ell().astype(np.int16), AFFINE)
    image.header.set_xyzt_units("mm")
    image.set_qform(AFFINE, code=1, strip_shears=True)
    image.set_sform(AFFINE, code=3)
    path = tmp_path / name
    data = image.to_bytes()
    path.write_bytes(gzip.compress(data) if name.lower().endswith(".gz") else data)
    shape = moseg.load(path)
    assert shape.up == "z"
    back = written(shape, tmp_path)
    np.testing.assert_array_equal(back.affine, nibabel.load(path).affine)
    for form in ("get_sform", "get_qform"):
        (ours, our_code), (given, code) = (
            getattr(i, form)(coded=True) for i in (back, nibabel.load(path))
        )
        assert our_code == code
        np.testing.assert_array_equal(ours, given)
    assert isinstance(back, kind)
    assert back.header.get_xyzt_units()[0] == "mm"
    numbers = np.asanyarray(back.dataobj)
    assert numbers.dtype == np.uint8
    np.testing.assert_array_equal(numbers > 0, ell() > 0)
    # The first half of the cells, in C order, is the first part.
    where = np.argwhere(numbers == 2)[0]
    assert shape.geometry.cells[shape.n_elements // 2].tolist() == where.tolist()
    again = moseg.load(tmp_path / "parts.nii.gz")
    assert again.fingerprint == shape.fingerprint


def test_a_tilted_scan_of_flat_cells_measures_in_millimetres(tmp_path):
    mask = np.zeros((9, 9, 9), np.uint8)
    mask[2:6, 1:8, 3:5] = 1
    turn = nibabel.eulerangles.euler2mat(0.3, -0.2, 0.1)
    affine = np.eye(4)
    affine[:3, :3] = turn @ np.diag([-0.5, 0.5, 3.0])
    affine[:3, 3] = [40.0, -12.0, 900.0]
    shape = moseg.load(saved(tmp_path, nibabel.Nifti1Image(mask, affine)))
    (row,) = moseg.Segmentation.from_labels(shape, np.zeros(shape.n_elements, int), 1).parts
    assert shape.volume == pytest.approx(2.0 * 3.5 * 6.0, rel=1e-6)
    np.testing.assert_allclose(row.scales, np.array([6.0, 3.5, 2.0]) / np.sqrt(12), rtol=1e-5)
    np.testing.assert_allclose(np.abs(row.axes @ turn), np.eye(3)[[2, 1, 0]], atol=1e-5)
    middle = affine @ [3.5, 4.0, 3.5, 1.0]
    np.testing.assert_allclose(row.centroid, middle[:3], rtol=1e-5)


def test_scaled_values_are_the_values_that_are_meant(tmp_path):
    image = nibabel.Nifti1Image((ell() > 0).astype(np.float32) * 3.0, AFFINE)
    image.header.set_data_dtype(np.int16)
    image.header.set_slope_inter(3.0, 0.0)
    path = saved(tmp_path, image)
    shape = moseg.load(path)
    assert shape.n_elements == np.count_nonzero(ell())
    header = written(shape, tmp_path).header
    assert header.get_slope_inter() in ((1.0, 0.0), (None, None))
    assert header.get_intent()[0] == "label"


def test_a_grid_of_another_format_gets_an_affine(tmp_path):
    shape = Shape.from_voxels(np.ones((2, 3, 2), bool), pitch=(0.5, 0.5, 3), origin=(1, 2, 3))
    back = written(shape, tmp_path, "parts.nii")
    np.testing.assert_allclose(
        back.affine, [[0.5, 0, 0, 1.25], [0, 0.5, 0, 2.25], [0, 0, 3, 4.5], [0, 0, 0, 1]]
    )
    assert back.header.get_zooms() == (0.5, 0.5, 3.0)


def test_equal_results_give_equal_bytes_and_the_names_stand_beside():
    shape = Shape.from_voxels(np.ones((2, 3, 2), bool))
    files = write_nifti(result_on(shape), name="x.nii.gz")
    assert list(files) == ["x_labels.txt", "x.nii.gz"]
    assert files == write_nifti(result_on(shape), name="x.nii.gz")
    assert files["x.nii.gz"][4:8] == bytes(4)  # no time
    assert '"first"' in files["x_labels.txt"].decode()


def test_what_the_scanner_knew_of_the_patient_is_not_taken_over(tmp_path):
    image = nibabel.Nifti1Image(ell(), AFFINE)
    image.header.extensions.append(
        nibabel.nifti1.Nifti1Extension("comment", b"a patient of that name")
    )
    shape = moseg.load(saved(tmp_path, image))
    assert not written(shape, tmp_path).header.extensions


def test_a_file_that_announces_more_than_it_has(tmp_path):
    data = bytearray(example(".nii"))
    data[42:48] = np.array([30000, 30000, 30000], "<i2").tobytes()
    path = tmp_path / "x.nii"
    path.write_bytes(data)
    with pytest.raises(ShapeError, match=r"x\.nii announces a volume of 30000 x 30000 x 30000"):
        read_nifti(path)
    path.write_bytes(b"\x1f\x8b nothing")
    with pytest.raises(ShapeError, match="cannot be unzipped"):
        read_nifti(path)
    path.write_bytes(b"a text that is long enough for a header" * 20)
    with pytest.raises(ShapeError, match="is not a NIfTI file"):
        read_nifti(path)


def test_labels_of_a_map_with_the_names_beside_it(tmp_path):
    shape = moseg.load(saved(tmp_path, nibabel.Nifti1Image(ell(), AFFINE)))
    result = result_on(shape)
    moseg.save(result, tmp_path / "parts.nii.gz")
    found = moseg.read_labels(tmp_path / "parts.nii.gz", shape)
    assert found.labels.tolist() == result.labels.tolist()
    assert found.names == ("first", "second")
    (tmp_path / "parts_labels.txt").unlink()
    bare = moseg.read_labels(tmp_path / "parts.nii.gz", shape)
    assert (bare.labels - 1).tolist() == result.labels.tolist()
    assert bare.names is None


def test_labels_are_those_of_places(tmp_path):
    shape = moseg.load(saved(tmp_path, nibabel.Nifti1Image((ell() == 2).astype("u1"), AFFINE)))
    other = saved(tmp_path, nibabel.Nifti1Image(ell(), AFFINE), "labels.nii")
    assert set(moseg.read_labels(other, shape).labels.tolist()) == {2}
    moved = AFFINE.copy()
    moved[0, 3] += 1.0
    away = saved(tmp_path, nibabel.Nifti1Image(ell(), moved), "away.nii")
    with pytest.raises(ShapeError, match=r"labels another place .* up to 1 mm away"):
        moseg.read_labels(away, shape)
    small = saved(tmp_path, nibabel.Nifti1Image(ell()[1:], AFFINE), "small.nii")
    with pytest.raises(ShapeError, match="labels a grid of 4 x 4 x 3 cells"):
        moseg.read_labels(small, shape)
