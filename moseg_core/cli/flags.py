"""Options that several commands share: each group is stated, explained and defaulted once.

The command line fills in these records; :mod:`moseg_core.cli.request` makes a statement of a
problem and search options of them, which know nothing of a command line. Imports nothing heavy:
``moseg --help`` reads this module.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter

Repeated = Annotated[list[str] | None, Parameter(negative=())]
Flag = Annotated[bool, Parameter(negative=())]

# Sections of the help, in this order.
_LOOKED_FOR = Group.create_ordered("What to look for")
_READ = Group.create_ordered("How to read the shape")
_SEARCHED = Group.create_ordered("How to search")
_KNOWN = Group.create_ordered("What is known of this shape")
_PARTS = Group.create_ordered("Files of single parts")
_LIMITED = Group.create_ordered("What each shape may take, and what is done again")
_LONG = Group.create_ordered("Long runs")


@Parameter(name="*", group=_LOOKED_FOR)
@dataclass(frozen=True, kw_only=True)
class ProblemFlags:
    """What to look for.

    Parameters
    ----------
    recipe
        Name of an installed recipe, or path of a TOML file.
    labels
        Names of the parts, separated by commas, also with counts (torso,leg{4},tail{0..1}); instead
        of the recipe's, or chosen among them where the recipe's have counts.
    minimize
        What to minimise, such as "3*narrow(handle) + convex_parts"; instead of the recipe's.
    embedding
        Unfold the shape first and find the partition there: mds; "none" leaves the recipe's out.
    space
        Where terms are evaluated that do not say (narrow(arm) @ mds): original, or the embedding.
    """

    recipe: str | None = None
    labels: str | None = None
    minimize: str | None = None
    embedding: str | None = None
    space: str | None = None

    @property
    def anything(self) -> bool:
        """Whether any of the options was given."""
        return any(getattr(self, field.name) is not None for field in fields(self))


@Parameter(name="*", group=_LOOKED_FOR)
@dataclass(frozen=True, kw_only=True)
class SearchedProblemFlags(ProblemFlags):
    """What to look for, and what the centres must obey.

    Parameters
    ----------
    parts
        How many parts there are, for a recipe of any number of parts, by default "any_shape"; or
        "auto" to have the number found.
    constraint
        What centres must obey: "mirror(leg2, leg1)", "on_plane(body)"; instead of the recipe's.
        Repeatable; "none" leaves the recipe's out.
    plane
        The plane of symmetry: auto, x, y or z, or px,py,pz,nx,ny,nz (a point and the normal).
    """

    parts: str | None = None
    constraint: Repeated = None
    plane: str | None = None


@Parameter(name="*", group=_READ)
@dataclass(frozen=True, kw_only=True)
class ShapeFlags:
    """How to read a shape.

    Parameters
    ----------
    adjacency
        Which elements touch: what the shape knows of it, the nearest as well, or none.
    volume
        Estimate the enclosed volume: a number, "hull" or "winding".
    weld
        How far vertices of a mesh may lie apart and still be joined, as a share of the bounding
        box's diagonal: 1e-8 by default; 0 joins equal ones only.
    voxels
        Whether all cells of a voxel grid are elements, or only those of its surface.
    pitch
        Sides of the cells of a voxel grid whose file does not know them: 0.5, or 0.5,0.5,3 along
        the axes of the array.
    up
        Which axis of the file points up; y in glTF files, else not known.
    limit
        How much a file may become: triangles_per_byte, cells_per_byte, cells, grid_cells, columns
        or unpacked_bytes, as in "cells=2e7" or "cells=none"; "none" lifts all. Repeatable.
    """

    adjacency: Literal["auto", "knn", "none"] = "auto"
    volume: str | None = None
    weld: float | None = None
    voxels: Literal["solid", "surface"] = "solid"
    pitch: str | None = None
    up: Annotated[
        Literal["x", "-x", "y", "-y", "z", "-z"] | None, Parameter(allow_leading_hyphen=True)
    ] = None
    limit: Repeated = None


@Parameter(name="*", group=_SEARCHED)
@dataclass(frozen=True, kw_only=True)
class SearchFlags:
    """How to search.

    Parameters
    ----------
    seeder
        How centres are first placed: a name, or name(key=value).
    labeler
        How labels are assigned to centres.
    optimizer
        How centres are refined, such as "pattern_search(max_evaluations=2000)".
    parameterization
        The family of segmentations to search, such as "voronoi(connected=false)".
    refiner
        What moves boundaries once the search is over, such as "graph_cut(band=0.08)"; "none" leaves
        the recipe's out.
    restarts
        Number of starts; the best result is kept. They share limits on evaluations and seconds.
    finalists
        How many of the starts, the best after a while, go on to the end.
    polished
        How many of the results on super-elements are searched for a little longer on finer ones.
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
    ignore_pieces_below
        Leave loose pieces with less than this share of the area out of the search: 0.1%. They get
        the label of the nearest part.
    """

    seeder: str | None = None
    labeler: str | None = None
    optimizer: str | None = None
    parameterization: str | None = None
    refiner: str | None = None
    restarts: int | None = None
    finalists: int | None = None
    polished: int | None = None
    resolution: str | None = None
    settings: Literal["default", "paper"] = "default"
    seed: int = 0
    max_seconds: float | None = None
    workers: int | None = None
    ignore_pieces_below: str = "0"


@Parameter(name="*", group=_KNOWN)
@dataclass(frozen=True, kw_only=True)
class SteeringFlags:
    """Where to begin, and what is known already of this one shape.

    Parameters
    ----------
    centers
        Place the centres by hand: label=x,y,z,label=x,y,z; for the seeder "given", or another
        that takes centres.
    start
        Go on from an earlier result (.json) of this shape, also under another --minimize.
    start_from
        Begin with an earlier result (.json) of another shape of the kind, laid onto this one: its
        labels stay with the parts that they stand for. Its shape lies where it was, or beside it.
    pin
        Elements (faces, points or cells, counted from 0) that must bear a label: head=120,121.
        Repeatable.
    freeze
        Labels, separated by commas, whose centres stay where they start.
    """

    centers: str | None = None
    start: Path | None = None
    start_from: Path | None = None
    pin: Repeated = None
    freeze: str | None = None


@Parameter(name="*", group=_PARTS)
@dataclass(frozen=True, kw_only=True)
class PartFlags:
    """What is written of each part where -o names a file for each: -o 'parts/{part}.stl'.

    Parameters
    ----------
    close
        Each part as a closed solid, which can be printed: where it was cut out it is capped.
    hulls
        The convex hull of each part instead of its surface.
    hull_vertices
        The greatest number of vertices of a hull, 4 or more; also in .urdf and .mjcf.
    """

    close: Flag = False
    hulls: Flag = False
    hull_vertices: int | None = None


@Parameter(name="*", group=_LIMITED)
@dataclass(frozen=True, kw_only=True)
class BatchFlags:
    """What each shape of a batch may take, and what is done again.

    Parameters
    ----------
    timeout
        Seconds that a shape may take; it is then ended, and has failed. No limit by default.
    memory
        GB of memory that a shape may take, .5 or more. No limit by default.
    resume
        Go on with the batch in the folder: do what is missing, or has changed since.
    retry_failed
        The same, and do again what has failed.
    start_from
        Lay an earlier result of another shape (.json) onto each and go on from there; so parts that
        are alike are called alike.
    term_timeout
        Seconds that a call of an objective may take; the shape has then failed.
    report
        Write report.html into the folder: a picture and the cost of each shape, those that are most
        unlike the others first.
    scheduler
        Do it on a Dask cluster: the address of its scheduler, tcp://10.0.0.5:8786. All machines see
        the files under the same paths.
    """

    timeout: float | None = None
    memory: float | None = None
    resume: Flag = False
    retry_failed: Flag = False
    start_from: Path | None = None
    term_timeout: float | None = None
    report: Flag = False
    scheduler: str | None = None


@Parameter(name="*", group=_LONG)
@dataclass(frozen=True, kw_only=True)
class CheckpointFlags:
    """What is kept of a run that may be stopped.

    Parameters
    ----------
    checkpoint
        Keep what is computed in this file, for --resume.
    resume
        Go on from a checkpoint; the result is that of a run that was never stopped, to the byte.
        With the same --checkpoint it is begun where the file is not there yet.
    checkpoint_every
        Seconds from one time that the checkpoint is written to the next; 30 by default.
    """

    checkpoint: Path | None = None
    resume: Path | None = None
    checkpoint_every: float | None = None
