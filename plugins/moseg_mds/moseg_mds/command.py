"""``moseg embed``: an embedding to look at, and how good it is."""

from __future__ import annotations

import json as json_format
import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from moseg_core import MosegError, UsageError

if TYPE_CHECKING:
    from moseg_core import Result
    from moseg_mds.embedding import Embedded

_SUFFIXES = (".ply", ".glb", ".png")


def embed(
    shape: Path,
    /,
    *,
    out: Annotated[
        list[Path],
        Parameter(
            name=["--out", "-o"],
            negative=(),
            help="File to write, format by suffix: ply, glb, png. Repeatable.",
        ),
    ],
    geodesics: Literal["auto", "exact", "heat", "graph"] = "auto",
    landmarks: int = 200,
    refine: int = 1000,
    exponent: float = 2.0,
    json: Annotated[bool, Parameter(negative=())] = False,
) -> None:
    """Write a shape with its limbs stretched out, to look at.

    Distances in space become about those along the surface. The file has the faces of the shape in
    the same order, so that labels of the one are labels of the other.

    Examples
    --------
    moseg embed octopus.off -o stretched.ply -o stretched.png

    Parameters
    ----------
    shape
        Mesh to embed, in one piece: OFF, PLY, OBJ, STL or GLB.
    geodesics
        How distances along the surface are computed.
    landmarks
        Number of vertices from which they are computed.
    refine
        Steps of stress majorisation at most; 0 for plain landmark scaling.
    exponent
        0 to get long distances right, 2 to keep the thickness of limbs.
    json
        Print JSON instead of lines.
    """
    from moseg_core import load, printable, save
    from moseg_mds.embedding import MDS

    for path in out:
        _check_destination(path)
    mds = MDS(geodesics=geodesics, landmarks=landmarks, refine=refine, exponent=exponent)
    original = load(shape)
    for note in original.notes:
        print(f"moseg: {printable(f'{original.name}: {note}')}", file=sys.stderr)
    began = perf_counter()
    embedded = mds.embed(original)
    seconds = perf_counter() - began
    result = _as_result(embedded)
    written, failures = [], []
    for path in out:
        try:
            save(result, path)
        except MosegError as error:  # the other files are written all the same
            failures.append(str(error))
        else:
            written.append(str(path))
    found = {
        "stress": embedded.stress,
        "geodesics": embedded.method,
        "landmarks": embedded.landmarks,
        "seconds": round(seconds, 1),
    }
    if json:
        print(json_format.dumps(found, indent=2))
    else:
        for name, value in found.items():
            print(f"{name:<10} {value:.4f}" if name == "stress" else f"{name:<10} {value}")
    if written:
        print(f"moseg: wrote {printable(', '.join(written))}", file=sys.stderr)
    if failures:
        raise MosegError("; ".join(failures))


def _check_destination(path: Path) -> None:
    """Refuse now what could not be written after the work is done."""
    from moseg_core import check_destination

    if path.suffix.lower() not in _SUFFIXES:
        raise UsageError(
            f"an embedding is written as {', '.join(_SUFFIXES)}, not '{path.suffix or path}'"
        )
    check_destination(path)


def _as_result(embedded: Embedded) -> Result:
    """The embedded shape as one part whose cost is the stress: what the writers of results take."""
    import numpy as np

    from moseg_core import Centers, Problem, Result, Segmentation

    def stress(segmentation: Segmentation) -> float:
        return embedded.stress

    stress.__annotations__ = {"segmentation": Segmentation, "return": float}
    problem = Problem(["embedded"], "stress", objectives={"stress": stress})
    shape = embedded.shape
    labels = np.zeros(shape.n_elements, np.int32)
    return Result(
        shape=shape,
        problem=problem,
        labels=labels,
        evaluation=problem.evaluate(shape, labels),
        centers=Centers(positions=np.zeros((1, 3)), weights=np.ones(1)),
        history={},
        method={},
        seed=0,
        versions={},
        reason="converged",
    )
