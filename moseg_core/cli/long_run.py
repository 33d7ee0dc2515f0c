"""``--checkpoint`` and ``--resume``: a run that may be stopped, and gone on with later."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.cli.flags import CheckpointFlags
from moseg_core.errors import UsageError
from moseg_core.io.checkpoint import checkpointing

#: Seconds from one time that the checkpoint is written to the next, unless the user says.
_EVERY = 30.0


def checkpoint_path(flags: CheckpointFlags, others: Sequence[Path] = ()) -> Path | None:
    """The file that the checkpoint goes to; None where none is wanted.

    Parameters
    ----------
    flags : CheckpointFlags
    others : sequence of Path
        What the run reads or writes besides.

    Raises
    ------
    UsageError
        The options contradict each other, or there is nothing to go on from.

    Examples
    --------
    >>> checkpoint_path(CheckpointFlags()) is None
    True
    >>> checkpoint_path(CheckpointFlags(checkpoint=Path("horse.checkpoint"))).name
    'horse.checkpoint'
    """
    path = flags.resume if flags.checkpoint is None else flags.checkpoint
    every = flags.checkpoint_every
    if path is None:
        if every is not None:
            raise UsageError(
                "--checkpoint-every says how often, and not where; add --checkpoint FILE"
            )
        return None
    if flags.resume is not None and flags.resume != path and not flags.resume.exists():
        raise UsageError(f"--resume: there is no '{flags.resume}'")
    if flags.checkpoint is None and not path.exists():
        raise UsageError(
            f"--resume: there is no '{path}'; begin with --checkpoint {shlex.quote(str(path))}"
        )
    if every is not None and not every > 0:
        raise UsageError(f"--checkpoint-every must be a number of seconds above 0, not {every}")
    for other in others:
        if path == other or (path.exists() and other.exists() and path.samefile(other)):
            raise UsageError(f"'{path}' cannot be both the checkpoint and something else")
    return path


@contextmanager
def keeping_checkpoint(flags: CheckpointFlags, path: Path | None, *, quiet: bool) -> Iterator[None]:
    """Within this context the search keeps a checkpoint, where one is wanted.

    Parameters
    ----------
    flags : CheckpointFlags
    path : Path or None
        From :func:`checkpoint_path`.
    quiet : bool
        Whether nothing is said of it.

    Raises
    ------
    UsageError, MosegError
        See :func:`moseg_core.checkpointing`.
    """
    if path is None:
        yield
        return
    every = _EVERY if flags.checkpoint_every is None else flags.checkpoint_every
    with checkpointing(path, resume=flags.resume, every=every) as checkpoint:

        def tell() -> None:
            if checkpoint.known:
                message(f"going on from {checkpoint.known} answers in {flags.resume}", quiet=quiet)
            if checkpoint.damaged:
                message(
                    f"warning: lines of {flags.resume} that are damaged: {checkpoint.damaged};"
                    " what they knew is computed again",
                    quiet=quiet,
                )

        checkpoint.on_begin = tell  # not of a checkpoint that is refused
        yield


def how_to_go_on(path: Path) -> str:
    """What a user can do about a run that was stopped.

    Examples
    --------
    >>> how_to_go_on(Path("horse.checkpoint"))
    'to go on: the same command with --resume horse.checkpoint instead of --checkpoint'
    """
    return (
        f"to go on: the same command with --resume {shlex.quote(str(path))} instead of --checkpoint"
    )
