"""``moseg tune``: weights and centres moved by hand in a browser, with the result before one."""

from __future__ import annotations

import signal
import webbrowser
from dataclasses import replace
from pathlib import Path

from moseg_core.cli.console import message, progress_reporter
from moseg_core.cli.flags import ProblemFlags, SearchFlags, ShapeFlags, SteeringFlags
from moseg_core.cli.reading import read_shape
from moseg_core.cli.request import read_search, read_variants
from moseg_core.cli.working_folder import working_folder_kept
from moseg_core.errors import UsageError
from moseg_core.io.whole_file import check_destination
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.statement import Statement
from moseg_core.search.variants import check_variants
from moseg_core.search.workers import available_workers
from moseg_core.tune.server import Destinations, TuneServer
from moseg_core.tune.session import Session, Wish


def run_tune(
    path: Path,
    recipe_name: str | None,
    *,
    problem_flags: ProblemFlags,
    reading: ShapeFlags,
    search: SearchFlags,
    out: Path | None,
    example: Path | None,
    port: int,
    browser: bool,
) -> None:
    """Search once, then serve the page until Ctrl-C."""
    _check_place(out, ".toml", "-o")
    _check_place(example, ".json", "--example")
    if recipe_name is not None:
        if problem_flags.recipe not in (None, recipe_name):
            raise UsageError(
                f"'{recipe_name}' and '--recipe {problem_flags.recipe}' both name a recipe; give"
                " one of them"
            )
        problem_flags = replace(problem_flags, recipe=recipe_name)
    if problem_flags.recipe is not None:
        _check_closed(load_recipe(problem_flags.recipe).statement)
    variants = read_variants(problem_flags)
    recipe = _recipe(problem_flags, variants.statement)
    options = read_search(search, SteeringFlags())
    check_variants(variants, options)
    shape = read_shape(path, reading)
    for note in shape.notes:
        message(f"{path.name}: {note}")
    sets = [task.problem.labels for task in variants.tasks]
    session = Session(shape, recipe, options, sets=sets)
    with working_folder_kept(), progress_reporter(quiet=False) as show:
        # Nothing is served yet, so that this search may have processes.
        session.search(
            Wish(weights=session.weights), show, workers=search.workers or available_workers()
        )
    server = TuneServer(session, Destinations(recipe=out, example=example), port=port, say=message)
    message(f"cost {session.result.cost:.6g}; open {server.url} (Ctrl-C ends)")
    if browser:
        webbrowser.open(server.url)
    # Also where whoever started this process had it ignore Ctrl-C, as shells do for what runs
    # behind them.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # nohup
        signal.signal(signal.SIGHUP, signal.default_int_handler)
    try:
        server.serve()
    except KeyboardInterrupt:
        message("ended")
    if example is not None and example.exists():
        message(f"to learn from it: moseg learn {path}={example} -o recipe.toml")


def _check_place(path: Path | None, suffix: str, option: str) -> None:
    """Refuse a place that the server could not write to, before anybody has tuned anything."""
    if path is None:
        return
    if path.suffix.lower() != suffix:
        kind = suffix[1:].upper()
        raise UsageError(
            f"'{option} {path}': what goes there is {kind}; let its name end in {suffix}"
        )
    check_destination(path)


def _check_closed(statement: Statement) -> None:
    """Refuse a recipe for any number of parts."""
    if statement.is_open:
        raise UsageError(
            "the recipe is for any number of parts, and a centre is moved of a part with a name;"
            " name the labels, with a recipe or --labels"
        )


def _recipe(flags: ProblemFlags, statement: Statement) -> Recipe:
    """The recipe that is tuned: that of a name or file, with what options replace in it."""
    if flags.recipe is None:
        return Recipe(name="tuned", statement=statement)
    return replace(load_recipe(flags.recipe), statement=statement)
