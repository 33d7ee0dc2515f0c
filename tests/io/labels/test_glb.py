"""Nodes, meshes and materials of GLB files."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.labels.glb import read_glb_labels
from moseg_core.io.labels.listing import Wanted
from moseg_core.io.read.glb_scene import read_glb
from tests.io.read.glb_files import TETRAHEDRON, glb, pack


@pytest.fixture
def read(as_file):
    """Labels of two meshes, each shown by a node, with names as given."""

    def read(nodes=(None, None), meshes=(None, None), materials=(None, None), properties=()):
        listed = [{"mesh": k} | ({"name": name} if name else {}) for k, name in enumerate(nodes)]
        document, binary = glb([[TETRAHEDRON]] * 2, listed)
        document["materials"] = [{"name": name} if name else {} for name in materials]
        for k, name in enumerate(meshes):
            document["meshes"][k]["primitives"][0]["material"] = k
            if name:
                document["meshes"][k]["name"] = name
        path = as_file("x.glb", pack(document, binary))
        return read_glb_labels(path, Wanted(n_elements=8, properties=properties)), path

    return read


def test_nodes_are_named_labels_where_they_stand(read):
    found, path = read(nodes=("leg", "upper arm"), meshes=("a", "b"))
    assert (found.labels.tolist(), found.names) == ([0] * 4 + [1] * 4, ("leg", "upper arm"))
    assert found.notes == ()
    mesh = read_glb(path).geometry
    np.testing.assert_allclose(found.places, mesh.vertices[mesh.triangles].mean(axis=1))


def test_nodes_of_one_name_are_one_label(read):
    assert read(nodes=("leg", "leg"))[0].names == ("leg",)


def test_a_node_without_a_name_is_called_after_its_mesh(read):
    assert read(nodes=("leg", None), meshes=("a", "b"))[0].names == ("leg", "b")


def test_what_tells_triangles_apart_is_taken(read):
    found, _ = read(nodes=("whole", "whole"), materials=("red", "blue"))
    assert found.names == ("red", "blue")
    assert found.notes == ("x.glb: labels are its 2 materials",)
    assert read(materials=("red", "blue"))[0].names == ("red", "blue")


@pytest.mark.parametrize(
    ("asked", "names"),
    [("node", ("n", "o")), ("meshes", ("a", "b")), ("Material", ("red", "blue"))],
)
def test_the_kind_may_be_asked_for(asked, names, read):
    found, _ = read(("n", "o"), ("a", "b"), ("red", "blue"), properties=(asked,))
    assert found.names == names


def test_one_node_without_any_name_is_called_by_its_number(read):
    found, _ = read(nodes=("leg", None))
    assert found.names == ("leg", "node 1")
    assert found.notes == ("x.glb has nodes without a name, called by their numbers",)


def test_a_scene_without_names_is_refused(refusal):
    document, binary = glb([[TETRAHEDRON]], [{"mesh": 0}])
    message = refusal(
        lambda path: read_glb_labels(path, Wanted(n_elements=4)), "x.glb", pack(document, binary)
    )
    assert message.startswith(" has a part without a name; name its nodes, meshes or materials")
