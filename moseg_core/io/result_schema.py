"""What a result file holds, said as a schema, and checked before anything is made of it.

A result travels, and whoever gets one may not know where it has been. What it says is printed,
drawn and written into other files, so each value is what it should be or the file is refused:
a text has no characters that a terminal obeys, a number is finite, a label is a label. What is not
in the schema is passed over, since a later version may have written it.

A schema is a function that takes a value and the path to it, and raises; or a dictionary of
schemas by key, those that end in ``?`` optional; or a list of one schema, which holds for all
items.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias, Union

from moseg_core.errors import UsageError
from moseg_core.language import parse
from moseg_core.untrusted.terminal import printable

Schema: TypeAlias = Union[Callable[[Any, str], None], "Mapping[str, Schema]", "list[Schema]"]


def check_schema(value: Any, schema: Schema, where: str = "") -> None:
    """Refuse a value that a schema does not allow.

    Parameters
    ----------
    value : plain data
    schema : Schema
    where : str
        The path to the value, for the message.

    Raises
    ------
    ValueError
        Says where, what stands there and what should.

    Examples
    --------
    >>> check_schema({"cost": {"value": None}}, {"cost": {"value": number}})
    Traceback (most recent call last):
        ...
    ValueError: 'cost.value' must be a finite number, not None
    """
    if isinstance(schema, Mapping):
        if not isinstance(value, dict):
            raise _unlike(where, "an object", value)
        for key, below in schema.items():
            name = key.removesuffix("?")
            if name in value:
                check_schema(value[name], below, f"{where}.{name}" if where else name)
            elif name == key:
                raise ValueError(f"'{where}.{name}' is missing" if where else f"no '{name}'")
    elif isinstance(schema, list):
        if not isinstance(value, list):
            raise _unlike(where, "a list", value)
        for k, item in enumerate(value):
            check_schema(item, schema[0], f"{where}[{k}]")
    else:
        schema(value, where)


def number(value: Any, where: str) -> None:
    """A number that a float can be."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not _finite(value):
        raise _unlike(where, "a finite number", value)


def number_or_null(value: Any, where: str) -> None:
    """The same, or null where there is none."""
    if value is not None:
        number(value, where)


def count(value: Any, where: str) -> None:
    """A whole number from 0 on, of 63 bits."""
    if type(value) is not int or not 0 <= value < 2**63:
        raise _unlike(where, "a whole number from 0 on", value)


def any_text(value: Any, where: str) -> None:
    """A text, such as the name of a file, which may hold anything."""
    if not isinstance(value, str):
        raise _unlike(where, "a text", value)


def text(value: Any, where: str) -> None:
    """A text for people: printable, on one line."""
    any_text(value, where)
    if not value.isprintable():
        raise _unlike(where, "a printable text", value)


def term(value: Any, where: str) -> None:
    """A term of an expression, with the path of its level in front where that is not the whole."""
    text(value, where)
    path, _, call = value.rpartition(": ")
    try:
        alone = len(parse(call).terms) == 1 and all(map(_is_word, path.split("/") if path else ()))
    except UsageError:
        alone = False
    if not alone:
        raise _unlike(where, "a term such as 'narrow(a)'", value)


def text_or_number(value: Any, where: str) -> None:
    """A text for people, or a finite number."""
    (text if isinstance(value, str) else number)(value, where)


def texts_by_name(value: Any, where: str) -> None:
    """An object whose keys and values are texts; some values are numbers."""
    if not isinstance(value, dict):
        raise _unlike(where, "an object", value)
    for key, below in value.items():
        text(key, where)
        text_or_number(below, f"{where}.{key}")


def stages(value: Any, where: str) -> None:
    """Lists of records by the names of stages."""
    if not isinstance(value, dict):
        raise _unlike(where, "an object", value)
    for name, records in value.items():
        text(name, where)
        if not isinstance(records, list):
            raise _unlike(f"{where}.{name}", "a list", records)
        for k, record in enumerate(records):
            _record(record, f"{where}.{name}[{k}]")


def _record(value: Any, where: str) -> None:
    """Numbers by name, where null is one that is not finite; or lists of them."""
    if not isinstance(value, dict):
        raise _unlike(where, "an object", value)
    for key, below in value.items():
        text(key, where)
        _numbers(below, f"{where}.{key}")


def _numbers(value: Any, where: str) -> None:
    if isinstance(value, list):
        for item in value:
            _numbers(item, where)
    else:
        number_or_null(value, where)


def flag(value: Any, where: str) -> None:
    """True or false."""
    if not isinstance(value, bool):
        raise _unlike(where, "true or false", value)


def text_or_null(value: Any, where: str) -> None:
    """A text for people, or null where there is none."""
    if value is not None:
        text(value, where)


_CENTER: Schema = {"center": [number], "weight": number}
_DETAIL: Schema = {
    "name": text,
    "value": number,
    "cost": number,
    "expected": text_or_null,
    "percent": flag,
}
_TERM: Schema = {
    "term": term,
    "objective": text,
    "weight": number,
    "worst": number_or_null,
    "calls": [{"labels": [text], "value": number_or_null, "details?": [_DETAIL]}],
}

RESULT: Schema = {
    "shape": {"name": any_text, "file?": any_text, "elements": count, "fingerprint": any_text},
    "problem": {"labels": [text], "levels?": [{"path": text, "labels": [text]}]},
    "cost": {"value": number, "empty": [text], "broken_pins": count},
    "terms": [_TERM],
    "parts": [{"center": [number], "weight": number, "more?": [_CENTER]}],
    "method": texts_by_name,
    "dimension?": {"free?": count, "all?": count},
    "seed": count,
    "reason": text,
    "warnings": [text],
    "versions": texts_by_name,
    "history": stages,
}
"""A result, but for its labels, of which there are too many to be looked at one by one."""


def _finite(value: float) -> bool:
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def _is_word(label: str) -> bool:
    return label.isascii() and label.replace("_", "a").isalnum()


def _unlike(where: str, what: str, value: Any) -> ValueError:
    shown = printable(repr(value), longest=60)
    return ValueError(f"'{printable(where, longest=100)}' must be {what}, not {shown}")
