"""``moseg --install-completion``: a script by which a shell completes commands and options.

cyclopts makes the script of all commands that it knows, so those of bundles are added first. It is
written because the user asks for it, into the folder of his shell, and nowhere else.
"""

from __future__ import annotations

from typing import Literal

from cyclopts import App

from moseg_core.cli.console import message
from moseg_core.cli.examples import show_examples
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import PluginError, UsageError


def run_install_completion(app: App, shell: Literal["bash", "fish", "zsh"] | None) -> None:
    """Write the script, and say where and what to do next.

    Raises
    ------
    UsageError
        Which shell it is cannot be told.
    """
    add_all_commands(app)
    try:
        written = app.install_completion(shell=shell)
    except RuntimeError as error:  # no shell above this process, or one that cyclopts does not know
        raise UsageError(
            "which shell this is cannot be told; say it: moseg --install-completion --shell bash"
        ) from error
    message(f"wrote {written}; open a new terminal, and Tab completes")


def add_all_commands(app: App) -> None:
    """Add the commands of all bundles; one that cannot be imported is passed over and said."""
    for component in registry().components("command"):
        if component.spec.name in app:
            continue
        try:
            app.command(component.load(), name=component.spec.name)
        except PluginError as error:
            message(f"without '{component.spec.name}': {error}")
    show_examples(app)
