"""Names of labels and of kinds: ``leg1`` and ``leg2`` are both of the kind ``leg``.

People number what is alike, so a number at the end of a name, and what joins it to the name, does
not tell kinds apart. Where it should, as of fingers that are the first and the second, the learner
is told so (``numbers="different"``).

A recipe's labels are made of letters, digits and ``_``; a name that has other characters, as a node
of a scene may, gets ``_`` in their place.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from moseg_core import UsageError, unknown

NUMBERS = ("alike", "different")
"""Whether names that differ in their numbers name one kind, or several."""

_NUMBERED = re.compile(r"(.*?[A-Za-z])[_ .-]*[0-9]+\Z", re.DOTALL)


def check_numbers(numbers: str) -> str:
    """The word, if it is one of :data:`NUMBERS`.

    Raises
    ------
    UsageError
        Another word, with the nearest.
    """
    if numbers not in NUMBERS:
        raise UsageError(unknown("value of 'numbers'", numbers, NUMBERS))
    return numbers


def kind_of(name: str, *, numbers: str = "alike") -> str:
    """The kind that a label is of, as a recipe may call it.

    Parameters
    ----------
    name : str
    numbers : {"alike", "different"}
        Whether a number at the end of the name is passed over.

    Raises
    ------
    UsageError
        Nothing of the name is left.

    Examples
    --------
    >>> kind_of("leg2"), kind_of("left wing"), kind_of("front_leg_1")
    ('leg', 'left_wing', 'front_leg')
    >>> kind_of("finger2", numbers="different")
    'finger2'
    """
    numbered = _NUMBERED.match(name) if numbers == "alike" else None
    kind = re.sub(r"\W+", "_", numbered[1] if numbered else name, flags=re.ASCII).strip("_")
    if not kind:
        raise UsageError(
            f"the name {name!r} has no letter or digit that a label could be called by; rename it"
        )
    return kind


def labels_of(kind: str, most: int) -> tuple[str, ...]:
    """Labels for the parts of a kind of which a shape has at most so many.

    Examples
    --------
    >>> labels_of("leg", 2), labels_of("head", 1), labels_of("finger1", 2)
    (('leg1', 'leg2'), ('head',), ('finger1_1', 'finger1_2'))
    """
    if most == 1:
        return (kind,)
    return tuple(f"{stem(kind)}{k + 1}" for k in range(most))


def stem(kind: str) -> str:
    """What stands before the number in the labels of a kind.

    Examples
    --------
    >>> stem("leg"), stem("finger1")
    ('leg', 'finger1_')
    """
    return f"{kind}_" if kind[-1].isdigit() else kind


def argument(kind: str, labels: Sequence[str], others: Iterable[str]) -> str:
    """The labels of a kind as they stand in a call: a glob, or a list where it would catch others.

    Parameters
    ----------
    kind : str
    labels : sequence of str
        Those of the kind.
    others : iterable of str
        All other labels of the recipe.

    Examples
    --------
    >>> argument("leg", ["leg1", "leg2"], ["body"]), argument("head", ["head"], ["header"])
    ('leg*', 'head')
    >>> argument("leg", ["leg1", "leg2"], ["legroom"])
    'leg1, leg2'
    """
    if len(labels) == 1:
        return labels[0]
    caught = any(other.startswith(stem(kind)) for other in others)
    return ", ".join(labels) if caught else f"{stem(kind)}*"
