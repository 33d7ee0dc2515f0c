"""The examples are files that the libraries of the formats read as they are meant."""

from __future__ import annotations

import io

import nibabel
import nrrd
import numpy as np
import pytest
from moseg_medical.examples import AFFINE, ell, example


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz"])
def test_nifti(suffix, tmp_path):
    path = tmp_path / f"x{suffix}"
    path.write_bytes(example(suffix))
    image = nibabel.load(path)
    np.testing.assert_array_equal(np.asanyarray(image.dataobj), ell())
    np.testing.assert_allclose(image.affine, AFFINE, rtol=1e-6)


def test_nrrd():
    stream = io.BytesIO(example(".nrrd"))
    header = nrrd.read_header(stream)
    np.testing.assert_array_equal(nrrd.read_data(header, stream), ell())
    np.testing.assert_allclose(header["space origin"], AFFINE[:3, 3] * [-1, -1, 1])
