"""The commands under ``moseg plugin``: to see what is installed, and to add to it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Parameter

plugin_app = App(name="plugin", help="Installed bundles of objectives, seeders, formats and more.")

Flag = Annotated[bool, Parameter(negative=())]
Sketched = Literal[
    "objective",
    "field",
    "seeder",
    "labeler",
    "optimizer",
    "parameterization",
    "refiner",
    "constraint",
    "embedding",
    "measure",
    "learner",
    "recipe",
    "reader",
    "writer",
    "command",
]


@plugin_app.command(name="list")
def list_plugins(*, json: Flag = False) -> None:
    """List installed bundles, what they bring, and what is wrong with them.

    Examples
    --------
    moseg plugin list

    Parameters
    ----------
    json
        Print JSON instead of a table.
    """
    from moseg_core.cli.plugin import run_list

    run_list(as_json=json)


@plugin_app.command(name="new")
def new_plugin(
    name: str,
    /,
    *,
    kind: Sketched = "objective",
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
) -> None:
    """Write a new bundle: a package with one component, tests and all, to be changed into yours.

    Examples
    --------
    moseg plugin new vessels

    moseg plugin new lattice --kind seeder -o work/lattice

    Parameters
    ----------
    name
        What to call it: lower-case letters, digits and _. The package is moseg_NAME.
    kind
        What its component is.
    out
        Folder to write; moseg-NAME by default.
    """
    from moseg_core.cli.plugin_new import run_new

    run_new(name, kind=kind, out=out)


@plugin_app.command(name="check")
def check_plugin(
    bundle: str, /, *, timeout: float = 60.0, time: Flag = False, json: Flag = False
) -> None:
    """Check that the components of a bundle keep what their kinds promise.

    The bundle runs in a process of its own. Ends with 1 where a check fails.

    Examples
    --------
    moseg plugin check vessels

    Parameters
    ----------
    bundle
        Its namespace, as listed by "moseg plugin list".
    timeout
        Seconds that a check may take before it is ended and has failed.
    time
        Say too how long a call of each component takes, beside the cost that it declares.
    json
        Print JSON instead of a table.
    """
    from moseg_core.cli.plugin_check import run_check

    run_check(bundle, as_json=json, timeout=timeout, timed=time)


@plugin_app.command(name="explain")
def explain_plugin(component: str, /, *, json: Flag = False) -> None:
    """Say what a component does: formula, range, parameters, requirements, where it comes from.

    Examples
    --------
    moseg plugin explain basic:narrow

    moseg plugin explain pattern_search

    Parameters
    ----------
    component
        Its id, or its name where that is unique.
    json
        Print JSON instead of text.
    """
    from moseg_core.cli.plugin_explain import run_explain_plugin

    run_explain_plugin(component, as_json=json)
