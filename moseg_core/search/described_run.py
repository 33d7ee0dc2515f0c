"""What makes a run the one that it is, as plain data.

Two runs with the same description do the same: the shape, what is asked for, how it is searched,
where it begins, and the components and libraries that take part, with their versions. So a run can
be gone on with from a record of another (:mod:`moseg_core.search.answer_record`) if their
descriptions are equal, and if they are not it can be told why not (:func:`differences`). Left out
is what makes no difference to the result, the number of processes; and the limit on time, which
each sitting has for itself.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from importlib import metadata
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.protocols import Centers
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.settings import CHOSEN_KINDS, RECIPE_OPTIONS, SearchOptions
from moseg_core.search.alignment import Alignment
from moseg_core.search.answer_record import one_run
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape

#: Libraries whose versions may change the last digits of a cost.
_LIBRARIES = ("numpy", "scipy", "numba")


def run_of(
    shape: Shape,
    tasks: Callable[[], Sequence[Hierarchy]],
    options: SearchOptions,
    *,
    asked: Any = None,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
) -> AbstractContextManager[None]:
    """A context for a run, which checks that a record in use is of this one.

    Parameters
    ----------
    shape : Shape
    tasks : callable
        Gives all that are searched for.
    options : SearchOptions
    asked : plain data, optional
        What was asked for, where that says more than the tasks.
    start, freeze, pins
        As for :func:`moseg_core.segment`.

    Raises
    ------
    UsageError
        The record is of another run; says what differs.
    """
    return one_run(
        lambda: described(
            shape, tasks(), options, asked=asked, start=start, freeze=freeze, pins=pins
        )
    )


def described(
    shape: Shape,
    tasks: Sequence[Hierarchy],
    options: SearchOptions,
    *,
    asked: Any = None,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
) -> dict[str, Any]:
    """The description of a run; see :func:`run_of`.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> task = moseg.Hierarchy(moseg.Problem(["a", "b"], "narrow(a)"))
    >>> found = described(hammer, [task], moseg.SearchOptions(seed=3))
    >>> found["problem"], found["search"]["seed"], sorted(found["components"])[:2]
    ([{'labels': ['a', 'b'], 'minimize': 'narrow(a)'}], 3, ['basic:narrow', 'core:hungarian'])
    """
    return {
        "shape": {"geometry": shape.fingerprint, "as read": repr(shape.key[1:])},
        "problem": [task.statement.document() for task in tasks] if asked is None else asked,
        "search": _search(options),
        "start": _start(start),
        "freeze": sorted(freeze),
        "pins": {name: digest_of(numbers) for name, numbers in (pins or {}).items()},
        "components": _components(tasks, options),
        "libraries": {name: metadata.version(name) for name in _LIBRARIES},
    }


def _search(options: SearchOptions) -> dict[str, Any]:
    said: dict[str, Any] = {}
    for name in RECIPE_OPTIONS:
        value = getattr(options, name)
        said[name] = str(value) if isinstance(value, Choice) else value
    return said | {
        "settings": options.settings,
        "seed": int(options.seed),
        "ignore_pieces_below": options.ignore_pieces_below,
    }


def _start(start: Centers | Result | Alignment | None) -> str | None:
    """A digest of where a run begins; None where it seeds."""
    if start is None:
        return None
    centers = start if isinstance(start, Centers) else start.centers
    labels: list[str] = []
    if isinstance(start, Result):
        labels = list(start.problem.labels)
    elif isinstance(start, Alignment):
        labels = list(start.labels)
    parts = () if centers.parts is None else centers.parts
    return digest_of(centers.positions, centers.weights, parts, labels)


def _components(tasks: Iterable[Hierarchy], options: SearchOptions) -> dict[str, str]:
    """Of each component that takes part the distribution and its version."""
    found: dict[str, str] = {}
    for task in tasks:
        for _, level in task.levels():
            found |= level.problem.versions
            settled, registry = options.settled(level.search), level.problem.registry
            for kind in CHOSEN_KINDS:
                choice: Choice | None = getattr(settled, kind)
                if choice is not None:
                    component = prepare(choice, kind, registry).component
                    found[component.id] = component.distribution
    return dict(sorted(found.items()))


def digest_of(*arrays: Any) -> str:
    """Sixteen hexadecimal digits that equal arrays share."""
    digest = hashlib.sha256()
    for array in map(np.asarray, arrays):
        digest.update(f"{array.dtype.kind}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:16]


def differences(there: Any, here: Any, name: str = "") -> Iterator[str]:
    """Where two descriptions differ: a line for each place.

    Parameters
    ----------
    there, here : plain data
    name : str
        Of the place.

    Examples
    --------
    >>> list(differences({"search": {"seed": 1, "restarts": None}},
    ...                  {"search": {"seed": 2, "restarts": None}}))
    ['search seed was 1 and is 2']
    """
    if isinstance(there, Mapping) and isinstance(here, Mapping):
        for key in dict.fromkeys([*there, *here]):
            yield from differences(there.get(key), here.get(key), f"{name} {key}".strip())
    elif isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        for k, (old, new) in enumerate(zip(there, here, strict=True)):
            numbered = f"{name} {k + 1}" if len(there) > 1 else name
            yield from differences(old, new, numbered)
    elif there != here:
        yield f"{_short(name)} was {_short(there)} and is {_short(here)}"


def _short(value: Any) -> str:
    text = "not said" if value is None else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
