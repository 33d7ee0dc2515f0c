"""Running a command: those of bundles among them, errors as messages and exit codes."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from cyclopts import CycloptsError

from moseg_core.cli.app import app
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import MosegError, Terminated, UsageError, unknown


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit.

    Parameters
    ----------
    arguments : sequence of str, optional
        Instead of ``sys.argv[1:]``.

    Raises
    ------
    SystemExit
        With 0, or the exit code of what went wrong (:mod:`moseg_core.errors`); 130 when
        interrupted, 143 when told to end by SIGTERM.
    """
    sys.exit(_run(list(sys.argv[1:] if arguments is None else arguments)))


def _add_foreign_command(asked: str) -> None:
    """Add the command asked for where it is a bundle's; the core's own come first.

    Only that one is imported.

    Raises
    ------
    UsageError
        Nobody has such a command, or several bundles have.
    PluginError
        It cannot be imported.
    """
    if asked.startswith("-") or asked in app:
        return
    commands = registry().components("command")
    if not any(asked in (command.id, command.spec.name) for command in commands):
        own = [name for name in app if not name.startswith("-")]
        known = [*own, *(command.spec.name for command in commands)]
        hint = "see 'moseg --help', and 'moseg plugin list' for those of bundles"
        raise UsageError(f"{unknown('command', asked, known)} ({hint})")
    # An App has a help of its own; of a function the docstring is the help.
    app.command(registry().find("command", asked).load(), name=asked)


def _run(arguments: list[str]) -> int:
    try:
        _add_foreign_command(arguments[0] if arguments else "--help")
        command, bound, _ = app.parse_args(arguments, exit_on_error=False, print_error=False)
        command(*bound.args, **bound.kwargs)
        sys.stdout.flush()
    except CycloptsError as error:
        words = " ".join(str(error).split())
        print(f"moseg: {words} (see 'moseg --help')", file=sys.stderr)
        return 2
    except MosegError as error:
        print(f"moseg: {error}", file=sys.stderr)
        return error.exit_code
    except Terminated:
        print("moseg: told to end", file=sys.stderr)
        return 143
    except KeyboardInterrupt:
        print("moseg: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # The reader, such as `head`, has what it wanted; Python would complain once more at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"moseg: cannot write the output: {error.strerror or error}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return 0
