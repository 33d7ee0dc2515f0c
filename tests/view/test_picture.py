"""What is on the picture: both sides, the parts' colours, light, lines and the legend."""

from __future__ import annotations

import io

import numpy as np
import pytest
import trimesh
from PIL import Image
from scipy.spatial.transform import Rotation

from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.view.palette import linear_light, part_colors
from moseg_core.view.picture import render_picture

SIZE = (480, 240)


def polygons(mesh):
    return PolygonMesh.from_faces(np.array(mesh.vertices), np.array(mesh.faces))


def cone():
    """A lopsided solid: no two of its views are alike."""
    mesh = trimesh.creation.cone(radius=1, height=4, sections=40).subdivide_to_size(0.4)
    mesh.vertices *= [1, 0.6, 1]
    return polygons(mesh)


def halves(mesh):
    """The lower and the upper part of a mesh."""
    heights = mesh.vertices[mesh.triangles].mean(axis=1)[:, 2]
    return (heights > 1.3).astype(int)


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def draw(mesh, labels, names=("low", "high"), **options):
    return pixels(render_picture(mesh, labels, list(names), **{"size": SIZE, **options}))


def hue(color):
    """Direction of a color in linear light, which shading leaves alone."""
    light = linear_light(np.asarray(color, np.uint8))
    return light / np.maximum(np.linalg.norm(light, axis=-1, keepdims=True), 1e-9)


def area_of(picture, part, count):
    """How many pixels have the hue of a part."""
    return int((hue(picture) @ hue(part_colors(count)[part]) > 0.999).sum())


def test_a_picture_is_a_png_of_the_size_asked_for():
    png = render_picture(cone(), np.zeros(len(cone().triangles), int), ["all"], size=(333, 210))
    with Image.open(io.BytesIO(png)) as image:
        assert image.format == "PNG"
        assert image.size == (333, 210)


def test_equal_input_gives_equal_bytes():
    pictures = [
        render_picture(cone(), halves(cone()), ["low", "high"], title="cone", size=SIZE)
        for _ in range(2)
    ]
    assert pictures[0] == pictures[1]


