"""The data of a page: what is said of parts and terms, and what is drawn."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from moseg_core.clipping.clip import Clipped
from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.problem.aggregate import CallValue, Evaluation, TermValue
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.view.page.content import PageContent
from moseg_core.view.page.document import page_document
from tests import shapes
from tests.results import result_on


def term(text, weight, *calls):
    return TermValue(text=text, objective="x:y", weight=weight, calls=calls, worst=1.0)


def call(labels, value, *details):
    return CallValue(labels=labels, value=value, details=details)


EVALUATION = Evaluation(
    cost=Cost(0, 6.5),
    terms=(
        term("narrow(*)", 2.0, call(("first",), 0.5), call(("second",), 1.5)),
        term("apart(first, second)", 1.0, call(("first", "second"), 3.0)),
        term("convex_parts", -1.0, call((), 0.5)),
    ),
)


def content(shape, **more):
    labels = (np.arange(shape.n_elements) >= 4).astype(np.int64)
    return PageContent(shape=shape, labels=labels, names=("first", "second"), **more)


def numbers(packed):
    return np.frombuffer(base64.b64decode(packed["data"]), f"<{packed['type']}")


def test_parts_have_their_size_in_the_units_of_the_shape(box):
    document = page_document(content(box))
    first, second = document["parts"]
    assert (first["elements"], first["area"]) == (4, 4.0)
    assert first["share"] == pytest.approx(4 / 22)
    assert (document["total"], document["noun"], document["measure"]) == (22.0, "face", "area")
    assert document["order"] == [1, 0]  # larger first
    assert second["cost"] is None
    assert document["cost"] is None


def test_parts_are_listed_worst_first_with_their_terms_worst_first(box):
    document = page_document(content(box, evaluation=EVALUATION))
    first, second = document["parts"]
    # Of a term about two parts each bears half.
    assert (first["cost"], second["cost"]) == (1.0 + 1.5, 3.0 + 1.5)
    assert document["order"] == [1, 0]
    assert [(t["name"], t["cost"], t["others"]) for t in first["terms"]] == [
        ("apart", 3.0, ["second"]),
        ("narrow", 1.0, []),
    ]
    assert [t["text"] for t in document["terms"]] == [
        "narrow(*)",
        "apart(first, second)",
        "convex_parts",
    ]
    assert document["terms"][-1]["cost"] == -0.5


def test_what_disagrees_most_is_told(box):
    detail = Detail(name="thickness", value=0.09, cost=2.0, percent=True)
    told = Evaluation(cost=Cost(0, 2.0), terms=(term("is(*)", 1.0, call(("first",), 2.0, detail)),))
    first, second = page_document(content(box, evaluation=told))["parts"]
    assert first["detail"] == "thickness 9 %"
    assert second["detail"] is None


def test_terms_that_were_left_out_have_no_cost(box):
    evaluation = Evaluation(
        cost=Cost(1, 0.0), terms=(term("narrow(*)", 1.0, call(("first",), None)),)
    )
    first = page_document(content(box, evaluation=evaluation))["parts"][0]
    assert (first["terms"][0]["value"], first["terms"][0]["cost"]) == (None, None)


def test_what_has_no_label_is_a_part_of_its_own(box):
    labels = np.array([-1] * 2 + [1] * 20)
    document = page_document(PageContent(shape=box, labels=labels, names=("first", "second")))
    assert [part["name"] for part in document["parts"]] == ["first", "second", "unlabelled"]
    assert document["order"] == [1, 0, 2]
    assert document["parts"][2]["area"] == 2.0
    assert sorted(set(numbers(document["geometry"]["labels"]))) == [1, 2]


def test_polygons_are_drawn_as_triangles_that_know_their_elements(box):
    geometry = page_document(content(box))["geometry"]
    assert len(numbers(geometry["triangles"])) == 3 * 44
    assert numbers(geometry["elements"]).tolist() == [k // 2 for k in range(44)]
    assert numbers(geometry["labels"]).tolist() == [0] * 8 + [1] * 36


def test_pieces_of_a_clipped_result_are_drawn_and_areas_are_the_shapes(box):
    pieces = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    clipped = Clipped(mesh=pieces, labels=np.array([1]), source=np.array([5]))
    document = page_document(PageContent.of_result(result_on(box, clipped=clipped)))
    assert numbers(document["geometry"]["elements"]).tolist() == [5]
    assert document["total"] == 22.0


def test_clouds_are_drawn_as_points():
    cloud = Shape.from_points(np.random.default_rng(0).random((30, 3)))
    document = page_document(content(cloud))
    assert "triangles" not in document["geometry"]
    assert len(numbers(document["geometry"]["labels"])) == 30
    assert document["geometry"]["point_size"] > 0


def test_cells_are_drawn_by_their_exposed_faces():
    grid = Shape.from_voxels(np.ones((3, 3, 3), bool))
    document = page_document(content(grid))
    assert (document["measure"], document["noun"]) == ("volume", "cell")
    assert len(numbers(document["geometry"]["triangles"])) == 3 * 2 * 54
    assert max(numbers(document["geometry"]["elements"])) == 26


def test_the_shape_stands_as_it_is_known_to(box):
    view = page_document(content(box.with_up("-x")))["view"]
    assert (view["up"], view["said"]) == ([-1.0, 0.0, 0.0], "up: -x")
    assert page_document(content(box))["view"]["said"].endswith(", guessed")


def test_a_thinned_mesh_says_both_numbers_and_what_is_too_small():
    shape = Shape.from_mesh(*shapes.rectangle(10.0, 10.0, 60, 60))
    labels = np.zeros(shape.n_elements, np.int64)
    labels[:1] = 1
    document = page_document(
        PageContent(shape=shape, labels=labels, names=("sheet", "speck")), most_triangles=400
    )
    drawn = len(numbers(document["geometry"]["triangles"])) // 3
    assert 200 < drawn <= 400
    assert document["notes"] == [
        f"The page draws {drawn} of 7,200 triangles, so that it turns smoothly; areas and costs are"
        " those of all.",
        "Too small to be seen among them: speck.",
    ]
    assert document["parts"][1]["elements"] == 1
