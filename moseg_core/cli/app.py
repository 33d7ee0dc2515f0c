"""The commands and their options; :mod:`moseg_core.cli.entry` runs them."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Parameter

from moseg_core.cli.collection import importing
from moseg_core.cli.examples import show_examples
from moseg_core.cli.flags import (
    BatchFlags,
    CheckpointFlags,
    Flag,
    PartFlags,
    ProblemFlags,
    Repeated,
    SearchedProblemFlags,
    SearchFlags,
    ShapeFlags,
    SteeringFlags,
)
from moseg_core.cli.overview import ENTRIES, EPILOGUE, PURPOSE, VERSION_LINE
from moseg_core.cli.plugin_app import plugin_app
from moseg_core.cli.waiting import waiting

app = App(
    name="moseg",
    version=VERSION_LINE,
    help=PURPOSE,
    help_epilogue=EPILOGUE,
    help_on_error=False,
)
app.command(plugin_app)

Outputs = Annotated[
    list[Path] | None,
    Parameter(
        name=["--out", "-o"],
        negative=(),
        help="File to write: json, html, glb, obj, ply, vtu, 3mf, png, seg, npz, npy, svg, by"
        " suffix. With {part} in its name a file for each part: stl, obj, ply or glb. Repeatable.",
    ),
]
_NO_PROBLEM = ProblemFlags()
_NO_SEARCHED_PROBLEM = SearchedProblemFlags()
_SHAPE_AS_READ = ShapeFlags()
_DEFAULT_SEARCH = SearchFlags()
_NO_STEERING = SteeringFlags()
_PARTS_AS_CUT = PartFlags()
_NO_LIMITS = BatchFlags()
_NO_CHECKPOINT = CheckpointFlags()


@app.command
def segment(
    shape: Path,
    /,
    *,
    problem: SearchedProblemFlags = _NO_SEARCHED_PROBLEM,
    reading: ShapeFlags = _SHAPE_AS_READ,
    search: SearchFlags = _DEFAULT_SEARCH,
    steering: SteeringFlags = _NO_STEERING,
    long_run: CheckpointFlags = _NO_CHECKPOINT,
    clip: Flag = False,
    out: Outputs = None,
    part_files: PartFlags = _PARTS_AS_CUT,
    term_timeout: float | None = None,
    profile: Flag = False,
    json: Flag = False,
    quiet: Flag = False,
) -> None:
    """Cut a shape into named parts.

    Examples
    --------
    moseg segment horse.off --recipe fourleg -o horse.glb -o horse.json

    moseg segment hammer.ply --labels handle,head
    --minimize "3*narrow(handle) + perpendicular(handle, head) + convex_parts"

    moseg segment cup.stl --parts 3 -o cup.png

    moseg segment hammer.ply --recipe hammer -o 'parts/{part}.stl' --close

    Parameters
    ----------
    shape
        A mesh (OFF, PLY, OBJ, STL, GLB, GLTF), point cloud (PLY, XYZ, PTS, ASC, TXT, CSV, NPY) or
        voxel grid (NPY, BINVOX).
    clip
        Cut the faces at boundaries, so that these are smooth, in meshes and pictures.
    term_timeout
        Seconds that a call of an objective may take; longer ones end the search, with the best so
        far. Without limit by default.
    profile
        Print at the end, on stderr, where the time went: by stage, by term and component, by
        bundle. Everything is then done in one process.
    json
        Print a summary as JSON instead of tables.
    quiet
        Print no messages, progress or tables.
    """
    with importing(), waiting("starting", quiet=quiet):
        from moseg_core.cli.console import announcing_compilation
        from moseg_core.cli.profile import printing_profile
        from moseg_core.cli.segment import run_segment

    profiling = printing_profile() if profile else nullcontext()
    with announcing_compilation(quiet=quiet), profiling:
        run_segment(
            shape,
            problem_flags=problem,
            reading=reading,
            search=replace(search, workers=1) if profile else search,
            steering=steering,
            long_run=long_run,
            clipped=clip,
            outputs=out or [],
            part_flags=part_files,
            term_timeout=term_timeout,
            as_json=json,
            quiet=quiet,
        )


@app.command
def batch(
    *shapes: str,
    problem: SearchedProblemFlags = _NO_SEARCHED_PROBLEM,
    reading: ShapeFlags = _SHAPE_AS_READ,
    search: SearchFlags = _DEFAULT_SEARCH,
    limits: BatchFlags = _NO_LIMITS,
    clip: Flag = False,
    out: Annotated[
        list[Path] | None,
        Parameter(
            name=["--out", "-o"],
            negative=(),
            help="Folder for the results, a .json file for each shape, and the ledger; made where"
            " it lacks. Repeatable: with {shape} in its path another file for each shape, in any"
            " format of moseg segment: -o 'out/{shape}.glb', -o 'out/{shape}/{part}.stl'.",
        ),
    ] = None,
    part_files: PartFlags = _PARTS_AS_CUT,
    json: Flag = False,
    quiet: Flag = False,
) -> None:
    """Segment many shapes, each in a guarded process; what fails harms no other.

    A shape that crashes, hangs or takes too much memory is named at the end, with what it died of
    (docs/batch.md). A batch that was ended, however, goes on with --resume.

    Examples
    --------
    moseg batch 'models/*.off' --recipe fourleg -o out --timeout 600 --memory 4

    moseg batch 'models/*.off' --recipe fourleg -o out --resume

    moseg batch scans/*.ply --recipe ant.toml -o out -o 'out/{shape}.glb' && moseg measure out

    Parameters
    ----------
    shapes
        Meshes, point clouds or voxel grids: files, or patterns in quotes, also with ** for folders
        below.
    clip
        Cut the faces at boundaries, so that these are smooth, in meshes and pictures.
    json
        Print every outcome as JSON instead of a table.
    quiet
        Print no messages, progress or tables.
    """
    with importing(), waiting("starting", quiet=quiet):
        from moseg_core.cli.batch import run_batch_command

    run_batch_command(
        shapes,
        problem_flags=problem,
        reading=reading,
        search=search,
        limits=limits,
        clipped=clip,
        outputs=out or [],
        part_flags=part_files,
        as_json=json,
        quiet=quiet,
    )


@app.command
def tune(
    shape: Path,
    recipe: str | None = None,
    /,
    *,
    problem: ProblemFlags = _NO_PROBLEM,
    reading: ShapeFlags = _SHAPE_AS_READ,
    search: SearchFlags = _DEFAULT_SEARCH,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    example: Path | None = None,
    port: int = 0,
    no_open: Flag = False,
) -> None:
    """Find the words for a shape by looking: sliders for weights, centres moved by hand.

    Searches once, then serves the page of the result on this machine alone, until Ctrl-C. Nothing
    is written but where -o and --example say, when their buttons are pressed.

    Examples
    --------
    moseg tune horse.off fourleg -o myhorse.toml --example horse.json

    moseg tune hammer.ply --labels handle,head --minimize "3*narrow(handle) + convex_parts"

    Parameters
    ----------
    shape
        A mesh, point cloud or voxel grid.
    recipe
        Name of an installed recipe, or path of a TOML file; as --recipe.
    out
        Where "Save recipe" writes the recipe with its new weights (.toml).
    example
        Where "Accept as an example" writes the result (.json), for moseg learn.
    port
        Where to serve; any that is free by default.
    no_open
        Do not open the browser; the address is printed.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.tune import run_tune

    run_tune(
        shape,
        recipe,
        problem_flags=problem,
        reading=reading,
        search=search,
        out=out,
        example=example,
        port=port,
        browser=not no_open,
    )


@app.command
def export(
    result: Path,
    labels: Path | None = None,
    /,
    *,
    shapes: Path | None = None,
    label_property: str | None = None,
    reading: ShapeFlags = _SHAPE_AS_READ,
    parts: PartFlags = _PARTS_AS_CUT,
    out: Outputs = None,
) -> None:
    """Write other files of a saved result, also with labels corrected by hand; nothing is searched.

    Examples
    --------
    moseg export hammer.json -o 'hulls/{part}.stl' --hulls -o hammer.urdf

    moseg export horse.json corrected.txt -o horse.obj

    Parameters
    ----------
    result
        A result (.json). Its shape is looked for where it was, and beside the result.
    labels
        Labels to take in place of the result's, of the same names or numbers: .txt, .seg, .ply and
        others (docs/formats.md). What has no label gets that of the nearest element that has one.
    shapes
        Folder in which the shape is looked for as well.
    label_property
        Name of the property, column or array that holds the labels, if not a usual one.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.export import run_export

    run_export(
        result,
        labels,
        shapes=shapes,
        label_property=label_property,
        reading=reading,
        part_flags=parts,
        outputs=out or [],
    )


@app.command
def explain(
    source: Path,
    /,
    *,
    problem: ProblemFlags = _NO_PROBLEM,
    parts: Path | None = None,
    label_property: str | None = None,
    reading: ShapeFlags = _SHAPE_AS_READ,
    json: Flag = False,
) -> None:
    """Show what a segmentation costs, by term and part.

    Examples
    --------
    moseg explain horse.json

    moseg explain horse.off --recipe fourleg --parts mine.seg

    Parameters
    ----------
    source
        A result (.json), or a shape together with --parts.
    parts
        Labelling to evaluate: .seg (numbers in the order of the labels), .txt, .json, .ply and
        others (docs/formats.md). A recipe for any number of parts takes the number from it.
    label_property
        Name of the property, column or array of --parts that holds the labels, if not a usual one.
    json
        Print JSON instead of a table.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.explain import run_explain

    run_explain(
        source,
        problem_flags=problem,
        parts=parts,
        label_property=label_property,
        reading=reading,
        as_json=json,
    )


@app.command
def view(
    shape: Path,
    result: Path | None = None,
    /,
    *,
    label_property: str | None = None,
    reading: ShapeFlags = _SHAPE_AS_READ,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    no_open: Flag = False,
) -> None:
    """Turn a labelled shape in the browser: parts, areas, costs; a click places a centre.

    The page is one file that needs no network (docs/page.md).

    Examples
    --------
    moseg view horse.off horse.json

    moseg view horse.off mine.seg -o horse.html

    Parameters
    ----------
    shape
        The mesh, point cloud or voxel grid; alone, one that bears its labels (.ply, .glb, .obj), or
        a result (.json) beside its shape.
    result
        Its labels: .json, .seg, .txt, .ply, .npy and others (docs/formats.md). A result of moseg is
        shown with its costs.
    label_property
        Name of the property, column or array that holds the labels, if not a usual one.
    out
        File to write, .html; without it, a temporary one is written and opened in the browser.
    no_open
        Do not open the browser.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.view import run_view

    run_view(
        shape,
        result,
        label_property=label_property,
        reading=reading,
        out=out,
        browser=not no_open,
    )


@app.command
def evaluate(
    shape: Path,
    result: Path,
    /,
    *truths: Path,
    voxels: Literal["solid", "surface"] = "solid",
    limit: Repeated = None,
    rename: str | None = None,
    label_property: str | None = None,
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
        Labelling to judge: .seg, .txt, .json, .ply, .glb, .obj, .npy and others (docs/formats.md).
        What it, or a truth, leaves without a label is left out.
    truths
        One or more labellings to compare with.
    voxels
        Whether all cells of a voxel grid are elements, or only those of its surface.
    limit
        How much a file may become, as "cells=2e7" or "none": see docs/formats.md. Repeatable.
    rename
        Names of the result and what the truth calls them: given=true,given=true.
    label_property
        Name of the property, column or array that holds the labels, if not a usual one; the first
        that a file has, of several: label,objectId.
    json
        Print JSON instead of tables.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.evaluate import run_evaluate

    run_evaluate(
        shape,
        result,
        truths,
        reading=ShapeFlags(voxels=voxels, limit=limit),
        rename=rename,
        label_property=label_property,
        as_json=json,
    )


@app.command
def render(
    shape: Path,
    result: Path,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    views: str = "main,opposite",
    size: str = "1400x700",
    transparent: Flag = False,
    no_legend: Flag = False,
    title: str | None = None,
    label_property: str | None = None,
    reading: ShapeFlags = _SHAPE_AS_READ,
) -> None:
    """Draw a segmented shape: a picture of any labels, from the sides that are asked for.

    Examples
    --------
    moseg render horse.off horse.json -o horse.png

    moseg render chair.ply labels.txt --up z --views front,left,top --size 900x400 -o chair.png

    moseg render dove.off dove.seg --views 1 --transparent --no-legend -o dove.png

    Parameters
    ----------
    shape
        A mesh, point cloud or voxel grid.
    result
        Its labels: a result (.json), or .seg, .txt, .ply, .glb and others (docs/formats.md). What
        has no label is grey.
    out
        Picture to write: .png.
    views
        From where to look: names out of main, opposite, front, back, left, right, top and bottom,
        or a number of views all around.
    size
        Width and height in pixels.
    transparent
        Leave the background out.
    no_legend
        Leave out the legend and the title.
    title
        What to write above; the name of the shape by default.
    label_property
        Name of the property, column or array that holds the labels, if not a usual one.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.render import run_render

    run_render(
        shape,
        result,
        out=out,
        views=views,
        size=size,
        transparent=transparent,
        legend=not no_legend,
        title=title,
        label_property=label_property,
        reading=reading,
    )


@app.command
def measure(
    *sources: str,
    problem: SearchedProblemFlags = _NO_SEARCHED_PROBLEM,
    reading: ShapeFlags = _SHAPE_AS_READ,
    search: SearchFlags = _DEFAULT_SEARCH,
    shapes: Path | None = None,
    label_property: str | None = None,
    keep: Path | None = None,
    out: Annotated[
        list[Path] | None,
        Parameter(
            name=["--out", "-o"],
            negative=(),
            help="Table to write; csv, tsv or json by suffix. Repeatable.",
        ),
    ] = None,
    json: Flag = False,
    quiet: Flag = False,
) -> None:
    """Measure parts: a table of areas, volumes, lengths and more, of one shape or many.

    A row for each part, in the units of the shape; docs/measuring.md explains the columns. What
    fails is named, and the rest measured all the same.

    Examples
    --------
    moseg measure horse.json

    moseg measure results/*.json --shapes scans -o parts.csv

    moseg measure out -o parts.csv

    moseg measure cup.off=cup_labels.txt -o parts.tsv

    moseg measure *.off --recipe ant.toml --keep results -o ants.csv

    Parameters
    ----------
    sources
        Results (.json), or the folder of a batch; shapes with their labels, SHAPE=LABELS; shapes
        that bear labels (PLY, OBJ, STL, GLB). With a recipe also shapes without labels, which are
        segmented first, one after the other; of shapes that bear labels only those of PLY files
        count then.
    shapes
        Folder in which the shapes of results are looked for, besides where they were when they were
        segmented, and beside the results.
    label_property
        Name of the property, column or array that holds the labels, if not a usual one.
    keep
        Folder for the results of what is segmented, a .json file for each shape.
    json
        Print the whole table as JSON.
    quiet
        Print no messages and no progress.
    """
    with importing():
        from moseg_core.cli.console import announcing_compilation
        from moseg_core.cli.measure import run_measure

    with announcing_compilation(quiet=quiet):
        run_measure(
            sources,
            problem=problem,
            reading=reading,
            search=search,
            shapes=shapes,
            label_property=label_property,
            keep=keep,
            outputs=out or [],
            as_json=json,
            quiet=quiet,
        )


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
def field(
    shape: Path,
    name: str,
    /,
    *,
    reading: ShapeFlags = _SHAPE_AS_READ,
    recipe: Annotated[
        str | None,
        Parameter(help="Whose tables the field's parameters name: a recipe's name or .toml file."),
    ] = None,
    out: Annotated[
        list[Path] | None,
        Parameter(
            name=["--out", "-o"],
            negative=(),
            help="File to write; png, ply, npy or csv by suffix. Repeatable.",
        ),
    ] = None,
    json: Flag = False,
) -> None:
    """Show a field: a number for each element of a shape, such as how thick it is there.

    Prints the least value, the mean by area and the greatest; writes a picture in colours, or the
    values. Fields are listed by "moseg plugin list".

    Examples
    --------
    moseg field horse.off thickness -o thick.png

    moseg field horse.off "basic:thickness(rays=24)" -o values.npy

    moseg field dog.off "mine:likelihood(among=looks)" --recipe dog.toml -o likely.png

    Parameters
    ----------
    shape
        A mesh, point cloud or voxel grid.
    name
        The field: a name, or name(key=value).
    json
        Print JSON instead of a table.
    """
    with importing(), waiting("starting"):
        from moseg_core.cli.field import run_field

    run_field(shape, name, recipe=recipe, reading=reading, outputs=out or [], as_json=json)


@app.command
def objectives(name: str | None = None, /, *, json: Flag = False) -> None:
    """List the objectives that expressions are made of, or explain one.

    Examples
    --------
    moseg objectives

    moseg objectives narrow

    Parameters
    ----------
    name
        Which one to explain: formula, range, parameters; all are listed without.
    json
        Print JSON instead of a table or text.
    """
    from moseg_core.cli.objectives import run_objectives

    run_objectives(name, as_json=json)


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


# Shown by the overview; the parser's own list would break the long name in two.
@app.command(name="--install-completion", show=False)
def install_completion(*, shell: Literal["bash", "fish", "zsh"] | None = None) -> None:
    """Let your shell complete moseg's commands and options.

    Writes a script to where your shell looks for such, and a line that reads it into the file that
    your shell reads when it starts; says which.

    Examples
    --------
    moseg --install-completion

    moseg --install-completion --shell zsh

    Parameters
    ----------
    shell
        Which shell; the one that moseg runs in by default.
    """
    from moseg_core.cli.completion import run_install_completion

    run_install_completion(app, shell)


show_examples(app)
# In the order of use, as in the overview.
for place, name in enumerate(ENTRIES):
    if name in app and not name.startswith("-"):
        app[name].sort_key = place