def test_both_sides_are_drawn_in_the_colors_of_the_parts():
    picture = draw(cone(), halves(cone()))
    for half in (picture[:, : SIZE[0] // 2], picture[:, SIZE[0] // 2 :]):
        for part in (0, 1):
            assert area_of(half[:200], part, 2) > 800
    assert (picture[0] == 255).all()
    assert (picture[:, 0] == 255).all()


def test_what_is_behind_on_one_side_is_in_front_on_the_other():
    plate = polygons(trimesh.creation.box([4, 3, 0.2]).subdivide())
    front = (plate.vertices[plate.triangles].mean(axis=1)[:, 2] > 0.09).astype(int)
    back = (plate.vertices[plate.triangles].mean(axis=1)[:, 2] < -0.09).astype(int) * 2
    picture = draw(plate, front + back, ["rim", "front", "back"])
    sides = [picture[:200, :240], picture[:200, 240:]]
    seen = [[area_of(side, part, 3) > 3000 for part in (1, 2)] for side in sides]
    assert sorted(seen) == [[False, True], [True, False]]


def test_a_turned_shape_gives_nearly_the_same_picture():
    mesh = cone()
    turn = Rotation.random(random_state=4).as_matrix()
    turned = PolygonMesh.from_faces(mesh.vertices @ turn.T * 30 + 7, mesh.triangles)
    difference = np.abs(draw(mesh, halves(mesh)) - draw(turned, halves(mesh)))
    assert difference.mean() < 0.5


def test_winding_does_not_matter():
    mesh = cone()
    turned = PolygonMesh.from_faces(mesh.vertices, mesh.triangles[:, ::-1])
    difference = np.abs(draw(mesh, halves(mesh)) - draw(turned, halves(mesh)))
    assert difference.max() <= 3


def test_light_comes_from_above():
    ball = polygons(trimesh.creation.icosphere(subdivisions=4))
    picture = draw(ball, np.zeros(len(ball.triangles), int), ["ball"])[:, :240].sum(axis=2)
    inside = np.argwhere(picture < 700)
    top, bottom = inside[:, 0].min(), inside[inside[:, 0] < 200, 0].max()
    column = 120
    assert picture[top + 12, column] > picture[(top + bottom) // 2, column] * 0.9
    assert picture[bottom - 12, column] < 0.7 * picture[top + 12, column]


def test_a_smooth_surface_is_shaded_smoothly():
    ball = polygons(trimesh.creation.icosphere(subdivisions=2))
    picture = draw(ball, np.zeros(len(ball.triangles), int), ["ball"], size=(800, 400))
    row = picture[150, 130:270].sum(axis=1)
    # Flat shading of so few faces would step by more than 20 from pixel to pixel.
    assert row.min() < 600
    assert np.abs(np.diff(row)).max() <= 8


def test_a_line_is_drawn_where_parts_meet():
    mesh = cone()
    one = draw(mesh, np.zeros(len(mesh.triangles), int))
    two = draw(mesh, halves(mesh))
    darker = two[:190].sum(axis=2) < 0.5 * one[:190].sum(axis=2)
    for half in (darker[:, :240], darker[:, 240:]):
        rows, columns = np.nonzero(half)
        # About as long as the solid is wide, and one or two pixels thick.
        assert len(rows) > 20
        assert len(rows) < 3.5 * max(np.ptp(rows), np.ptp(columns))


def test_an_absent_part_is_greyed_and_named():
    mesh = cone()
    labels = halves(mesh)
    picture = draw(mesh, labels, ["low", "high", "nowhere"])
    assert not (picture == part_colors(3)[2]).all(axis=2).any()
    assert (picture[200:] == 176).all(axis=2).sum() > 20
    swatches = [(picture[200:] == color).all(axis=2).sum() for color in part_colors(2)]
    assert min(swatches) > 80


def test_legend_gives_shares_of_the_area(monkeypatch):
    shares = []
    monkeypatch.setattr(
        "moseg_core.view.picture.draw_legend",
        lambda draw, entries, colors, *, size, pad: shares.extend(entries) or size[1],
    )
    # Areas 8, 1/2 and 0.03, in one quad and two triangles, whatever their number of faces.
    mesh = PolygonMesh.from_faces(
        [[0, 0, 0], [4, 0, 0], [4, 2, 0], [0, 2, 0], [-1, 0, 0], [0, 1, 0], [-0.06, 0, 0]],
        [[0, 1, 2, 3], [0, 5, 4], [0, 5, 6]],
    )
    render_picture(mesh, [0, 1, 2], ["quad", "small", "tiny", "none"], size=SIZE)
    assert [entry.share for entry in shares] == ["94 %", "6 %", "<1 %", "0 %"]
    assert [entry.absent for entry in shares] == [False, False, False, True]
    assert [entry.name for entry in shares] == ["quad", "small", "tiny", "none"]


def test_the_title_is_written_at_the_top_left():
    mesh = cone()
    without = draw(mesh, halves(mesh), up="x")
    titled = draw(mesh, halves(mesh), title="a cone", up="x")
    assert (without[:24] == 255).all()
    assert (titled[:24, :120] < 100).any()
    assert (titled[:24, 120:] == 255).all()


@pytest.mark.parametrize("size", [(239, 300), (300, 159), (4001, 700), (700, 2001)])
def test_sizes_that_are_refused(size):
    with pytest.raises(UsageError, match="allowed are 240 x 160 to 4000 x 2000"):
        draw(cone(), halves(cone()), size=size)


def test_labels_that_are_refused():
    with pytest.raises(ShapeError, match="one label for each of the"):
        draw(cone(), [0])
    with pytest.raises(ShapeError, match="has the label 1; allowed are 0 to 0"):
        draw(cone(), halves(cone()), ["low"])


@pytest.mark.parametrize(
    "vertices",
    [
        pytest.param([[0, 0, 0], [1, 0, 0], [0, 2, 0]], id="flat"),
        pytest.param([[0, 0, 0], [1, 1, 1], [2, 2, 2]], id="a line"),
        pytest.param([[3, 3, 3]] * 3, id="a point"),
        pytest.param([[1e200, 0, 0], [0, 1e200, 0], [0, 0, 1e200]], id="huge"),
        pytest.param([[1e-200, 0, 0], [0, 1e-200, 0], [0, 0, 1e-200]], id="tiny"),
    ],
)
def test_odd_shapes_are_drawn(vertices):
    picture = draw(PolygonMesh.from_faces(vertices, [[0, 1, 2]]), [0], ["all"])
    empty = vertices[0] == vertices[1] or vertices[1] == [1, 1, 1]
    assert (area_of(picture[:190], 0, 1) > 1000) == (not empty)


def test_large_pictures_are_drawn_too():
    # Above two million pixels there are fewer samples for each.
    picture = draw(cone(), halves(cone()), size=(2000, 1100))
    assert picture.shape == (1100, 2000, 3)
    assert area_of(picture, 0, 2) > 50_000


def test_hollows_are_darker_on_the_picture(monkeypatch):
    plate = trimesh.creation.box([6, 5, 0.5])
    rod = trimesh.creation.box([0.4, 0.4, 2]).apply_translation([0, 0, -1.2])
    mesh = polygons(trimesh.util.concatenate([plate, rod]))
    labels = np.zeros(mesh.n_polygons, int)
    with_hollows = draw(mesh, labels)
    monkeypatch.setattr(
        "moseg_core.view.shading._hollows",
        lambda depth, shown, samples: np.ones(depth.shape, np.float32),
    )
    without = draw(mesh, labels)
    assert (with_hollows <= without).all()
    assert (without.sum(axis=2) - with_hollows.sum(axis=2) > 30).sum() > 50
