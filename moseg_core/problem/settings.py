"""Which components a run uses, how finely and how often it searches.

How fine and how often to search belongs to the method too. What it leaves open is decided by the
*settings*: ``paper`` is the method as published, ``default`` what measurements on horses and
hammers recommend (``benchmarks/stages.py``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.specs import Kind
from moseg_core.errors import UsageError, unknown


@dataclass(frozen=True, kw_only=True)
class Method:
    """The components of a run (Sec. 4 to 7); the defaults are the paper's.

    Parameters
    ----------
    parameterization, seeder, labeler, optimizer : Choice
    resolution : int, "full" or None
        Number of super-elements to search on; None leaves it to the settings.
    restarts : int or None
        Number of starts; None leaves it to the settings.
    finalists : int or None
        How many of them go on to the end; None leaves it to the settings.
    """

    parameterization: Choice = Choice("voronoi")
    seeder: Choice = Choice("kmeans")
    labeler: Choice = Choice("hungarian")
    optimizer: Choice = Choice("pattern_search")
    resolution: int | str | None = None
    restarts: int | None = None
    finalists: int | None = None


SETTINGS = ("default", "paper")
"""What decides where the request and the recipe do not."""

_KINDS: tuple[Kind, ...] = ("parameterization", "seeder", "labeler", "optimizer")
_DEFAULT_RESOLUTION = 2000
_DEFAULT_RESTARTS = 8
_DEFAULT_FINALISTS = 2
_DEFAULT_EVOLUTION = {"population": 20, "iterations": 6}


def settled(method: Method, settings: str) -> Method:
    """The method with nothing left open.

    Parameters
    ----------
    method : Method
    settings : str
        ``paper``: the method's components with the paper's parameters, which are their own
        defaults, one start, full resolution. ``default``: 2000 super-elements and eight starts, two
        of which go on to the end, where the method does not say otherwise; one start where it
        limits the evaluations.

    Raises
    ------
    UsageError
        Unknown settings.

    Examples
    --------
    >>> found = settled(Method(seeder=Choice("evolution", {"population": 9})), "paper")
    >>> str(found.seeder), found.resolution, found.restarts
    ('evolution', 'full', 1)
    >>> settled(Method(restarts=2), "default").restarts
    2
    """
    if settings not in SETTINGS:
        raise UsageError(unknown("settings", settings, SETTINGS))
    if settings == "paper":
        plain = {kind: Choice(getattr(method, kind).name) for kind in _KINDS}
        return Method(**plain, resolution="full", restarts=1, finalists=1)
    limited = method.optimizer.parameters.get("max_evaluations") is not None
    return replace(
        method,
        resolution=_DEFAULT_RESOLUTION if method.resolution is None else method.resolution,
        restarts=method.restarts or (1 if limited else _DEFAULT_RESTARTS),
        finalists=method.finalists or _DEFAULT_FINALISTS,
    )


def tuned(choice: Choice, settings: str) -> Choice:
    """A component under the settings, which decide where it comes without parameters.

    Examples
    --------
    >>> str(tuned(Choice("evolution"), "default")), str(tuned(Choice("evolution"), "paper"))
    ('evolution(population=20, iterations=6)', 'evolution')
    """
    name = choice.name.removeprefix("core:")
    if settings == "default" and name == "evolution" and not choice.parameters:
        return Choice(choice.name, _DEFAULT_EVOLUTION)
    return choice


def read_resolution(given: object) -> int | str:
    """A number of super-elements, or "full".

    Raises
    ------
    UsageError
        Anything else.

    Examples
    --------
    >>> read_resolution("2000"), read_resolution("full")
    (2000, 'full')
    """
    if given == "full":
        return "full"
    if isinstance(given, str) and given.isdecimal():
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, int) or given < 1:
        raise UsageError(
            f"the resolution must be 'full' or a number of super-elements, such as 2000, not"
            f" {given!r}"
        )
    return given


def read_restarts(given: object) -> int:
    """A number of starts, as a number or in digits.

    Raises
    ------
    UsageError
        Anything else.
    """
    return _read_count(given, "start")


def read_finalists(given: object) -> int:
    """How many of the starts go on to the end, as a number or in digits.

    Raises
    ------
    UsageError
        Anything else.
    """
    return _read_count(given, "finalist")


def _read_count(given: object, what: str) -> int:
    if isinstance(given, str) and given.isdecimal():
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, int):
        raise UsageError(f"the number of {what}s must be a whole number, not {given!r}")
    if given < 1:
        raise UsageError(f"there must be at least one {what}, not {given}")
    return given
