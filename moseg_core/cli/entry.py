"""Running a command: errors as messages and exit codes."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext

from moseg_core.cli.collection import at_exit, importing
from moseg_core.cli.overview import overview_of
from moseg_core.cli.streams import prepare_streams, show_warnings
from moseg_core.cli.waiting import waiting
from moseg_core.errors import MosegError, Terminated, UsageError
from moseg_core.untrusted.terminal import printable_message

#: Commands that import so much that a terminal is told at once that something goes on.
_SLOW_TO_START = (
    *(
        "segment",
        "batch",
        "learn",
        "tune",
        "view",
        "render",
        "explain",
        "evaluate",
        "field",
        "benchmark",
    ),
)
NO_PLUGINS = "--no-plugins"
"""What any command takes: nothing is imported then but the core's own components."""

_VARIABLE = "MOSEG_NO_PLUGINS"
#: Commands that people give many shapes.
_OF_ONE_SHAPE = ("tune", "view", "render", "explain", "field")


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
        interrupted, 143 when told to end by SIGTERM, 129 by SIGHUP.
    """
    if arguments is None:  # a process of its own
        prepare_streams()
        show_warnings(_tell)
        at_exit()
    with _plugins_as_asked(list(sys.argv[1:] if arguments is None else arguments)) as rest:
        code = _run(rest, own=arguments is None)
    if arguments is None:
        _leave_threads(code)
    sys.exit(code)


def _leave_threads(code: int) -> None:
    """End the process where threads of components would keep it for as long as they like."""
    threading = sys.modules.get("threading")
    if threading is None:
        return
    ours = threading.main_thread()
    left = [t.name for t in threading.enumerate() if t is not ours and not t.daemon]
    if left:
        said = f"warning: threads of components go on: {', '.join(left)}"
        print(f"moseg: {printable_message(said)}", file=sys.stderr)
        sys.stderr.flush()
        os._exit(code)


@contextmanager
def _plugins_as_asked(arguments: list[str]) -> Iterator[list[str]]:
    """The arguments without ``--no-plugins``; while this lasts, it is obeyed, also by children."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    if NO_PLUGINS not in arguments[:end]:
        yield arguments
        return
    before = os.environ.get(_VARIABLE)
    os.environ[_VARIABLE] = "1"
    try:
        yield [a for k, a in enumerate(arguments) if k >= end or a != NO_PLUGINS]
    finally:
        if before is None:
            del os.environ[_VARIABLE]
        else:
            os.environ[_VARIABLE] = before


def _tell(text: str) -> None:
    """Print a message; what that needs is imported where there is one."""
    from moseg_core.cli.console import message

    message(text)


def _obey(arguments: Sequence[str], *, own: bool) -> None:
    """Do what is asked; the parser, and what the command needs, are imported for it alone.

    In a process of its own a component that crashes should not take the command along.

    Raises
    ------
    MosegError
        As the command does; a :class:`~moseg_core.errors.UsageError` where the parser does not
        understand the arguments.
    """
    overview = overview_of(arguments, sys.stdout)
    if overview is not None:
        print(overview)
        return
    known = arguments[0] in _SLOW_TO_START
    with importing(), waiting("starting", quiet=not known or "--quiet" in arguments):
        from cyclopts import CycloptsError, UnusedCliTokensError

        from moseg_core.cli.app import app

    if not arguments[0].startswith("-") and arguments[0] not in app:
        from moseg_core.cli.foreign import add_foreign_command

        add_foreign_command(arguments[0])
    from moseg_core.components.at_work import crashes_apart
    from moseg_core.components.side_effects import own_program

    tell = _quiet if "--quiet" in arguments else _tell_of_printing
    try:
        command, bound, _ = app.parse_args(arguments, exit_on_error=False, print_error=False)
        with own_program(tell), crashes_apart() if own else nullcontext():
            command(*bound.args, **bound.kwargs)
    except UnusedCliTokensError as error:
        raise UsageError(_left_over(arguments[0], error.unused_tokens or [])) from error
    except CycloptsError as error:
        words = " ".join(str(error).split())
        raise UsageError(f"{words} (see 'moseg --help')") from error


def _tell_of_printing(who: str, text: str) -> None:
    """Say that a component prints, which is left out."""
    from moseg_core.cli.console import message
    from moseg_core.components.faults import safe_repr

    message(f"warning: {who} prints on standard output: {safe_repr(text.strip())}; left out")


def _quiet(who: str, text: str) -> None:
    """Say nothing of it."""


def _left_over(command: str, words: Sequence[str]) -> str:
    """The message about words that a command has no use for."""
    more = ", ".join(f"'{word}'" for word in words[:3]) + (", ..." if len(words) > 3 else "")
    if command == "segment":
        return (
            f"'segment' takes one shape at a time, and has no use for {more}; for many there is"
            f" 'batch', such as: moseg batch 'models/*.off' --recipe NAME -o out"
        )
    if command in _OF_ONE_SHAPE:
        return (
            f"'{command}' takes one shape at a time, and has no use for {more}; for many write a"
            f' loop, such as: for f in *.ply; do moseg {command} "$f" ... ; done'
        )
    return f"'{command}' has no use for {more} (see 'moseg {command} --help')"


def _run(arguments: list[str], *, own: bool) -> int:
    code = _code_of(arguments, own=own)
    try:
        sys.stdout.flush()
    except OSError as error:
        # Python would complain once more at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        # A reader, such as `head`, that is gone has what it wanted.
        if code == 0 and not isinstance(error, BrokenPipeError):
            return _told_of_system(error)
    return code


def _code_of(arguments: list[str], *, own: bool) -> int:
    """Do what is asked; its exit code, what went wrong told."""
    try:
        _obey(arguments, own=own)
    except MosegError as error:
        print(f"moseg: {printable_message(str(error))}", file=sys.stderr)
        return error.exit_code
    except Terminated as ended:
        print("moseg: told to end", file=sys.stderr)
        return ended.exit_code
    except KeyboardInterrupt:
        print("moseg: interrupted", file=sys.stderr)
        return 130
    except MemoryError:
        print("moseg: there is not enough memory for that", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 0
    except OSError as error:
        return _told_of_system(error)
    return 0


def _told_of_system(error: OSError) -> int:
    """Say what the system refuses; the exit code of that."""
    what = "cannot write the output" if error.filename is None else f"'{error.filename}'"
    said = f"{what}: {error.strerror or error}"
    print(f"moseg: {printable_message(said)}", file=sys.stderr)
    return 1
