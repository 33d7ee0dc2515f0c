from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from moseg_mds.embedding import MDS
from moseg_mds.geodesics import geodesic_distances
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core import Problem, Shape, ShapeError, UsageError
from moseg_core.components.protocols import Embedding


def places(shape, *, landmarks=60, **parameters):
    return MDS(landmarks=landmarks, **parameters)(shape).geometry.vertices


def signed_volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] - vertices.mean(axis=0) for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def ratio(first, second):
    """Relative difference of two tables of distances, up to a common factor."""
    first, second = first / first.mean(), second / second.mean()
    return np.abs(first - second).max() / second.max()


def test_it_is_an_embedding(make):
    shape = make.shape(make.blob(0))
    found = MDS(landmarks=60)(shape)
    assert isinstance(MDS(), Embedding)
    assert found.space == "mds"
    assert found.frame.scale == pytest.approx(1, abs=1e-12)
    np.testing.assert_allclose(found.frame.center, 0, atol=1e-12)
    np.testing.assert_array_equal(found.geometry.corners, shape.geometry.corners)
    assert found.adjacency is shape.adjacency


@pytest.mark.parametrize("landmarks", [40, 120])
@pytest.mark.parametrize("radius", [3.0, 0.7])
def test_a_bent_strip_becomes_flat_again(make, landmarks, radius):
    """Almost closed to a ring of 4 by 1, at a radius of 0.7."""
    flat = make.strip(33, 9)
    bent = make.shape(make.rolled(flat, radius))
    found = places(bent, landmarks=landmarks)
    table, true = make.apart(found), make.apart(flat[0])
    assert ratio(table, true) < 0.02
    sizes = np.linalg.svd(found - found.mean(axis=0))[1]
    assert sizes[2] < 0.1 * sizes[1]


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0])
def test_what_is_flat_stays_as_it_is(make, exponent):
    flat = make.strip(25, 7)
    found = places(make.shape(flat), exponent=exponent)
    assert ratio(make.apart(found), make.apart(flat[0])) < 0.02


def test_without_refinement_it_is_landmark_scaling(make):
    flat = make.strip(25, 7)
    bent = make.shape(make.rolled(flat, 1.0))
    assert ratio(make.apart(places(bent, refine=0)), make.apart(flat[0])) < 0.02


def test_refinement_lowers_the_stress(make):
    shape = make.shape(make.blob(2, 2))
    stresses = [
        MDS(landmarks=60, refine=steps, exponent=0.0).embed(shape).stress for steps in (0, 300)
    ]
    assert stresses[1] < 0.9 * stresses[0]


def curled(t):
    return 3.0 * t


def waved(t):
    return 0.7 * np.sin(2 * np.pi * t)


def test_two_poses_of_one_shape_are_embedded_alike(make):
    one, other = (make.worm(bend) for bend in (curled, waved))
    straight = make.worm(lambda t: 0 * t)
    first, second = (places(make.shape(mesh)) for mesh in (one, other))
    assert ratio(make.apart(one[0]), make.apart(other[0])) > 0.2
    assert ratio(make.apart(first), make.apart(second)) < 0.03
    assert ratio(make.apart(first), make.apart(straight[0])) < 0.03


@pytest.mark.parametrize("bend", [curled, waved])
def test_the_outside_stays_outside(make, bend):
    vertices, faces = make.worm(bend, 0.02)
    for mesh in ((vertices, faces), (vertices, faces[:, ::-1])):
        shape = make.shape(mesh)
        found = MDS(landmarks=60)(shape)
        before, after = (signed_volume(v, mesh[1]) for v in (vertices, found.geometry.vertices))
        assert before * after > 0
        assert found.volume == pytest.approx(abs(after), rel=1e-9)
        # It has not folded over, nor shrunk to a line. Half-way around is longer than across.
        straight = make.shape(make.worm(lambda t: 0 * t, 0.02))
        true = straight.volume / straight.frame.scale**3
        assert true < found.volume < 2 * true


@pytest.mark.parametrize("seed", [0, 2])
def test_an_estimated_volume_says_nothing_of_the_outside(make, seed):
    vertices, faces = make.worm(curled, 0.02)
    turned = np.random.default_rng(seed).random(len(faces)) < 0.5
    shape = make.shape((vertices, np.where(turned[:, None], faces[:, ::-1], faces)))
    assert shape.volume is None
    known = shape.with_volume(0.5)
    assert (places(known, landmarks=60) == places(shape, landmarks=60)).all()


@pytest.mark.parametrize("landmarks", [60, 162])
def test_motions_and_units_do_not_matter(make, landmarks):
    vertices, faces = make.blob(3, 2)
    reference = make.apart(places(make.shape((vertices, faces)), landmarks=landmarks))
    turn = Rotation.from_rotvec([0.4, -1.0, 2.0])
    for moved in (turn.apply(vertices), 1e3 * vertices + 7.0, vertices * [1, 1, -1]):
        found = make.apart(places(make.shape((moved, faces)), landmarks=landmarks))
        assert ratio(found, reference) < 1e-3


def test_it_lies_as_the_original_does(make):
    vertices, faces = make.blob(0, 2)
    turn = Rotation.from_rotvec([0.4, -1.0, 2.0])
    found = places(make.shape((vertices, faces)))
    turned = places(make.shape((turn.apply(vertices), faces)))
    centred = turn.apply(found.copy())
    # The box of the turned shape has another centre and diagonal.
    centred = (centred - centred.mean(axis=0)) / np.linalg.norm(centred.std(axis=0))
    turned = (turned - turned.mean(axis=0)) / np.linalg.norm(turned.std(axis=0))
    np.testing.assert_allclose(centred, turned, atol=1e-6)


