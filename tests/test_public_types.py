"""The types in the signatures of public names are public themselves, so that callers can name them.

Whoever writes a function that takes what :func:`moseg_core.segment` takes, or that passes on what
a shape or a result holds, needs the names of those types from the public face: submodules may move.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import types
import typing
from collections.abc import Iterator
from typing import Any

import pytest

import moseg_core
import moseg_core.types

#: Types that a caller need not name, and why.
NEED_NO_NAME = {
    "BoundTerm": "a term with its objectives found: made and read within the core",
    "Checkpoint": "what `checkpointing` yields: its counts are read, it is never made by a caller",
    "Constraints": "the problem's constraints as one: made and read within the core",
    "Expression": "what text was read into: a caller writes the text",
    "FunctionConstraint": "what the decorator makes: a Constraint",
    "FunctionObjective": "what the decorator makes: an Objective",
    "Labellings": "where an array of parts reads: made and read within the core",
    "Lookup": "how a part finds measures and fields: given by the core",
    "Memo": "the values that a run remembers: given by the core",
    "OptionValues": "the arguments of `segment` as a TypedDict: for `**options` alone",
    "PartTables": "what the parts of a labelling share: made and read within the core",
    "SettledOptions": "what search options come to: made and read within the core",
    "Summary": "a part's sums before they are asked for: made and read within the core",
    "UnaryCosts": "the cost matrix: its fields are read, it is never made by a caller",
}


def public() -> list[Any]:
    return [getattr(moseg_core, name) for name in moseg_core.__all__]


def functions_of(thing: Any) -> Iterator[Any]:
    """What of a public name has annotations that a caller meets."""
    if not inspect.isclass(thing):
        yield from [thing] if inspect.isfunction(thing) else []
        return
    yield thing
    for name, member in vars(thing).items():
        if not name.startswith("_") or name in ("__call__", "__getitem__", "__init__"):
            member = getattr(member, "fget", None) or getattr(member, "func", None) or member
            member = getattr(member, "__func__", member)
            if inspect.isfunction(member):
                yield member


def classes() -> dict[str, Any]:
    """Classes of the core by name, for annotations that are imported for type checkers alone."""
    rooms = [m.name for m in pkgutil.walk_packages(moseg_core.__path__, "moseg_core.")]
    modules = [importlib.import_module(name) for name in rooms if not name.endswith("__main__")]
    return {
        name: value
        for module in modules
        for name, value in vars(module).items()
        if inspect.isclass(value) and value.__module__ == module.__name__
    }


def types_in(annotation: Any) -> Iterator[type]:
    """The classes of the core that an annotation is made of."""
    if isinstance(annotation, list | tuple):
        for piece in annotation:
            yield from types_in(piece)
    elif isinstance(annotation, type) and not isinstance(annotation, types.GenericAlias):
        if annotation.__module__.startswith("moseg_core"):
            yield annotation
    else:
        yield from types_in(typing.get_args(annotation))


def types_met(thing: Any, known: dict[str, Any]) -> Iterator[type]:
    names = dict(
        vars(moseg_core.types) | known, Self=Any, trimesh=types.SimpleNamespace(Trimesh=Any)
    )
    for function in functions_of(thing):
        # A module's own names come first: two classes of the core may be called alike.
        own = vars(inspect.getmodule(function))
        missing = {name: value for name, value in names.items() if name not in own}
        hints = typing.get_type_hints(function, localns=missing)
        for annotation in hints.values():
            yield from types_in(annotation)


@pytest.fixture(scope="module")
def met() -> set[type]:
    known = classes()
    return {kind for thing in public() for kind in types_met(thing, known)}


def test_types_in_public_signatures_are_public(met):
    hidden = {kind.__name__ for kind in met if kind not in public()}
    assert hidden - set(NEED_NO_NAME) == set()


def test_no_excuse_is_left_over(met):
    assert set(NEED_NO_NAME) <= {kind.__name__ for kind in met if kind not in public()}


def test_classes_are_found_within_any_annotation():
    from moseg_core import Choice, Part, Report

    def asks(a: dict[str, list[Part]] | None, b: Report, *, c: str | Choice = "d") -> None: ...

    assert {kind.__name__ for kind in types_met(asks, {"Part": Part, **locals()})} == {
        "Part",
        "Progress",
        "Choice",
    }


@pytest.mark.parametrize("name", ["Arity", "CostClass", "Invariance", "Requirement"])
def test_the_words_that_traits_are_made_of_are_public(name):
    hints = typing.get_type_hints(moseg_core.Traits)
    words = typing.get_args(getattr(moseg_core, name))
    assert words
    assert any(str(words)[1:-1] in str(annotation) for annotation in hints.values())
