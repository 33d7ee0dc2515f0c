"""Commands that bundles bring: found by name, and imported when they are asked for."""

from __future__ import annotations

from moseg_core.cli.app import app
from moseg_core.cli.examples import show_examples
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import UsageError, unknown


def add_foreign_command(asked: str) -> None:
    """Add the command asked for where it is a bundle's; the core's own come first.

    Only that one is imported.

    Raises
    ------
    UsageError
        Nobody has such a command, or several bundles have.
    PluginError
        It cannot be imported.
    """
    commands = registry().components("command")
    if not any(asked in (command.id, command.spec.name) for command in commands):
        own = [name for name in app if not name.startswith("-")]
        known = [*own, *(command.spec.name for command in commands)]
        hint = "see 'moseg --help', and 'moseg plugin list' for those of bundles"
        raise UsageError(f"{unknown('command', asked, known)} ({hint})")
    # An App has a help of its own; of a function the docstring is the help.
    app.command(registry().find("command", asked).load(), name=asked)
    show_examples(app)
