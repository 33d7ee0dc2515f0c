"""What became of one shape of a batch, and of all of them.

An outcome is of one *kind* (:data:`KINDS`). ``ok`` has a result; each other kind says whose doing
the failure is: the shape's, the request's for this shape, a component's, or that of the machine's
limits. Outcomes are plain data: they come from other processes and machines, and are the rows of
the ledger (:mod:`moseg_core.batching.ledger`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from moseg_core.errors import UsageError

Kind = Literal[
    "ok",
    "bad shape",
    "usage",
    "plugin error",
    "crashed",
    "timeout",
    "out of memory",
    "failed",
]
"""``bad shape``: it cannot be read, or not be used with this problem. ``usage``: what was asked for
makes no sense for this shape. ``plugin error``: a component raised, or broke its promises.
``crashed``: the process died. ``timeout``, ``out of memory``: a limit. ``failed``: the rest, such
as a disk that is full."""

KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of one shape.

    Parameters
    ----------
    shape : str
        Path as it was given.
    key : str
        Of the job (:func:`moseg_core.batching.jobs.job_key`).
    kind : str
        One of :data:`KINDS`.
    message : str
        What went wrong, in one line; empty where nothing did.
    component : str
        What was at work when the process died or had to be ended; empty where that is not known.
    files : tuple of str
        What was written, as seen from the batch's folder; the result (.json) comes first.
    cost : float or None
        Of the result.
    parts : tuple of str
        Its labels, those of empty parts left out.
    warnings : tuple of str
        What the result and the shape's reader say.
    seconds : float
        How long it took, start-up of a process left out.

    Examples
    --------
    >>> outcome = Outcome(shape="a.off", key="0f", kind="timeout", message="took more than 5 s")
    >>> outcome.ok, Outcome.read(outcome.document()) == outcome
    (False, True)
    """

    shape: str
    key: str
    kind: Kind
    message: str = ""
    component: str = ""
    files: tuple[str, ...] = ()
    cost: float | None = None
    parts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def ok(self) -> bool:
        """Whether there is a result."""
        return self.kind == "ok"

    def document(self) -> dict[str, Any]:
        """The same as plain data, what says nothing left out."""
        always = ("shape", "key", "kind")
        plain = {k: list(v) if isinstance(v, tuple) else v for k, v in asdict(self).items()}
        if plain["seconds"] == 0.0:
            del plain["seconds"]
        return {k: v for k, v in plain.items() if k in always or v not in (None, "", [])}

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> Outcome:
        """Inverse of :meth:`document`; what a later version adds is passed over.

        Raises
        ------
        UsageError
            It is no outcome.
        """
        known = {name: document[name] for name in cls.__dataclass_fields__ if name in document}
        for name in ("files", "parts", "warnings"):
            value = known.get(name, [])
            if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
                raise UsageError(f"'{name}' must be a list of texts, not {value!r:.60}")
            known[name] = tuple(value)
        for name in ("shape", "key", "kind", "message", "component"):
            if not isinstance(known.get(name, ""), str):
                raise UsageError(f"'{name}' must be a text, not {known[name]!r:.60}")
        for name in ("cost", "seconds"):
            value = known.get(name, 0.0)
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise UsageError(f"'{name}' must be a number, not {value!r:.60}")
        if known.get("kind") not in KINDS or "shape" not in known or "key" not in known:
            raise UsageError(f"an outcome has a shape, a key and a kind out of {', '.join(KINDS)}")
        return cls(**known)


@dataclass(frozen=True, kw_only=True)
class BatchResult:
    """What became of a batch.

    Parameters
    ----------
    folder : Path
        Where the results and the ledger are.
    outcomes : mapping of str to Outcome
        By the shapes' paths, in the order in which these were given; those that were done before
        and kept are among them. Shapes that were never begun are not.
    total : int
        How many shapes there are.
    stopped : bool
        Whether somebody asked to stop before all were begun.
    page : Path or None
        The page of the batch, where one was made.
    """

    folder: Path
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    total: int = 0
    stopped: bool = False
    page: Path | None = None

    @property
    def counts(self) -> dict[str, int]:
        """How many there are of each kind that occurs, in the order of :data:`KINDS`."""
        kinds = [outcome.kind for outcome in self.outcomes.values()]
        return {kind: kinds.count(kind) for kind in KINDS if kind in kinds}

    @property
    def failed(self) -> tuple[Outcome, ...]:
        """Those without a result."""
        return tuple(outcome for outcome in self.outcomes.values() if not outcome.ok)


@dataclass(frozen=True, kw_only=True)
class BatchProgress:
    """How far a batch is.

    Parameters
    ----------
    total : int
        How many shapes there are.
    kept : int
        Those that an earlier run had done.
    counts : mapping of str to int
        Outcomes of this run by kind.
    at_work : tuple of str
        Shapes that were handed out and are not done.
    seconds : float
        Since this run began.
    news : tuple of Outcome
        What has come in since the last report; first of all what an earlier run had done.
    """

    total: int
    kept: int
    counts: Mapping[str, int]
    at_work: tuple[str, ...]
    seconds: float
    news: tuple[Outcome, ...] = ()

    @property
    def done(self) -> int:
        """Shapes with an outcome."""
        return self.kept + sum(self.counts.values())

    @property
    def seconds_left(self) -> float | None:
        """About how long the rest will take; None before the first outcome of this run.

        Examples
        --------
        >>> BatchProgress(total=9, kept=1, counts={"ok": 2}, at_work=(), seconds=4.0).seconds_left
        12.0
        """
        new = self.done - self.kept
        return None if new == 0 else self.seconds / new * (self.total - self.done)
