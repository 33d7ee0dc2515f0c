"""One file for each part: which files, how they are called, closed or as hulls, what is said."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

import moseg_core
from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.files import save
from moseg_core.io.part_files import (
    PartForm,
    check_part_files,
    is_for_parts,
    part_files,
    part_meshes,
    part_paths,
)
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.results import area, result_on


def named(shape, labels, *names):
    problem = Problem(list(names), f"area({names[0]})", objectives={"area": area})
    return replace(result_on(shape), problem=problem, labels=np.array(labels, np.int32))


def solid_of(data, suffix="stl"):
    return trimesh.load(io.BytesIO(data), file_type=suffix, force="mesh")


@pytest.fixture
def halves(box):
    """A box of 3 x 2 x 1 cut across."""
    labels = (box.points[:, 0] > 2.0).astype(np.int32)
    return named(box, labels, "long", "short")


def test_each_part_has_a_file_in_a_folder_that_is_made(halves, tmp_path):
    save(halves, tmp_path / "parts" / "{part}.obj")
    assert sorted(path.name for path in (tmp_path / "parts").iterdir()) == ["long.obj", "short.obj"]
    long, short = (moseg_core.load(tmp_path / "parts" / f"{n}.obj") for n in ("long", "short"))
    # Quads stay quads, and all of them are there.
    assert long.n_elements + short.n_elements == 22
    assert long.volume_source is None
    save(halves, tmp_path / "parts" / "{part}.obj", close=True)
    assert moseg_core.load(tmp_path / "parts" / "short.obj").volume == pytest.approx(2.0)


@pytest.mark.parametrize("suffix", [".stl", ".obj"])
def test_closed_parts_are_solids(halves, suffix):
    files, notes = part_files(halves, Path(f"{{part}}{suffix}"), PartForm(close=True))
    assert notes == []
    for name, volume in (("long", 4.0), ("short", 2.0)):
        found = solid_of(files[Path(f"{name}{suffix}")], suffix[1:])
        assert found.is_watertight
        assert found.volume == pytest.approx(volume)


def test_a_clipped_result_is_cut_across_its_faces():
    vertices, faces = shapes.box(4, 1, 1)
    shape = Shape.from_mesh(vertices, faces)
    result = named(shape, shape.points[:, 0] > 2.0, "a", "b")
    # Two centres whose bisector is at 1.7, between the edges.
    mesh = moseg_core.clip_boundaries(
        shape.geometry,
        result.labels,
        shape.points,
        np.array([[0.7, 0.5, 0.5], [2.7, 0.5, 0.5]]),
        np.ones(2),
    )
    clipped = replace(result, clipped=mesh)
    volumes = {part.label: part.geometry for part in part_meshes(clipped, close=True)}
    found = solid_of(
        part_files(clipped, Path("{part}.stl"), PartForm(close=True))[0][Path("a.stl")]
    )
    assert found.is_watertight
    assert found.volume == pytest.approx(1.7)
    assert set(volumes) == {"a", "b"}


def test_hulls_hold_their_parts_and_say_what_few_vertices_miss():
    shape = Shape.from_mesh(*shapes.sphere(2), name="ball")
    result = named(shape, shape.points[:, 2] > 0, "low", "high")
    files, notes = part_files(result, Path("{part}.stl"), PartForm(hulls=True))
    assert notes == []
    for data in files.values():
        hull = solid_of(data)
        assert hull.is_watertight
        assert hull.is_convex
        assert hull.volume == pytest.approx(2 / 3 * np.pi, rel=0.2)
    form = PartForm(hulls=True, hull_vertices=12)
    files, (note,) = part_files(result, Path("{part}.stl"), form)
    assert all(len(solid_of(data).vertices) == 12 for data in files.values())
    assert note.startswith("hulls of at most 12 vertices: parts stick out by 0.")


def test_cells_of_a_solid_are_closed_where_they_were_cut():
    bar = Shape.from_voxels(np.ones((5, 3, 3), bool), pitch=2.0)
    result = named(bar, bar.points[:, 0] > 4.0, "left", "right")
    open_one, _ = part_files(result, Path("{part}.stl"), PartForm())
    assert not solid_of(open_one[Path("left.stl")]).is_watertight
    closed, notes = part_files(result, Path("{part}.stl"), PartForm(close=True))
    assert notes == []
    assert solid_of(closed[Path("left.stl")]).volume == pytest.approx(2 * 9 * 8)
    inner = named(bar, np.abs(bar.points - [5, 3, 3]).max(axis=1) < 1.5, "rind", "core")
    files, notes = part_files(inner, Path("{part}.stl"), PartForm())
    assert list(files) == [Path("rind.stl")]
    assert notes[0].startswith("part 'core' lies within the solid")
    files, notes = part_files(inner, Path("{part}.stl"), PartForm(close=True))
    assert solid_of(files[Path("core.stl")]).volume == pytest.approx(8.0)


def test_oblique_cells_are_cut_along_their_sides():
    steps = [[1.0, 0, 0], [0.2, 1.0, 0], [0.3, -0.1, 2.0]]
    bar = Shape.from_voxels(np.ones((5, 3, 3), bool), pitch=steps)
    result = named(bar, bar.geometry.cells[:, 0] > 1, "left", "right")
    closed, _ = part_files(result, Path("{part}.stl"), PartForm(close=True))
    solid = solid_of(closed[Path("left.stl")])
    assert solid.volume == pytest.approx(2 * 9 * np.linalg.det(steps), rel=1e-5)


def test_what_cannot_be_closed_is_written_and_named(tmp_path):
    book = Shape.from_mesh(*shapes.joined(shapes.book(3), shapes.box()))
    result = named(book, [0] * 3 + [1] * 6, "book", "box")
    with pytest.warns(UserWarning, match="part 'book' is no closed solid: .* of its edges have"):
        save(result, tmp_path / "{part}.stl", close=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["book.stl", "box.stl"]
    assert [part.closed for part in part_meshes(result, close=True)] == [False, True]


def test_flat_and_empty_parts(row):
    result = named(row, [0] * 6, "sheet", "nothing")
    files, notes = part_files(result, Path("{part}.stl"), PartForm(hulls=True))
    assert list(files) == [Path("sheet.stl")]
    assert "part 'sheet' is flat" in notes[0]
    assert notes[1] == "part 'nothing' is empty, and has no file"
    assert solid_of(files[Path("sheet.stl")]).volume > 0


def test_clouds_have_points_and_hulls():
    cloud = Shape.from_points(shapes.sphere(2)[0], name="dots")
    result = named(cloud, cloud.points[:, 0] > 0, "a", "b")
    with pytest.raises(ShapeError, match=r"'dots' is a point cloud: .* '\.stl'; .* \.ply, \.glb"):
        part_files(result, Path("{part}.stl"), PartForm())
    with pytest.raises(ShapeError, match="no surface that could be closed; ask for hulls"):
        part_meshes(result, close=True)
    files, _ = part_files(result, Path("{part}.ply"), PartForm())
    assert len(trimesh.load(io.BytesIO(files[Path("a.ply")]), file_type="ply").vertices) > 50
    files, _ = part_files(result, Path("{part}.stl"), PartForm(hulls=True))
    assert solid_of(files[Path("a.stl")]).is_watertight


def test_far_from_the_origin_it_is_said_that_stl_loses(box):
    far = Shape.from_mesh(box.geometry.vertices + 1e6, shapes.box(3, 2, 1)[1])
    result = named(far, [0] * 11 + [1] * 11, "a", "b")
    _, (note,) = part_files(result, Path("{part}.stl"), PartForm())
    assert note.startswith("'a', 'b': far from the origin, where .stl holds places 0.06 apart")
    assert part_files(result, Path("{part}.obj"), PartForm())[1] == []


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("parts/{parts}.stl", r"unknown name in braces 'parts'; did you mean 'part'\?"),
        ("parts/{Part}.stl", r"did you mean 'part'\?"),
        ("parts/{}.stl", "known: part"),
        ("parts/{part.stl", "braces stand around 'part' only"),
        ("parts/{{part}}.stl", "braces stand around 'part' only"),
        ("{part}/mesh.stl", "in the name of the file, not of a folder"),
    ],
)
def test_a_slip_in_the_braces_is_told(path, says):
    with pytest.raises(UsageError, match=says):
        is_for_parts(Path(path))


def test_a_path_is_checked_before_the_search(tmp_path):
    check_part_files(tmp_path / "new" / "{part}.STL")
    with pytest.raises(UsageError, match=r"per part as '\.json'; formats: \.stl, \.obj, \.ply"):
        check_part_files(tmp_path / "{part}.v2.json")
    with pytest.raises(UsageError, match=r"per part as '\.nii\.gz'; formats"):
        check_part_files(tmp_path / "{part}.v2.nii.gz")
    with pytest.raises(UsageError, match="without a suffix"):
        check_part_files(tmp_path / "{part}")
    with pytest.raises(UsageError, match=r"there is no folder '.*new'"):
        check_part_files(tmp_path / "new" / "newer" / "{part}.stl")
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match="is no folder"):
        check_part_files(tmp_path / "file" / "{part}.stl")


def test_forms_that_make_no_sense(halves, tmp_path):
    with pytest.raises(UsageError, match="ask for one"):
        PartForm(close=True, hulls=True)
    for name in ("{part}.stl", "x.obj"):
        with pytest.raises(UsageError, match="no hulls are asked for"):
            save(halves, tmp_path / name, hull_vertices=8)
    with pytest.raises(UsageError, match="4 vertices or more, not 3"):
        PartForm(hulls=True, hull_vertices=3)
    with pytest.raises(UsageError, match="'close' is about files of single parts"):
        save(halves, tmp_path / "x.json", close=True)


def test_hostile_labels_stay_in_the_folder():
    labels = ["../../x", "con", "a/b", "A-B", "a" * 10_000, "\u202e<b>\n"]
    paths = part_paths(Path("out/x-{part}.stl"), labels)
    assert {path.parent for path in paths} == {Path("out")}
    assert [path.name for path in paths][:4] == [
        "x-x.stl", "x-_con.stl", "x-a-b-2.stl", "x-A-B.stl"
    ]  # fmt: skip
    assert all(len(path.name) < 120 for path in paths)
