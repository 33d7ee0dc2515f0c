"""Surroundings of rods and plates, whose moments are known, and of a lump, by the formula."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_learn.neighbourhoods import Neighbourhoods
from moseg_learn.surroundings import QUANTITIES, around, surroundings

import moseg_core as moseg
from moseg_core import Shape, UsageError, field_values


def of(shape, name, radius):
    return field_values(shape, "learn:surroundings", of=name, radius=radius)


@pytest.fixture(scope="module")
def rod():
    box = trimesh.creation.box((10, 0.3, 0.3))
    return Shape.from_mesh(*trimesh.remesh.subdivide_to_size(box.vertices, box.faces, 0.25))


@pytest.fixture(scope="module")
def lump():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    bent = mesh.vertices * [1.5, 1, 0.6] + 0.2 * np.sin(3 * mesh.vertices[:, [1, 2, 0]])
    return Shape.from_mesh(bent, mesh.faces)


@pytest.mark.parametrize("radius", [0.08, 0.16, 0.3])
def test_along_a_rod(rod, radius):
    """In the middle twice the radius is in reach, at an end once: a rod of length l has l/sqrt(12).

    The unit is the diagonal, which is the length of the rod, nearly.
    """
    x = np.abs(rod.points[:, 0]) / 10
    middle, end = x < 0.5 - 1.2 * radius, x > 0.499
    for where, length in ((middle, 2 * radius), (end, radius)):
        assert of(rod, "area", radius)[where] == pytest.approx(np.log(length), abs=0.2)
        found = of(rod, "length", radius)[where]
        assert found == pytest.approx(np.log(length / np.sqrt(12)), abs=0.12)
        thin = np.log(0.3 / np.sqrt(6) / (10 * length / np.sqrt(12)))
        assert of(rod, "width", radius)[where] == pytest.approx(thin, abs=0.15)
        assert of(rod, "depth", radius)[where] == pytest.approx(thin, abs=0.3)
    assert of(rod, "offset", radius)[middle].max() < 0.25
    assert of(rod, "offset", radius)[end] == pytest.approx(0.5, abs=0.12)


def test_amid_a_plate():
    """A disc of radius r has the scales r/2, r/2 and 0, which is taken for 0.01 r."""
    plate = trimesh.creation.cylinder(radius=1, height=0.001, sections=64)
    fine = trimesh.remesh.subdivide_to_size(plate.vertices, plate.faces, 0.1)
    shape = Shape.from_mesh(*fine)
    middle = np.linalg.norm(shape.points[:, :2], axis=1) < 0.5
    diagonal, radius = shape.box_diagonal, 0.16
    assert diagonal == pytest.approx(np.sqrt(8), rel=0.01)
    assert of(shape, "length", radius)[middle] == pytest.approx(np.log(radius / 2), abs=0.05)
    assert of(shape, "width", radius)[middle] == pytest.approx(0, abs=0.08)
    assert of(shape, "depth", radius)[middle] == pytest.approx(np.log(0.02), abs=0.05)
    assert of(shape, "offset", radius)[middle].max() < 0.1
    assert of(shape, "flatness", radius)[middle] == pytest.approx(1, abs=0.05)
    assert of(shape, "bending", radius)[middle] == pytest.approx(0, abs=0.01)
    assert of(shape, "hollow", radius)[middle] == pytest.approx(0, abs=0.01)


def test_along_a_tube_and_on_a_ball():
    """Normals of a tube lie in a plane, those of a ball everywhere; the centroids lie inside."""
    turn, x = np.meshgrid(np.linspace(0, 2 * np.pi, 16, endpoint=False), np.linspace(-2, 2, 41))
    corners = np.stack([x, 0.1 * np.cos(turn), 0.1 * np.sin(turn)], axis=2).reshape(-1, 3)
    at = np.arange(40 * 16).reshape(40, 16)
    beside = np.roll(at, -1, axis=1)
    squares = np.stack([at, beside, beside + 16, at + 16], axis=2).reshape(-1, 4)
    shape = Shape.from_mesh(corners, squares)
    middle = np.abs(shape.points[:, 0]) < 1.0
    assert of(shape, "bending", 0.16)[middle] == pytest.approx(1 / 2, abs=0.03)
    assert of(shape, "doming", 0.16)[middle] == pytest.approx(0, abs=0.03)
    assert of(shape, "flatness", 0.16)[middle].max() < 0.15
    ball = trimesh.creation.icosphere(subdivisions=3)
    shape = Shape.from_mesh(ball.vertices, ball.faces[:, ::-1])  # the file's normals point inward
    for name, value in (("bending", 1 / 3), ("doming", 1 / 3), ("flatness", 0)):
        assert of(shape, name, 2.0) == pytest.approx(value, abs=1e-3)
    radius = 2.0 * shape.box_diagonal
    assert of(shape, "hollow", 2.0) == pytest.approx(-1 / radius, abs=2e-3)


@pytest.mark.parametrize("radius", [0.08, 0.3])
def test_sums_by_the_formula(lump, radius):
    within, diagonal = Neighbourhoods.of(lump).within(radius), lump.box_diagonal
    corners = np.asarray(lump.geometry.vertices)[np.asarray(lump.geometry.triangles)]
    fields = [field_values(lump, f"basic:{x}") for x in ("log_thickness", "concavity")]
    fields.append(field_values(lump, "basic:remoteness"))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    found = around(lump, radius)
    for i in range(0, lump.n_elements, 40):
        # A triangle is as heavy as the middles of its sides are, to the second moment.
        weights = np.repeat(within[i] * lump.areas / 3, 3)
        points = ((corners + np.roll(corners, 1, axis=1)) / 2).reshape(-1, 3)
        middle = np.average(points, axis=0, weights=weights)
        off = points - middle
        second = np.einsum("i,ij,ik->jk", weights, off, off) / weights.sum()
        scales = np.sqrt(np.linalg.eigvalsh(second)[::-1]) / diagonal
        scales = np.maximum(scales, 0.01 * radius)
        expected = [
            np.log(weights.sum() / lump.area),
            np.log(scales[0]),
            np.log(scales[1] / scales[0]),
            np.log(scales[2] / scales[0]),
            *(np.average(values, weights=within[i] * lump.areas) for values in fields),
            np.linalg.norm(middle - lump.points[i]) / radius / diagonal,
        ]
        areas = within[i] * lump.areas
        products = np.einsum("i,ij,ik->jk", areas, normals, normals) / areas.sum()
        expected += [
            np.linalg.norm(areas @ normals) / areas.sum(),
            *np.linalg.eigvalsh(products)[1::-1],
            (middle - lump.points[i]) @ normals[i] / radius / diagonal,
        ]
        assert found[i] == pytest.approx(expected, abs=1e-6)


def test_within_a_radius_that_has_it_all(lump):
    assert of(lump, "area", 2.0) == pytest.approx(0, abs=1e-12)
    for name in ("log_thickness", "concavity", "remoteness"):
        mean = np.average(field_values(lump, f"basic:{name}"), weights=lump.areas)
        assert of(lump, name.removeprefix("log_"), 2.0) == pytest.approx(mean)
    assert np.ptp(of(lump, "length", 2.0)) < 1e-9


def test_all_quantities_have_names_and_an_unknown_one_is_refused(lump):
    assert around(lump, 0.08).shape == (lump.n_elements, len(QUANTITIES))
    for k, name in enumerate(QUANTITIES):
        assert np.array_equal(surroundings(lump, of=name, radius=0.08), around(lump, 0.08)[:, k])
    with pytest.raises(UsageError, match="unknown quantity 'lenght'; did you mean 'length'"):
        of(lump, "lenght", 0.08)


def test_an_element_without_area_has_what_is_around_it():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    a, b, _ = mesh.faces[0]
    shape = Shape.from_mesh(mesh.vertices, [*mesh.faces.tolist(), [a, b, b]])
    alone = Shape.from_mesh(mesh.vertices, mesh.faces)
    for name in QUANTITIES:
        values = of(shape, name, 0.16)
        assert np.isfinite(values).all()
        assert values[:-1] == pytest.approx(of(alone, name, 0.16), abs=0.15)


def test_on_a_fine_mesh_values_are_those_of_a_coarse_one():
    horse = moseg.load(moseg.sample_path("horse"))
    assert horse.n_elements > 1500
    vertices, faces = trimesh.remesh.subdivide(
        np.asarray(horse.geometry.vertices), np.asarray(horse.geometry.triangles)
    )
    fine = Shape.from_mesh(vertices, faces)
    for name in ("area", "length", "width", "depth", "remoteness"):
        values, means = of(horse, name, 0.16), of(fine, name, 0.16).reshape(-1, 4).mean(axis=1)
        assert np.median(np.abs(values - means)) < 0.05 * np.ptp(values)
