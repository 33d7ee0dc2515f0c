"""``moseg benchmark``: how well results agree with people, over a collection of shapes.

The command and what its words mean; the work is done in :mod:`moseg_benchmark.run`. Tables go to
stdout, messages to stderr. Heavy modules are imported when a command runs, so that asking for
help does not wait for them.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from moseg_core import UsageError

if TYPE_CHECKING:
    from moseg_benchmark.cases import CaseResult
    from moseg_benchmark.lessons import Lessons
    from moseg_benchmark.tables import Table
    from moseg_core import Recipe

benchmark = App(name="benchmark", help="How well results agree with people.")

#: What models of a category are searched with unless the request names another.
USUAL_RECIPES = (
    "Bird=words_bird",
    "Chair=words_chair",
    "Cup=words_cup",
    "Fourleg=words_fourleg",
    "Hand=words_hand",
    "Octopus=words_octopus",
    "Table=words_table",
)
_WIDTH_OFF_TERMINAL = 120

Repeated = Annotated[list[str] | None, Parameter(negative=())]
Flag = Annotated[bool, Parameter(negative=())]


@benchmark.command
def psb(
    *,
    data: Path | None = None,
    category: Repeated = None,
    recipe_for: Repeated = None,
    learn: Flag = False,
    examples: str = "all",
    learner: str = "profiles",
    train: Path | None = None,
    test: Path | None = None,
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

    moseg benchmark psb --data psb --learn --examples 1,2,4 --seeds 0-2 -o report

    moseg benchmark psb --train mine --test others -o report

    Parameters
    ----------
    data
        Folder with off/ID.off, seg/ID/ID_K.seg and labels/ID_labels.txt.
    category
        Only these models: Fourleg, Human, ... Repeatable.
    recipe_for
        Which recipe to search a category's models with: Fourleg=fourleg, or a path; none searches
        nothing, usual (the default without --learn) those that come with moseg. Repeatable.
    learn
        Search each model with a recipe that was learned from others of its category.
    examples
        From how many: all, or numbers such as 1,2,4. The next ones in cyclic order are taken.
    learner
        What learns, and how: profiles, "profiles(separate=5)".
    train
        With --test in place of --data: the folder of the models to learn from.
    test
        The folder of the models to search with what was learned.
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
    from moseg_benchmark.learned_tables import all_tables
    from moseg_benchmark.psb import CATEGORIES, check_category, find_models
    from moseg_benchmark.run import BenchmarkRequest, run_benchmark
    from moseg_benchmark.tables import failures
    from moseg_core import SearchOptions, available_workers

    searched, teaching = read_folders(data, train, test)
    learning = learn or teaching is not None
    if not learning and (examples, learner) != ("all", "profiles"):
        raise UsageError("--examples and --learner say how to learn; ask for it with --learn")
    categories = tuple(check_category(name) for name in category or ())
    recipes = read_recipes(recipe_for or (["none"] if learning else ["usual"]))
    for name in recipes if recipe_for and categories else ():
        if name not in categories:
            raise UsageError(
                f"--recipe-for {name} has nothing to do: --category asks for"
                f" {', '.join(categories)} only"
            )
    request = BenchmarkRequest(
        models=find_models(searched, categories),
        recipes=recipes,
        settings=list(dict.fromkeys(name.strip() for name in settings.split(","))),
        seeds=read_seeds(seeds),
        lessons=read_lessons(examples, learner, teaching, categories) if learning else None,
    )
    processes = available_workers() if workers is None else SearchOptions(workers=workers).workers
    if out.exists() and not out.is_dir():
        raise UsageError(f"'{out}' is a file; the report needs a folder")
    if not out.parent.is_dir():
        raise UsageError(f"cannot write to '{out}': there is no folder '{out.parent}'")

    def show(done: int, total: int, result: CaseResult) -> None:
        if not quiet:
            _print_message(f"[{done}/{total}] {_line(result)}")

    # A component that is searched with may change the working folder.
    place = out.absolute()
    results = run_benchmark(request, place, workers=processes, resume=resume, show=show)
    for table in all_tables(results, CATEGORIES):
        _print_table(table)
    for line in failures(results):
        _print_message(f"failed: {line}")
    if not quiet:
        _print_message(f"wrote {out / 'index.html'} and {out / 'report.json'}")


def read_folders(
    data: Path | None, train: Path | None, test: Path | None
) -> tuple[Path, Path | None]:
    """The folder of the models to search, and that of others to learn from.

    Raises
    ------
    UsageError
        Neither one folder nor two with different tasks.
    """
    if data is not None and train is None and test is None:
        return data, None
    if data is None and train is not None and test is not None:
        return test, train
    raise UsageError(
        "the models are in one folder, --data DIR, or in two, --train DIR to learn from and"
        " --test DIR to search"
    )


def read_lessons(
    examples: str, learner: str, teaching: Path | None, categories: tuple[str, ...]
) -> Lessons:
    """What to learn from.

    Raises
    ------
    UsageError
        Numbers that are none, an unknown learner, or a folder without models.

    Examples
    --------
    >>> read_lessons("1,2,all", "profiles", None, ()).examples
    (1, 2, None)
    """
    from moseg_benchmark.lessons import Lessons
    from moseg_benchmark.psb import find_models
    from moseg_core import Choice, registry

    words = [word.strip() for word in examples.split(",")]
    if not all(word == "all" or re.fullmatch("[1-9][0-9]*", word) for word in words):
        raise UsageError(f"the numbers of examples '{examples}' are not understood; write 1,2,all")
    registry().find("learner", Choice.read(learner, "learner").name)
    return Lessons(
        examples=tuple(dict.fromkeys(None if word == "all" else int(word) for word in words)),
        learner=learner,
        teachers=None if teaching is None else tuple(find_models(teaching, categories)),
    )


def read_recipes(words: Sequence[str]) -> dict[str, Recipe]:
    """Recipes by category, from words such as ``Fourleg=fourleg``.

    The word ``none`` alone stands for no recipe, and ``usual`` for :data:`USUAL_RECIPES`.

    Raises
    ------
    UsageError
        A word of another form, an unknown category or recipe, two recipes for one category, or one
        that leaves the number of parts open.

    Examples
    --------
    >>> read_recipes(["fourleg=paper_horse"])["Fourleg"].name
    'paper_horse'
    """
    from moseg_benchmark.psb import check_category
    from moseg_core import load_recipe

    recipes: dict[str, Recipe] = {}
    together: dict[tuple[str, ...], Sequence[str]] = {("none",): (), ("usual",): USUAL_RECIPES}
    for word in together.get(tuple(words), words):
        name, equals, recipe = (piece.strip() for piece in word.partition("="))
        if not equals or not recipe:
            raise UsageError(
                f"'--recipe-for {word}' is not understood; write --recipe-for Fourleg=fourleg"
            )
        category = check_category(name)
        if category in recipes:
            raise UsageError(f"--recipe-for gives two recipes for {category}")
        recipes[category] = load_recipe(recipe)
        if recipes[category].statement.is_open:
            raise UsageError(
                f"recipe '{recipe}' leaves the number of parts open"
                f" ({', '.join(recipes[category].labels)}); give a recipe that lists its labels"
            )
    return recipes


def read_seeds(text: str) -> list[int]:
    """Seeds from words such as ``0-2`` or ``0,5,7``.

    Raises
    ------
    UsageError
        Anything else.

    Examples
    --------
    >>> read_seeds("0-2,7")
    [0, 1, 2, 7]
    """
    seeds: list[int] = []
    for word in text.split(","):
        match = re.fullmatch(r"\s*([0-9]+)(?:-([0-9]+))?\s*", word)
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if last < first:
            raise UsageError(f"the seeds '{text}' are not understood; write 0-2 or 0,5,7")
        seeds += range(first, last + 1)
    return list(dict.fromkeys(seeds))


def _line(result: CaseResult) -> str:
    """A result in one line."""
    words = [f"{result.category} {result.model} {result.method} seed {result.seed}"]
    if result.rand_index_error is not None:
        words.append(f"1-RI {result.rand_index_error:.3f}")
    if result.named_right is not None:
        words.append(f"named right {result.named_right:.1%}")
    if result.cost is not None:
        words.append(f"cost {result.cost:.4g}")
    if result.seconds is not None:
        words.append(f"{result.seconds:.1f} s")
    if result.failure:
        words.append(result.failure)
    return ", ".join(words)


def _print_message(text: str) -> None:
    from moseg_core import printable

    print(f"moseg: {printable(text)}", file=sys.stderr)


def _print_table(table: Table) -> None:
    from rich.console import Console
    from rich.table import Table as RichTable

    from moseg_core import printable

    printed = RichTable(box=None, pad_edge=False, header_style="bold")
    for k, head in enumerate(table.heads):
        printed.add_column(printable(head), justify="left" if k == 0 else "right", overflow="fold")
    for cells in table.rows:
        printed.add_row(*map(printable, cells))
    width = None if sys.stdout.isatty() else _WIDTH_OFF_TERMINAL  # lines stay whole in a file
    console = Console(file=sys.stdout, width=width, highlight=False, markup=False, emoji=False)
    console.print(printable(table.title))
    console.print(printed)
    console.print()