def test_repeated_vertices_do_not_matter(make):
    mesh = make.worm(waved)
    whole, loose = (places(make.shape(m), landmarks=80) for m in (mesh, make.soup(mesh)))
    np.testing.assert_array_equal(whole[mesh[1]].reshape(-1, 3), loose)


def test_the_same_bytes_again(make):
    shape = make.shape(make.blob(1))
    assert places(shape).tobytes() == places(shape).tobytes()


_PROGRAM = """
import hashlib, moseg_core as moseg
from moseg_mds.embedding import MDS
shape = moseg.load(moseg.sample_path("hammer"))
found = MDS(landmarks=30).embed(shape).shape.geometry.vertices
print(hashlib.sha256(found.tobytes()).hexdigest())
"""


@pytest.mark.slow
def test_the_same_bytes_in_another_process():
    digests = {
        subprocess.run(
            [sys.executable, "-c", _PROGRAM],
            env={**os.environ, "PYTHONHASHSEED": seed},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(digests) == 1


@pytest.mark.parametrize("method", ["exact", "heat", "graph"])
def test_the_methods_embed_alike(make, method):
    vertices, faces = make.ball(3)
    shape = make.shape((vertices * [1.0, 0.8, 0.5], faces))
    expected = make.apart(places(shape, geodesics="exact", landmarks=40))
    found = MDS(geodesics=method, landmarks=40).embed(shape)
    assert found.method == method
    assert ratio(make.apart(found.shape.geometry.vertices), expected) < 0.1


def test_long_distances_are_those_along_the_surface(make):
    mesh = make.worm(curled)
    table = geodesic_distances(*mesh, range(0, len(mesh[0]), 40))
    found = make.apart(places(make.shape(mesh)))[::40]
    assert ratio(found, table) < 0.02


def test_polygons_are_embedded_as_they_are():
    steps = np.arange(9.0)
    x = np.minimum(steps, 4)
    z = np.maximum(steps - 4, 0)
    vertices = np.concatenate([np.c_[x, 0 * x, z], np.c_[x, 0 * x + 1, z]])
    quads = [[k, k + 1, k + 10, k + 9] for k in range(8)]
    found = MDS()(Shape.from_mesh(vertices, quads))
    assert found.n_elements == 8
    lengths = np.linalg.norm(found.points[1:] - found.points[:-1], axis=1)
    np.testing.assert_allclose(lengths / lengths.mean(), 1, atol=0.05)


@pytest.mark.parametrize(
    "mesh",
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]]),
        (
            [[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1]],
            [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
        ),
        ([[0, 0, 0], [2, 0, 0], [1, 1, 0], [1, 0, 0]], [[0, 3, 2], [3, 1, 2], [0, 1, 3]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1e-9]], [[0, 1, 2], [1, 3, 2], [2, 2, 2]]),
    ],
    ids=["one triangle", "a stray vertex", "three pages", "no area", "a point"],
)
def test_the_least_shapes(mesh):
    shape = Shape.from_mesh(*mesh)
    found = MDS(landmarks=60)(shape)
    assert found.frame.scale == pytest.approx(1, abs=1e-12)
    assert np.isfinite(found.geometry.vertices).all()


def test_an_embedded_shape_has_a_cost(make):
    shape = make.shape(make.worm(curled))
    labels = (shape.points @ np.ones(3) > np.median(shape.points @ np.ones(3))).astype(int)
    problem = Problem(["a", "b"], "narrow(a) + narrow(b)")
    assert problem.evaluate(MDS(landmarks=60)(shape), labels).cost.value > 0


def test_several_pieces_are_refused(make):
    vertices, faces = make.ball(1)
    two = np.concatenate([vertices, vertices + 5.0]), np.concatenate([faces, faces + len(vertices)])
    with pytest.raises(ShapeError, match="2 pieces"):
        MDS()(make.shape(two))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"geodesics": "euclid"}, "auto, exact, heat, graph"),
        ({"landmarks": 3}, "landmarks is 3; allowed is 4 to 2000"),
        ({"refine": -1}, "refine is -1"),
        ({"exponent": 9.0}, "exponent is 9; allowed is 0 to 4"),
    ],
)
def test_parameters_out_of_bounds(parameters, message):
    with pytest.raises(UsageError, match=message):
        MDS(**parameters)


OCTOPUS = Path(os.environ.get("MOSEG_PSB", "")) / "off" / "121.off"


@pytest.mark.slow
@pytest.mark.skipif(not OCTOPUS.is_file(), reason="MOSEG_PSB names no Princeton benchmark")
def test_the_arms_of_an_octopus_spread_like_a_star(make):
    shape = moseg.load(OCTOPUS)
    embedded = MDS().embed(shape)
    assert embedded.stress < 0.13
    vertices, faces = shape.geometry.vertices, shape.geometry.triangles
    body = int(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1).argmin())
    tips: list[int] = []
    near = geodesic_distances(vertices, faces, [body])[0]
    for _ in range(8):
        tips.append(int(near.argmax()))
        near = np.minimum(near, geodesic_distances(vertices, faces, [tips[-1]])[0])
    along = geodesic_distances(vertices, faces, tips)[:, tips]
    apart = make.apart(embedded.shape.geometry.vertices[tips])
    pairs = np.triu_indices(8, 1)
    share, original = (d[pairs] / along[pairs] for d in (apart, make.apart(vertices[tips])))
    assert share.min() > 0.4 * share.max()
    assert share.min() / share.max() > 1.2 * original.min() / original.max()
