"""The bundle ``core``: what moseg brings itself, through the same hooks as everyone else."""

from __future__ import annotations

from dataclasses import replace

from moseg_core.components.discovery.hookspecs import hookimpl
from moseg_core.components.discovery.specs import (
    LabelerSpec,
    OptimizerSpec,
    ParameterizationSpec,
    ReaderSpec,
    RefinerSpec,
    SeederSpec,
    WriterSpec,
)

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_parameterizations() -> list[ParameterizationSpec]:
    """Weighted Voronoi partitions."""
    return [
        ParameterizationSpec(
            name="voronoi",
            target="moseg_core.builtin.voronoi:Voronoi",
            summary="multiplicatively weighted Voronoi partition, segments kept connected",
            label_parameters=("centers",),
        )
    ]


@hookimpl
def moseg_seeders() -> list[SeederSpec]:
    """Evolution, k-means, and the user's own centres."""
    return [
        SeederSpec(
            name="kmeans",
            target="moseg_core.builtin.kmeans:KMeans",
            summary="k-means from furthest points; compact parts of similar size",
        ),
        SeederSpec(
            name="evolution",
            target="moseg_core.builtin.evolution:Evolution",
            summary="evolutionary search over sets of elements, by the whole cost",
        ),
        SeederSpec(
            name="sized_evolution",
            target="moseg_core.builtin.sized_evolution:SizedEvolution",
            summary="evolution of labelled places and sizes; finds small parts",
        ),
        SeederSpec(
            name="given",
            target="moseg_core.builtin.given:Given",
            summary="centres placed by hand: label=x,y,z,label=x,y,z",
            takes_centers=True,
        ),
    ]


@hookimpl
def moseg_labelers() -> list[LabelerSpec]:
    """The Hungarian algorithm, greedy and exhaustive assignment."""
    return [
        LabelerSpec(
            name="hungarian",
            target="moseg_core.builtin.hungarian:Hungarian",
            summary="the assignment of labels that is optimal for the unary objectives",
        ),
        LabelerSpec(
            name="greedy",
            target="moseg_core.builtin.greedy:Greedy",
            summary="one label after the other, in an order that may be given",
        ),
        LabelerSpec(
            name="exhaustive",
            target="moseg_core.builtin.exhaustive:Exhaustive",
            summary="the best of all assignments under the whole cost; up to 8 labels",
        ),
    ]


@hookimpl
def moseg_optimizers() -> list[OptimizerSpec]:
    """Pattern search."""
    return [
        OptimizerSpec(
            name="pattern_search",
            target="moseg_core.builtin.pattern_search:PatternSearch",
            summary="generalized pattern search with complete polls",
        )
    ]


@hookimpl
def moseg_refiners() -> list[RefinerSpec]:
    """The least cut in a band."""
    return [
        RefinerSpec(
            name="graph_cut",
            target="moseg_core.builtin.graph_cut:GraphCut",
            summary="the least cut in a band around the boundaries, along creases if there are any",
        )
    ]


@hookimpl
def moseg_readers() -> list[ReaderSpec]:
    """Polygon meshes, point clouds, voxel grids."""
    readers = [
        ReaderSpec(name="off", target="moseg_core.io.read.off:read_off", suffixes=(".off",)),
        ReaderSpec(name="ply", target="moseg_core.io.read.ply:read_ply", suffixes=(".ply",)),
        ReaderSpec(name="obj", target="moseg_core.io.read.obj:read_obj", suffixes=(".obj",)),
        ReaderSpec(name="stl", target="moseg_core.io.read.stl:read_stl", suffixes=(".stl",)),
        ReaderSpec(
            name="glb",
            target="moseg_core.io.read.glb_scene:read_glb",
            suffixes=(".glb", ".gltf"),
        ),
        ReaderSpec(
            name="xyz",
            target="moseg_core.io.read.clouds:read_points",
            suffixes=(".xyz", ".pts", ".asc", ".txt", ".csv"),
        ),
        ReaderSpec(name="npy", target="moseg_core.io.read.grids:read_npy", suffixes=(".npy",)),
        ReaderSpec(
            name="binvox", target="moseg_core.io.read.grids:read_binvox", suffixes=(".binvox",)
        ),
    ]
    example = "moseg_core.io.read.examples:example"
    return [replace(reader, example=example) for reader in readers]


@hookimpl
def moseg_writers() -> list[WriterSpec]:
    """Everything that a result can be saved as."""
    module = "moseg_core.io.write.formats"
    return [
        WriterSpec(
            name="json",
            target="moseg_core.io.result_json:write_json",
            suffixes=(".json",),
            summary="labels, cost by term, centres, history, versions",
        ),
        WriterSpec(
            name="seg",
            target=f"{module}:write_seg",
            suffixes=(".seg",),
            summary="one label number a line, element by element",
        ),
        WriterSpec(
            name="ply",
            target=f"{module}:write_ply",
            suffixes=(".ply",),
            summary="the mesh or points with colour and label of every element",
        ),
        WriterSpec(
            name="obj",
            target=f"{module}:write_obj",
            suffixes=(".obj",),
            summary="the polygons as one named object for each part, with materials beside it",
        ),
        WriterSpec(
            name="vtu",
            target=f"{module}:write_vtu",
            suffixes=(".vtu",),
            summary="an unstructured grid of VTK: cells with label and area",
        ),
        WriterSpec(
            name="threemf",
            target="moseg_core.io.solid_files:write_3mf",
            suffixes=(".3mf",),
            summary="one closed, coloured solid for each part, for printing",
        ),
        WriterSpec(
            name="npz",
            target=f"{module}:write_npz",
            suffixes=(".npz",),
            summary="arrays for numpy: labels, names, points, areas",
        ),
        WriterSpec(
            name="npy",
            target=f"{module}:write_npy",
            suffixes=(".npy",),
            summary="a voxel grid with the label of every cell, else -1",
        ),
        WriterSpec(
            name="glb",
            target=f"{module}:write_glb",
            suffixes=(".glb",),
            summary="one named, coloured node for each part",
        ),
        WriterSpec(
            name="png",
            target="moseg_core.view.writer:write_png",
            suffixes=(".png",),
            summary="a shaded picture with a legend",
        ),
        WriterSpec(
            name="html",
            target="moseg_core.view.page.writer:write_html",
            suffixes=(".html",),
            summary="a page to turn the shape in, with parts and costs; needs no network",
        ),
        WriterSpec(
            name="svg",
            target="moseg_core.view.writer:write_svg",
            suffixes=(".svg",),
            summary="convergence curves: cost per generation and iteration",
        ),
    ]
