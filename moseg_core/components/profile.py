"""Where the time goes: seconds and calls by stage, term and component, for whoever asks.

Whoever wants to know opens a :func:`profiling` context; what is worth being told apart is wrapped
in :func:`timed`, which does next to nothing where nobody asks::

    with profiling() as profile:
        segment(shape, problem)
    profile.entries["term", "narrow(handle)", "moseg-objectives-basic 0.1.0"].seconds

Times are those of the thing itself: of a seeder that asks for the cost of a partition, the seconds
of partition and terms are theirs and not the seeder's. Stages are counted apart from what happens
within them, so that each group adds up by itself. Other processes keep their own accounts, which
nobody collects; so a search is profiled in one process.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Literal, ParamSpec, TypeVar

Group = Literal["stage", "component", "term"]

P = ParamSpec("P")
T = TypeVar("T")

_NOTHING = nullcontext()


@dataclass
class Entry:
    """How often and how long something went on.

    Parameters
    ----------
    calls : int
    seconds : float
        Without what was timed within it.
    """

    calls: int = 0
    seconds: float = 0.0


@dataclass(eq=False)
class Profile:
    """Seconds and calls so far.

    Parameters
    ----------
    clock : callable
        The time in seconds.
    entries : dict
        For each group, name and source (the distribution that it comes from, "" for stages) its
        entry.
    """

    clock: Callable[[], float] = time.perf_counter
    entries: dict[tuple[Group, str, str], Entry] = field(default_factory=dict)
    #: By whether they are stages the seconds to be left out of each thing that is going on.
    _within: dict[bool, list[float]] = field(default_factory=lambda: {True: [], False: []})

    @contextmanager
    def timed(self, group: Group, name: str, source: str, calls: int) -> Iterator[None]:
        """Count what happens in this context, as so many calls."""
        within = self._within[group == "stage"]
        within.append(0.0)
        began = self.clock()
        try:
            yield
        finally:
            seconds = self.clock() - began
            entry = self.entries.setdefault((group, name, source), Entry())
            entry.calls += calls
            entry.seconds += seconds - within.pop()
            if within:
                within[-1] += seconds

    def of(self, group: Group) -> list[tuple[str, str, Entry]]:
        """Name, source and entry of all of a group, the longest first."""
        found = [(name, source, e) for (g, name, source), e in self.entries.items() if g == group]
        return sorted(found, key=lambda each: (-each[2].seconds, each[0]))

    def by_source(self) -> dict[str, Entry]:
        """Calls and seconds of all terms and components of a distribution, the longest first."""
        sums: dict[str, Entry] = {}
        for (group, _, source), entry in self.entries.items():
            if group != "stage":
                found = sums.setdefault(source, Entry())
                found.calls += entry.calls
                found.seconds += entry.seconds
        return dict(sorted(sums.items(), key=lambda each: (-each[1].seconds, each[0])))


_profile: ContextVar[Profile | None] = ContextVar("moseg_profile", default=None)


def is_profiling() -> bool:
    """Whether somebody counts, which is done in one process."""
    return _profile.get() is not None


def timed(
    group: Group, name: str, source: str = "", *, calls: int = 1
) -> AbstractContextManager[None]:
    """A context whose time is counted, where somebody asks for it.

    Parameters
    ----------
    group : {"stage", "component", "term"}
    name, source : str
        What goes on, and the distribution that it comes from.
    calls : int
        How many calls are made at once.
    """
    profile = _profile.get()
    return _NOTHING if profile is None else profile.timed(group, name, source, calls)


def stage(name: str) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """A decorator for functions that are a stage of a search.

    Parameters
    ----------
    name : str
    """

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        @functools.wraps(function)
        def counted(*arguments: P.args, **options: P.kwargs) -> T:
            with timed("stage", name):
                return function(*arguments, **options)

        return counted

    return decorate


@contextmanager
def profiling(clock: Callable[[], float] = time.perf_counter) -> Iterator[Profile]:
    """Within this context, all that is :func:`timed` is counted.

    Parameters
    ----------
    clock : callable
        The time in seconds.

    Examples
    --------
    >>> with profiling(clock=iter([0.0, 1.0, 3.0, 10.0]).__next__) as profile:
    ...     with timed("component", "seeder", "acme 1.0"), timed("term", "narrow(a)", "acme 1.0"):
    ...         pass
    >>> [(name, entry.seconds) for name, _, entry in profile.of("component") + profile.of("term")]
    [('seeder', 8.0), ('narrow(a)', 2.0)]
    """
    profile = Profile(clock)
    token = _profile.set(profile)
    try:
        yield profile
    finally:
        _profile.reset(token)
