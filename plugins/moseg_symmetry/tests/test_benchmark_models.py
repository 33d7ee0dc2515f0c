"""Planes of real models, judged by the names that people gave to their parts.

Looks for the models in the folder that ``MOSEG_PSB`` names, and is skipped without it.
"""

from __future__ import annotations

import numpy as np
import pytest
from moseg_symmetry.motions import Reflection
from moseg_symmetry.plane_detection import require_plane
from moseg_symmetry.surface import surface_of

from moseg_core import ShapeError, load
from moseg_core.io import read_labels

pytestmark = pytest.mark.slow

FOUR_LEGS = (381, 385, 389, 393, 397)
BIRDS = (241, 245, 249, 253, 257)
AIRPLANES = (61, 65, 69, 73, 77)


def labels_kept(folder, model, found, shape):
    """Share of the area whose label is the same at its mirror image."""
    truth = read_labels(folder / "labels" / f"{model}_labels.txt", shape.n_elements)
    labels = np.asarray(truth.labels)[shape.geometry.triangle_polygon]
    surface = surface_of(shape)
    points = surface.samples(4000)
    offset = -float(found.plane.heights(surface.center)) / surface.size
    images = Reflection(found.plane.normal, offset).images(points)[0]
    there, here = surface.nearest(images)[1], surface.nearest(points)[1]
    return float((labels[there] == labels[here]).mean())


@pytest.mark.parametrize("model", FOUR_LEGS + BIRDS + AIRPLANES)
def test_the_plane_keeps_the_labels(psb, model):
    shape = load(psb / "off" / f"{model}.off")
    found = require_plane(shape)
    assert found.residual < 0.006
    assert labels_kept(psb, model, found, shape) >= 0.85


@pytest.mark.parametrize("model", [9, 181, 189, 193, 197, 281])
def test_hands_and_contorted_people_have_none(psb, model):
    with pytest.raises(ShapeError, match=f"'{model}' has no plane of symmetry"):
        require_plane(load(psb / "off" / f"{model}.off"))
