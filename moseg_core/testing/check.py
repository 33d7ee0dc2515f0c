"""What a check is: an id, a sentence of why, and a function that complains.

Checks are plain functions of a :class:`Subject`, registered with :func:`check` in the modules of
:mod:`moseg_core.testing.checks`. Their docstrings say why the promise matters. They raise
:class:`ContractFailure`, which says what was done, what came back, what was expected and how to
mend it; everything else that a component raises under a check is reported as a failure of that
check too.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from moseg_core.components.discovery.registry import Component, Registry
from moseg_core.components.discovery.specs import Kind


class ContractFailure(AssertionError):  # noqa: N818  # a failed test, as AssertionError is
    """A component does not do what its kind promises.

    Parameters
    ----------
    did : str
        What was done: "narrow(part) was called twice on the sphere".
    got : str
        What came back.
    expected : str
        What should have.
    fix : str
        How to mend it, as one would tell a colleague.
    """

    def __init__(self, *, did: str, got: str, expected: str, fix: str) -> None:
        self.did, self.got, self.expected, self.fix = did, got, expected, fix
        super().__init__(f"{did}: got {got}, expected {expected}; {fix}")


@dataclass(frozen=True, eq=False, kw_only=True)
class Subject:
    """A component under test.

    Parameters
    ----------
    component : Component
        As it was found through its entry point.
    registry : Registry
        Where it was found, and where it finds others.
    kept : dict
        What checks found out about it and others can use.
    """

    component: Component
    registry: Registry
    kept: dict[str, Any] = field(default_factory=dict, repr=False)

    def keep(self, name: str, compute: Callable[[], Any]) -> Any:
        """A value that several checks need, computed by the first of them."""
        if name not in self.kept:
            self.kept[name] = compute()
        return self.kept[name]

    def load(self) -> Any:
        """The object that the component's target names."""
        return self.component.load()


@dataclass(frozen=True, kw_only=True)
class Check:
    """One promise, and how it is tested.

    Parameters
    ----------
    id : str
        ``objective-in-range``.
    kinds : tuple of Kind
        The kinds of component that make the promise.
    since : int
        The contract (:data:`moseg_core.CONTRACT`) with which it came. A bundle that was written
        for an earlier one is warned, not failed.
    why : str
        A sentence: what goes wrong for users where the promise is broken.
    run : callable
        Receives the subject; raises where it fails. :class:`Skip` where it does not apply.
    gate : bool
        Whether nothing else can be said of a component that fails it: all checks that are no
        gates, and the gates that come later, are then skipped.
    """

    id: str
    kinds: tuple[Kind, ...]
    since: int
    why: str
    run: Callable[[Subject], None]
    gate: bool = False


class Skip(Exception):  # noqa: N818  # nothing went wrong
    """The check does not apply to this component; says why."""


CHECKS: dict[str, Check] = {}
"""All checks by id that were registered so far; see :func:`moseg_core.testing.load_checks`."""


def check(
    id: str, *, kinds: Sequence[Kind], why: str = "", since: int = 1, gate: bool = False
) -> Callable[[Callable[[Subject], None]], Callable[[Subject], None]]:
    """Register a function as a check.

    Parameters
    ----------
    id, kinds, why, since, gate
        See :class:`Check`. Where `why` is not given, the function's docstring says it.

    Returns
    -------
    callable
        A decorator that returns the function unchanged.

    Raises
    ------
    ValueError
        The id is taken.
    """

    def decorate(function: Callable[[Subject], None]) -> Callable[[Subject], None]:
        if id in CHECKS:
            raise ValueError(f"there are two checks with the id '{id}'")
        reason = why or _sentence(inspect.getdoc(function) or "")
        CHECKS[id] = Check(
            id=id, kinds=tuple(kinds), since=since, why=reason, run=function, gate=gate
        )
        return function

    return decorate


def _sentence(docstring: str) -> str:
    """A docstring in one line, as it reads after a colon.

    >>> _sentence("Shapes lie as they were scanned.")
    'shapes lie as they were scanned'
    """
    words = " ".join(docstring.split()).rstrip(".")
    return words[:1].lower() + words[1:]
