"""Pictures as formats of results: what of a result is shown."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.clipping.clip import Clipped
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.view.convergence import render_convergence
from moseg_core.view.picture import render_picture
from moseg_core.view.writer import write_png, write_svg
from tests.results import result_on

NAMES = ("first", "second")


def test_a_mesh_is_drawn_with_its_name_and_cost(box):
    result = result_on(box)
    drawn = render_picture(box.geometry, result.labels, NAMES, title="box, cost 22")
    assert write_png(result) == drawn


def test_the_pieces_of_a_clipped_result_are_drawn(box):
    pieces = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    clipped = Clipped(mesh=pieces, labels=np.array([1]), source=np.array([5]))
    drawn = render_picture(pieces, np.array([1]), NAMES, title="box, cost 22")
    assert write_png(result_on(box, clipped=clipped)) == drawn


def test_shares_of_a_cloud_are_those_of_its_points(monkeypatch):
    """Each point is drawn as a small body, whose own area says nothing."""
    areas = np.arange(1.0, 13.0)
    cloud = Shape.from_points(np.random.default_rng(0).random((12, 3)), areas=areas)
    given = {}

    def noted(surface, labels, names, **options):
        given.update(options)
        return b""

    monkeypatch.setattr("moseg_core.view.writer.render_picture", noted)
    write_png(result_on(cloud))
    np.testing.assert_allclose(given["areas"], areas)


@pytest.mark.parametrize("history", [None, {}])
def test_curves_have_the_same_title(box, history):
    result = result_on(box) if history is None else result_on(box, history=history)
    drawn = render_convergence(result.history, format="svg", title="box, cost 22")
    assert write_svg(result) == drawn
