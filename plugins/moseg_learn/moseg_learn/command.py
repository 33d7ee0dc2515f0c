"""``moseg learn``: labelled examples in, a recipe out.

The command and what its words mean; heavy modules are imported when it runs. The recipe goes to a
file or to stdout, what is found out about it to stdout or stderr.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from moseg_core import UsageError

if TYPE_CHECKING:
    from moseg_learn.left_out import LeftOut

Flag = Annotated[bool, Parameter(negative=())]


def learn(
    *examples: str,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    check: Flag = False,
    names: str | None = None,
    label_property: str | None = None,
    learner: str = "profiles",
    adjacency: str = "auto",
    seed: int = 0,
    workers: int | None = None,
    quiet: Flag = False,
) -> None:
    """Make a recipe of labelled examples.

    Labels name kinds of parts: each connected piece of what is called leg is a leg of its own. The
    recipe is a text; read it, change it, and segment other shapes with --recipe.

    Examples
    --------
    moseg learn cat.off=cat_labels.txt dog.ply fox.off=fox.json -o animal.toml

    moseg learn *.ply --check

    Parameters
    ----------
    examples
        SHAPE=LABELS, with labels from .txt, .json, .ply, .glb, .npz, .seg, .npy or others; or a
        .ply, .obj, .stl or .glb that bears its own.
    out
        The recipe to write, a .toml file; else it is printed.
    check
        Leave each example out in turn, segment it by what the others teach, and say how well that
        goes.
    names
        What labels are called in files that only number them, from 0 on: body,leg,tail.
    label_property
        Name of the property, column or array that holds the labels, if not a usual one; the first
        that a file has, of several: label,objectId.
    learner
        What learns, and how: profiles, "profiles(separate=5)".
    adjacency
        Which elements touch: auto, knn (for point clouds) or none.
    seed
        Of the searches of --check.
    workers
        Number of processes for --check; as many as there are processors by default.
    quiet
        Print the recipe, or the table of --check, only.
    """
    from moseg_core import SearchOptions, available_workers, write_file
    from moseg_core import learn as learned
    from moseg_learn.left_out import leave_one_out
    from moseg_learn.reading import read_example, split_word
    from moseg_learn.text import annotated

    if not examples:
        raise UsageError("there is nothing to learn from; give examples: SHAPE=LABELS")
    if len(set(examples)) < len(examples):
        twice = next(word for k, word in enumerate(examples) if word in examples[:k])
        raise UsageError(f"example '{twice}' is given twice; give each once")
    place = Path.cwd()  # a learner may go elsewhere
    if out is not None:
        _check_out(out)
    if check and len(examples) < 2:
        raise UsageError("--check leaves one example out, so it needs two or more")
    processes = available_workers() if workers is None else SearchOptions(workers=workers).workers
    for word in examples:
        split_word(word)
    asked = [name.strip() for name in (label_property or "").split(",") if name.strip()]
    called = None if names is None else [name.strip() for name in names.split(",")]
    read = []
    for word in examples:
        read.append(
            read_example(
                word,
                names=called,
                adjacency=adjacency,
                label_property=asked,
                tell=lambda note: _tell(note, quiet=quiet),
            )
        )
        _tell(f"{word}: {', '.join(read[-1].borne)}", quiet=quiet)
    recipe = learned(read, learner=learner)
    text = annotated(recipe)
    if out is not None:
        write_file(place / out, text.encode())
        _tell(f"wrote {out}: {', '.join(recipe.labels)}", quiet=quiet)
    if check:

        def show(done: int, result: LeftOut) -> None:
            _tell(f"[{done}/{len(read)}] {_line(result)}", quiet=quiet)

        _print_table(leave_one_out(read, learner=learner, seed=seed, workers=processes, show=show))
    elif out is None:
        print(text, end="")


def _check_out(out: Path) -> None:
    from moseg_core import check_destination

    if out.suffix != ".toml":
        raise UsageError(f"a recipe is written to a .toml file, not to '{out}'")
    check_destination(out)


def _tell(text: str, *, quiet: bool) -> None:
    from moseg_core import printable

    if not quiet:
        print(f"moseg: {printable(text)}", file=sys.stderr)


def _line(result: LeftOut) -> str:
    words = [f"without {result.name}"]
    if result.named_right is not None:
        words.append(f"{100 * result.named_right:.0f} % named right")
    if result.failure:
        words.append(result.failure)
    return ", ".join(words)


def _print_table(results: list[LeftOut]) -> None:
    from rich.console import Console
    from rich.table import Table

    from moseg_core import printable

    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("left out")
    for heading in ("1 - Rand Index", "named right", "cost", "cost of its own parts"):
        table.add_column(heading, justify="right")
    for result in results:
        table.add_row(
            printable(result.name),
            _number(result.rand_index_error, ".3f"),
            "" if result.named_right is None else f"{100 * result.named_right:.1f} %",
            _number(result.cost, ".4g"),
            _number(result.own_cost, ".4g"),
        )
    known = [result for result in results if result.rand_index_error is not None]
    if len(known) > 1:
        errors = [result.rand_index_error or 0.0 for result in known]
        right = [result.named_right or 0.0 for result in known]
        table.add_row(
            "mean",
            f"{sum(errors) / len(known):.3f}",
            f"{100 * sum(right) / len(known):.1f} %",
            "",
            "",
        )
    width = None if sys.stdout.isatty() else 100  # lines stay whole in a file
    Console(file=sys.stdout, width=width, highlight=False, markup=False, emoji=False).print(table)


def _number(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)
