"""One set of search options: which components, how finely, how often, how long (Sec. 5 to 7).

A recipe may say how its problem is solved, a :class:`Method`, with some of it left open. A caller's
:class:`SearchOptions` say the same, and what belongs to one run besides.
:meth:`SearchOptions.settled` puts the two together, once, and fills in the rest by the *settings*:
``paper`` is the method as published, ``default`` what measurements on horses and hammers recommend
(``benchmarks/speed_jobs/stages.py``). Parameters for ``default`` a component names itself
(``presets`` in :mod:`moseg_core.components.protocols`). All that comes after
(:mod:`moseg_core.search`) reads the settled options and decides nothing of this again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from numbers import Integral, Real
from typing import Any, Self, TypedDict

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.specs import Kind
from moseg_core.errors import UsageError, shown, unknown

SETTINGS = ("default", "paper")
"""What decides where neither the request nor the recipe does."""

SEARCH_KINDS: tuple[Kind, ...] = ("parameterization", "seeder", "labeler", "optimizer")
"""The kinds of component of which every search uses one."""

CHOSEN_KINDS: tuple[Kind, ...] = (*SEARCH_KINDS, "refiner")
"""The kinds of component that a request or a recipe may choose; without a refiner none is used."""

RECIPE_OPTIONS = (*CHOSEN_KINDS, "resolution", "restarts", "finalists", "polished")
"""The options that belong to how a problem is solved, whoever solves it: a recipe may hold them."""

ComponentChoice = str | Mapping[str, Any] | Choice | Callable[..., Any] | None
"""A component as a caller names it: ``"kmeans"``, ``"pattern_search(expansion=2)"``, a table; or a
class or factory that is not installed."""

NO_REFINER = "none"
"""In the place of a refiner: boundaries stay as the search leaves them, whatever a recipe says."""

_DEFAULT_RESOLUTION = 2000
_DEFAULT_RESTARTS = 8
_DEFAULT_FINALISTS = 2
_DEFAULT_POLISHED = 2


class OptionValues(TypedDict, total=False):
    """The fields of :class:`SearchOptions` as keyword arguments, for functions that take them."""

    parameterization: ComponentChoice
    seeder: ComponentChoice
    labeler: ComponentChoice
    optimizer: ComponentChoice
    refiner: ComponentChoice
    resolution: int | str | None
    restarts: int | str | None
    finalists: int | str | None
    polished: int | str | None
    settings: str
    seed: int
    max_seconds: float | None
    workers: int
    ignore_pieces_below: float | str


@dataclass(frozen=True, kw_only=True)
class SettledOptions:
    """Search options with nothing left open; see :class:`SearchOptions`.

    There is a refiner only where one was asked for, and a limit on time likewise.
    """

    parameterization: Choice
    seeder: Choice
    labeler: Choice
    optimizer: Choice
    refiner: Choice | None
    resolution: int | str
    restarts: int
    finalists: int
    polished: int
    settings: str
    seed: int
    max_seconds: float | None
    workers: int
    ignore_pieces_below: float

    def check_resolution(self, n_labels: int, where: str = "") -> None:
        """Refuse a resolution with fewer super-elements than there are labels.

        Parameters
        ----------
        n_labels : int
        where : str
            Path of the level that the labels belong to, for the message.

        Raises
        ------
        UsageError
            It is too low.
        """
        if self.resolution != "full" and int(self.resolution) < n_labels:
            of = f" of '{where}'" if where else ""
            raise UsageError(
                f"a resolution of {self.resolution} is too low for the {n_labels} labels{of}"
            )


@dataclass(frozen=True, kw_only=True)
class Method:
    """How a problem is solved, whoever solves it: what a recipe may say. None leaves a matter open.

    Values are read and checked when the method is made: components become
    :class:`~moseg_core.components.chosen.Choice` objects, digits become numbers.

    Parameters
    ----------
    parameterization, seeder, labeler, optimizer : str, mapping, Choice or class, optional
        Components: ``"pattern_search(expansion=2)"``, or a class that is not installed.
    refiner : str, mapping, Choice or class, optional
        A component that moves boundaries once the search is over; ``"none"`` for none.
    resolution : int or "full", optional
        Number of super-elements on which to seed and search, where the shape has more than 1.5
        times as many elements.
    restarts : int, optional
        Number of starts.
    finalists : int, optional
        How many of the starts, the best after a while, go on to the end.
    polished : int, optional
        How many of the results on super-elements, the best of them, are searched for a little
        longer on finer ones; 0 for none, as where a refiner moves all boundaries anyway.

    Raises
    ------
    UsageError
        A value that makes no sense; says which is allowed.

    Examples
    --------
    >>> method = Method(optimizer="pattern_search(expansion=2)", restarts="3")
    >>> str(method.optimizer), method.restarts, method.seeder
    ('pattern_search(expansion=2)', 3, None)
    """

    parameterization: ComponentChoice = None
    seeder: ComponentChoice = None
    labeler: ComponentChoice = None
    optimizer: ComponentChoice = None
    refiner: ComponentChoice = None
    resolution: int | str | None = None
    restarts: int | str | None = None
    finalists: int | str | None = None
    polished: int | str | None = None

    def __post_init__(self) -> None:
        for kind in CHOSEN_KINDS:
            given = getattr(self, kind)
            if given is not None:
                object.__setattr__(self, kind, Choice.read(given, kind))
        if self.resolution is not None:
            object.__setattr__(self, "resolution", _resolution(self.resolution))
        for name, counted, least in (
            ("restarts", "start", 1),
            ("finalists", "finalist", 1),
            ("polished", "polished result", 0),
        ):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _count(getattr(self, name), counted, least=least))

    def over(self, other: Method) -> Self:
        """The same where it says something, and another where it leaves a matter open.

        Examples
        --------
        >>> found = Method(restarts=2).over(Method(restarts=9, seeder="evolution"))
        >>> found.restarts, str(found.seeder)
        (2, 'evolution')
        """
        still_open = [name for name in RECIPE_OPTIONS if getattr(self, name) is None]
        return replace(self, **{name: getattr(other, name) for name in still_open})


def check_method(method: object, whose: str) -> None:
    """Refuse what is no method, or says what belongs to a run.

    Parameters
    ----------
    method : object
    whose : str
        For the message: "a statement's search".

    Raises
    ------
    UsageError
        Something else; names the class to use.
    """
    if not isinstance(method, Method) or isinstance(method, SearchOptions):
        raise UsageError(
            f"{whose} must be a Method, such as recipe.statement.search, not {method!r:.60};"
            f" settings, seed, seconds and workers belong to the run"
        )


@dataclass(frozen=True, kw_only=True)
class SearchOptions(Method):
    """A method, and what belongs to one run of it.

    Parameters
    ----------
    settings : str
        What decides where the rest does not: ``default``, or ``paper`` for the paper's parameters,
        one start and full resolution.
    seed : int
        Of the random generator; the same seed gives the same result.
    max_seconds : float, optional
        Ends the search after about this time.
    workers : int
        Number of processes to share the starts among.
    ignore_pieces_below : float or str
        Share of the area, as a number from 0 to 1 or as ``"0.1%"``: connected pieces with less are
        left out of the search (:mod:`moseg_core.search.pieces`).

    Raises
    ------
    UsageError
        A value that makes no sense; says which is allowed.
    """

    settings: str = "default"
    seed: int = 0
    max_seconds: float | None = None
    workers: int = 1
    ignore_pieces_below: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.settings not in SETTINGS:
            raise UsageError(unknown("settings", str(self.settings), SETTINGS))
        _check_seed(self.seed)
        _check_seconds(self.max_seconds)
        if isinstance(self.workers, str):
            raise UsageError(f"the number of workers must be a whole number, not {self.workers!r}")
        object.__setattr__(self, "workers", _count(self.workers, "worker"))
        object.__setattr__(self, "ignore_pieces_below", _share(self.ignore_pieces_below))

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> SearchOptions:
        """The options of a function that takes them as keyword arguments.

        Raises
        ------
        UsageError
            There is no such option; names the nearest.
        """
        known = [field.name for field in fields(cls)]
        for name in values:
            if name not in known:
                raise UsageError(unknown("option", name, known))
        return cls(**values)

    def settled(self, recipe: Method | None = None) -> SettledOptions:
        """The options with nothing left open but the limit on time.

        Parameters
        ----------
        recipe : Method, optional
            What the recipe says, where these options do not. Under ``paper`` only its components
            count, without parameters: the paper's are their own defaults. A recipe's refiner does
            not: the paper has none.

        Examples
        --------
        >>> recipe = Method(seeder="evolution(population=9)")
        >>> found = SearchOptions(settings="paper").settled(recipe)
        >>> str(found.seeder), found.resolution, found.restarts
        ('evolution', 'full', 1)

        One start where the evaluations are limited: the limit is better spent on one.

        >>> SearchOptions().settled().restarts
        8
        >>> SearchOptions(optimizer="pattern_search(max_evaluations=20)").settled().restarts
        1
        """
        said = Method() if recipe is None else recipe
        if self.settings == "paper":
            plain: Any = {
                kind: replace(choice, parameters={})
                for kind in SEARCH_KINDS
                if (choice := getattr(said, kind)) is not None
            }
            said = Method(resolution="full", restarts=1, finalists=1, **plain)
        found = self.over(said).over(_DEFAULT_COMPONENTS)
        values: Any = {f.name: getattr(found, f.name) for f in fields(found)}
        if values["refiner"] is not None and values["refiner"].name == NO_REFINER:
            values["refiner"] = None
        limited = values["optimizer"].parameters.get("max_evaluations") is not None
        left_open = {
            "resolution": _DEFAULT_RESOLUTION,
            "restarts": 1 if limited else _DEFAULT_RESTARTS,
            "finalists": _DEFAULT_FINALISTS,
            "polished": _DEFAULT_POLISHED,
        }
        for name, default in left_open.items():
            if values[name] is None:
                values[name] = default
        return SettledOptions(**values)


_MOST = {"start": 10_000, "finalist": 10_000, "polished result": 10_000}
"""Of some things there are so many at most: all of them are made before the first is used."""
_DIGITS = 18
"""Of a number in a text."""


def _resolution(given: object) -> int | str:
    """A number of super-elements, or "full"."""
    if given == "full":
        return "full"
    if isinstance(given, str) and given.isdecimal() and len(given) <= _DIGITS:
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, Integral) or given < 1:
        raise UsageError(
            f"the resolution must be 'full' or a number of super-elements, such as 2000, not"
            f" {shown(given)}"
        )
    return int(given)


def _count(given: object, what: str, *, least: int = 1) -> int:
    """A number of things of which there are so many at least."""
    if isinstance(given, str) and given.isdecimal() and len(given) <= _DIGITS:
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, Integral):
        raise UsageError(f"the number of {what}s must be a whole number, not {shown(given)}")
    if given < least:
        if least == 0:
            raise UsageError(f"the number of {what}s must be 0 or more, not {shown(given)}")
        raise UsageError(f"there must be at least one {what}, not {shown(given)}")
    if int(given) > _MOST.get(what, int(given)):
        raise UsageError(f"there are at most {_MOST[what]} {what}s, not {shown(given)}")
    return int(given)


def _share(given: object) -> float:
    """A share of the area, from a number or a text such as "0.1%"."""
    found: object = given
    if isinstance(given, str):
        text, percent = given.strip().removesuffix("%"), given.strip().endswith("%")
        try:
            found = float(text) / (100 if percent else 1)
        except ValueError:
            found = None
    if isinstance(found, bool) or not isinstance(found, Real) or not 0 <= float(found) < 1:
        raise UsageError(
            "the share of the area below which pieces are ignored must be from 0 to 1, or a"
            f" percentage such as 0.1%, not {given!r}"
        )
    return float(found)


def _check_seconds(given: object) -> None:
    if given is None:
        return
    if isinstance(given, bool) or not isinstance(given, Real):
        raise UsageError(f"the limit on seconds must be a number, not {given!r}")
    if not 0 <= float(given) < math.inf:
        raise UsageError(
            f"the limit on seconds must be finite and not negative, and is {given}; leave it out"
            f" for none"
        )


def _check_seed(seed: object) -> None:
    if isinstance(seed, bool) or not isinstance(seed, Integral):
        raise UsageError(f"the seed must be a whole number, not {seed!r}")
    if int(seed) < 0:
        raise UsageError(f"the seed must not be negative, and is {seed}")


# Full ids, which no other bundle can make ambiguous.
_DEFAULT_COMPONENTS = Method(
    parameterization="core:voronoi",
    seeder="core:kmeans",
    labeler="core:hungarian",
    optimizer="core:pattern_search",
)
