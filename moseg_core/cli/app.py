"""The commands and their options; :mod:`moseg_core.cli.entry` runs them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Parameter

from moseg_core.cli.plugin_app import plugin_app
from moseg_core.components.discovery.contract import VERSION

app = App(
    name="moseg",
    version=f"moseg {VERSION}",
    help="Say what the parts of a shape are like; get the shape cut into named parts.",
    help_epilogue="Bundles bring further commands: see 'moseg plugin list'.",
    help_on_error=False,
)
app.command(plugin_app)
benchmark_app = App(name="benchmark", help="How well results agree with people.")
app.command(benchmark_app)

Outputs = Annotated[
    list[Path] | None,
    Parameter(
        name=["--out", "-o"],
        negative=(),
        help="File to write; json, seg, ply, npz, npy, glb, png or svg by suffix. Repeatable.",
    ),
]
Repeated = Annotated[list[str] | None, Parameter(negative=())]
Flag = Annotated[bool, Parameter(negative=())]
Nearness = Literal["auto", "knn", "none"]
Cells = Literal["solid", "surface"]


@app.command
def segment(
    shape: Path,
    /,
    *,
    recipe: str | None = None,
    labels: str | None = None,
    minimize: str | None = None,
    constraint: Repeated = None,
    plane: str | None = None,
    embedding: str | None = None,
    space: str | None = None,
    adjacency: Nearness = "auto",
    volume: str | None = None,
    voxels: Cells = "solid",
    seeder: str | None = None,
    labeler: str | None = None,
    optimizer: str | None = None,
    centers: str | None = None,
    start: Path | None = None,
    pin: Repeated = None,
    freeze: str | None = None,
    restarts: int | None = None,
    finalists: int | None = None,
    resolution: str | None = None,
    settings: Literal["default", "paper"] = "default",
    seed: int = 0,
    max_seconds: float | None = None,
    workers: int | None = None,
    clip: Flag = False,
    out: Outputs = None,
    json: Flag = False,
    quiet: Flag = False,
) -> None:
    """Cut a shape into named parts.

    Examples
    --------
    moseg segment horse.off --recipe horse -o horse.glb -o horse.json

    moseg segment hammer.ply --labels handle,head
    --minimize "3*narrow(handle) + perpendicular(handle, head) + convex_parts"

    Parameters
    ----------
    shape
        A mesh (OFF, PLY, OBJ, STL, GLB), point cloud (PLY, XYZ, CSV) or voxel grid (NPY, BINVOX).
    recipe
        Name of an installed recipe, or path of a TOML file.
    labels
        Names of the parts, separated by commas; instead of the recipe's.
    minimize
        What to minimise, such as "3*narrow(handle) + convex_parts"; instead of the recipe's.
    constraint
        What centres must obey: "mirror(leg2, leg1)", "on_plane(body)"; instead of the recipe's.
        Repeatable; "none" leaves the recipe's out.
    plane
        The plane of symmetry: auto, x, y or z, or px,py,pz,nx,ny,nz (a point and the normal).
    embedding
        Unfold the shape first and find the partition there: mds; "none" leaves the recipe's out.
    space
        Where terms are evaluated that do not say (narrow(arm) @ mds): original, or the embedding.
    adjacency
        Which elements touch: what the shape knows of it, the nearest as well, or none.
    volume
        Estimate the enclosed volume: a number, "hull" or "winding".
    voxels
        Whether all cells of a voxel grid are elements, or only those of its surface.
    seeder
        How centres are first placed: a name, or name(key=number).
    labeler
        How labels are assigned to centres.
    optimizer
        How centres are refined, such as "pattern_search(max_evaluations=2000)".
    centers
        Place the centres by hand: label=x,y,z,label=x,y,z; the same as the seeder "given".
    start
        Go on from an earlier result (.json), also under another --minimize.
    pin
        Elements (faces, points or cells, counted from 0) that must bear a label: head=120,121.
        Repeatable.
    freeze
        Labels, separated by commas, whose centres stay where they start.
    restarts
        Number of starts; the best result is kept. They share limits on evaluations and seconds.
    finalists
        How many of the starts, the best after a while, go on to the end.
    resolution
        Number of super-elements to search on, or "full"; the result is always exact.
    settings
        "paper" for the paper's parameters, one start, full resolution.
    seed
        Seed of the random generator.
    max_seconds
        End the search after about this time; the result then depends on the machine.
    workers
        Number of processes; as many as there are processors by default. The result is the same.
    clip
        Cut the faces at boundaries, so that these are smooth, in .ply, .glb and .png.
    json
        Print a summary as JSON instead of tables.
    quiet
        Print no messages, progress or tables.
    """
    from moseg_core.cli.request import Asked
    from moseg_core.cli.segment import run_segment

    run_segment(
        shape,
        asked=Asked(
            recipe=recipe,
            labels=labels,
            minimize=minimize,
            constraints=constraint or [],
            plane=plane,
            embedding=embedding,
            space=space,
        ),
        adjacency=adjacency,
        volume=volume,
        voxels=voxels,
        choices={"seeder": seeder, "labeler": labeler, "optimizer": optimizer},
        centers=centers,
        start=start,
        pins=pin or [],
        freeze=freeze,
        restarts=restarts,
        finalists=finalists,
        resolution=resolution,
        settings=settings,
        seed=seed,
        max_seconds=max_seconds,
        workers=workers,
        clipped=clip,
        outputs=out or [],
        as_json=json,
        quiet=quiet,
    )


@app.command
def explain(
    source: Path,
    /,
    *,
    recipe: str | None = None,
    labels: str | None = None,
    minimize: str | None = None,
    embedding: str | None = None,
    space: str | None = None,
    parts: Path | None = None,
    adjacency: Nearness = "auto",
    volume: str | None = None,
    voxels: Cells = "solid",
    json: Flag = False,
) -> None:
    """Show what a segmentation costs, by term and part.

    Examples
    --------
    moseg explain horse.json

    moseg explain horse.off --recipe horse --parts mine.seg

    Parameters
    ----------
    source
        A result (.json), or a shape together with --parts.
    recipe
        Recipe under which to evaluate.
    labels
        Names of the parts, separated by commas; instead of the recipe's.
    minimize
        What to minimise; instead of the recipe's.
    embedding
        A deformation in which terms can be evaluated, such as mds; instead of the recipe's.
    space
        Where terms are evaluated that do not say: original, or the embedding.
    parts
        Labelling to evaluate: .seg (numbers in the order of the labels), .txt, .json, .ply, .npz
        or .npy.
    adjacency
        Which elements touch: what the shape knows of it, the nearest as well, or none.
    volume
        Estimate the enclosed volume: a number, "hull" or "winding".
    voxels
        Whether all cells of a voxel grid are elements, or only those of its surface.
    json
        Print JSON instead of a table.
    """
    from moseg_core.cli.explain import run_explain
    from moseg_core.cli.request import Asked

    asked = Asked(recipe=recipe, labels=labels, minimize=minimize, embedding=embedding, space=space)
    run_explain(
        source,
        asked=asked,
        parts=parts,
        adjacency=adjacency,
        volume=volume,
        voxels=voxels,
        as_json=json,
    )


@app.command
def evaluate(
    shape: Path,
    result: Path,
    /,
    *truths: Path,
    voxels: Cells = "solid",
    rename: str | None = None,
    json: Flag = False,
) -> None:
    """Compare a labelling with true ones: the measures of the Princeton benchmark, and names.

    0 is best for all but the share of the area that is named right. Rand Index (1 - RI), cut
    discrepancy, Hamming distance and consistency errors (GCE, LCE) are explained in
    docs/metrics.md.

    Examples
    --------
    moseg evaluate horse.off result.json truth.seg

    moseg evaluate cow.off result.json cow_labels.txt --rename body=torso

    Parameters
    ----------
    shape
        The mesh, point cloud or voxel grid that both label.
    result
        Labelling to judge: .seg, .txt, .json, .ply, .npz or .npy.
    truths
        One or more labellings to compare with.
    voxels
        Whether all cells of a voxel grid are elements, or only those of its surface.
    rename
        Names of the result and what the truth calls them: given=true,given=true.
    json
        Print JSON instead of tables.
    """
    from moseg_core.cli.evaluate import run_evaluate

    run_evaluate(shape, result, truths, voxels=voxels, rename=rename, as_json=json)


@app.command
def sample(
    name: Literal["bulldog", "dove", "hammer", "horse", "octopus"],
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    labels: Path | None = None,
) -> None:
    """Write a sample shape, to try things on.

    Examples
    --------
    moseg sample hammer -o hammer.ply --labels truth.txt

    Parameters
    ----------
    name
        Which one.
    out
        Mesh file to write; PLY.
    labels
        File for its true labels: .txt with names, or .seg with numbers.
    """
    from moseg_core.cli.sample import run_sample

    run_sample(name, out, labels)


@app.command
def plot(
    result: Path,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
) -> None:
    """Draw how a search went: cost per generation and per iteration, and what the starts came to.

    Examples
    --------
    moseg plot horse.json -o convergence.svg

    Parameters
    ----------
    result
        A result (.json).
    out
        File to write: .svg or .png.
    """
    from moseg_core.cli.plot import run_plot

    run_plot(result, out)


@app.command
def recipes(name: str | None = None, /, *, json: Flag = False) -> None:
    """List installed recipes, or print one as it was shipped, to change it.

    Examples
    --------
    moseg recipes

    moseg recipes hammer > mine.toml

    Parameters
    ----------
    name
        Which one to print; all are listed without.
    json
        Print JSON instead of a table or TOML.
    """
    from moseg_core.cli.recipes import run_recipes

    run_recipes(name, as_json=json)


@benchmark_app.command
def psb(
    *,
    data: Path,
    category: Repeated = None,
    recipe_for: Repeated = None,
    settings: str = "default",
    seeds: str = "0",
    workers: int | None = None,
    resume: Flag = False,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    quiet: Flag = False,
) -> None:
    """Compare results, k-means and people on the Princeton Segmentation Benchmark.

    Its data is not part of moseg; nothing is downloaded. Prints 1 - Rand Index by category, and
    what people's parts cost under the recipe beside the cost found; writes both with pictures.

    Examples
    --------
    moseg benchmark psb --data psb --category Fourleg --settings default,paper --seeds 0-2 -o report

    Parameters
    ----------
    data
        Folder with off/ID.off, seg/ID/ID_K.seg and labels/ID_labels.txt.
    category
        Only these models: Fourleg, Human, ... Repeatable.
    recipe_for
        Which recipe to search a category's models with: Fourleg=horse, or a path. Repeatable.
    settings
        "default", "paper", or both with a comma between.
    seeds
        Seeds of the searches, such as 0-2 or 0,5.
    workers
        Number of processes; as many as there are processors by default. Each search has one.
    resume
        Take over from an earlier run into the same folder what was asked in the same way.
    out
        Folder for index.html, report.json, pictures and the labels found.
    quiet
        Print the tables only.
    """
    from moseg_core.cli.benchmark import run_psb

    run_psb(
        data,
        categories=category or [],
        recipes=recipe_for or [],
        settings=settings,
        seeds=seeds,
        workers=workers,
        resume=resume,
        out=out,
        quiet=quiet,
    )
