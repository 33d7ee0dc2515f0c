"""What a user asks for, as plain data: one statement of a problem (Sec. 3, 8 and 9; Fig. 8).

A problem is stated by the same few things wherever it is written down: names of the labels, the
aggregate objective, constraints on the centres, the plane they need, an embedding and the space
in which terms are evaluated, tables that calls name, how the search is to be done, and the same
again for parts that are segmented in their turn. A :class:`Statement` holds them as they were
written. It is read from a recipe (:mod:`moseg_core.problem.recipe`), from a result
(:mod:`moseg_core.io.result_json`) or from the command line (:mod:`moseg_core.cli.request`), and
written to each of them. Two statements that are equal ask for the same, and
:meth:`Statement.digest` tells in a few characters whether they do.

A statement may be *open*: one of its labels, ``part*``, stands for as many as whoever asks wants
(:meth:`Statement.with_parts`). Or its labels have counts, ``leg{2..5}``, and it stands for a
problem for each of several label sets (:mod:`moseg_core.problem.label_sets`). A statement that is
neither is *closed*.

No name is looked up here: that is what a :class:`~moseg_core.problem.problem.Problem` is made for,
and so a statement can be read, shown and compared where its bundles are not installed.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from moseg_core.components.chosen import Choice
from moseg_core.errors import UsageError, shown, unknown
from moseg_core.language import Table
from moseg_core.problem.label_sets import (
    LabelSet,
    declared_labels,
    is_counted,
    label_sets,
    labels_of_variants,
    set_text,
)
from moseg_core.problem.settings import CHOSEN_KINDS, RECIPE_OPTIONS, Method, check_method

_LABEL = re.compile(r"\w+\Z", re.ASCII)
# A digit before the star would run into the numbers: leg2* would be leg21, leg22 and so on.
_OPEN_LABEL = re.compile(r"\w*[A-Za-z_]\*\Z", re.ASCII)

MOST_LABELS = 1000
"""Labels of a statement, those of parts of parts counted too."""

LONGEST_LABEL = 200
"""Characters of a label."""

SEPARATOR = "/"
"""Between the labels of a path; no label contains it."""

KEYS = (
    "labels",
    "variants",
    "minimize",
    "constraints",
    "plane",
    "embedding",
    "space",
    "given",
    *RECIPE_OPTIONS,
)
"""What a statement of one level is made of, by the names that recipes and results use."""


@dataclass(frozen=True, kw_only=True)
class Statement:
    """A problem as it was asked for.

    Parameters
    ----------
    labels : tuple of str
        Names of the parts; one may end with ``*`` (see :attr:`is_open`), or some may have counts
        (see :attr:`has_counts`). Without any they follow from the variants.
    variants : tuple of tuple of str
        The label sets that occur, where labels have counts and not all combinations do.
    minimize : str
        The aggregate objective.
    constraints : tuple of str
        Calls such as ``"mirror(leg2, leg1)"``.
    plane : str or None
        For constraints that need a plane and are not given one.
    embedding : Choice or None
        Where the partition lives.
    space : str or None
        Where terms are evaluated that do not say.
    given : Table
        Tables by the names that calls have for them; any mapping is read as one.
    search : Method
        How it is to be solved, as far as that is said: components, resolution, starts.
    parts : tuple of (str, Statement)
        For labels whose part is segmented in its turn.

    Examples
    --------
    >>> stated = Statement.read({"labels": ["a", "b"], "minimize": "narrow(a)", "restarts": 2})
    >>> stated.document()
    {'labels': ['a', 'b'], 'minimize': 'narrow(a)', 'restarts': 2}
    >>> Statement.read(stated.document()) == stated
    True
    """

    labels: tuple[str, ...] = ()
    variants: tuple[tuple[str, ...], ...] = ()
    minimize: str
    constraints: tuple[str, ...] = ()
    plane: str | None = None
    embedding: Choice | None = None
    space: str | None = None
    given: Table = field(default_factory=Table)
    search: Method = field(default_factory=Method)
    parts: tuple[tuple[str, Statement], ...] = ()

    def __post_init__(self) -> None:
        for name in ("labels", "constraints", "parts"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        object.__setattr__(self, "given", check_tables(self.given))
        object.__setattr__(self, "variants", tuple(map(tuple, self.variants)))
        if self.variants and not self.labels:
            object.__setattr__(self, "labels", labels_of_variants(self.variants))
        check_method(self.search, "a statement's search")
        for kind in CHOSEN_KINDS:
            choice = getattr(self.search, kind)
            if choice is not None and choice.target is not None:
                raise UsageError(
                    f"{kind} '{choice.name}' is not installed, and a statement is a text that"
                    f" others read; give the class to segment instead"
                )

    @classmethod
    def read(cls, table: Mapping[str, Any]) -> Statement:
        """A statement from plain data, as TOML and JSON hold it; inverse of :meth:`document`.

        Parameters
        ----------
        table : mapping
            ``labels``, or ``variants`` in their place, and ``minimize``; others of :data:`KEYS`
            where they say something; ``parts`` by label.

        Raises
        ------
        UsageError
            An unknown or missing key, or a value of the wrong kind.
        """
        for key in table:
            if key not in (*KEYS, "parts"):
                raise UsageError(unknown("key", key, (*KEYS, "parts")))
        constraints = read_texts(table, "constraints") if "constraints" in table else ()
        embedding = table.get("embedding")
        variants = _lists(table, "variants") if "variants" in table else ()
        return cls(
            labels=() if variants and "labels" not in table else read_texts(table, "labels"),
            variants=variants,
            minimize=_text(table, "minimize"),
            constraints=constraints,
            plane=_text(table, "plane") if "plane" in table else None,
            embedding=None if embedding is None else Choice.read(embedding, "embedding"),
            space=_text(table, "space") if "space" in table else None,
            given=check_tables(table.get("given")),
            search=Method(**{key: table[key] for key in RECIPE_OPTIONS if key in table}),
            parts=tuple((label, cls.read(part)) for label, part in table.get("parts", {}).items()),
        )

    def document(self) -> dict[str, Any]:
        """The same as plain data, what says nothing left out; parts under ``"parts"``."""
        follow = self.variants and self.labels == labels_of_variants(self.variants)
        said: dict[str, Any] = {
            "labels": list(self.labels),
            "variants": [list(variant) for variant in self.variants],
            "minimize": self.minimize,
            "constraints": list(self.constraints),
            "plane": self.plane,
            "embedding": None if self.embedding is None else _written(self.embedding),
            "space": self.space,
        }
        for key in RECIPE_OPTIONS:
            value = getattr(self.search, key)
            said[key] = _written(value) if isinstance(value, Choice) else value
        said["given"] = self.given.document()
        said["parts"] = {label: part.document() for label, part in self.parts}
        always = ("minimize",) if follow else ("labels", "minimize")
        if follow:
            del said["labels"]
        # Of the options 0 says something: no result is polished.
        return {
            key: value
            for key, value in said.items()
            if value or key in always or (key in RECIPE_OPTIONS and value is not None)
        }

    @property
    def is_open(self) -> bool:
        """Whether the number of parts is still to be said."""
        return any("*" in label for label in self.labels)

    @property
    def has_counts(self) -> bool:
        """Whether labels have counts, or variants are listed: it may stand for several label sets.

        Examples
        --------
        >>> Statement(labels=("torso", "leg{2..4}"), minimize="narrow(leg*)").has_counts
        True
        """
        return bool(self.variants) or any(map(is_counted, self.labels))

    @property
    def declared(self) -> LabelSet:
        """All names that the labels can stand for, in whichever label set."""
        return declared_labels(check_label_names(self.labels, may_be_open=True))

    def label_sets(self) -> tuple[LabelSet, ...]:
        """The label sets that it stands for: one where no label has a count.

        Raises
        ------
        UsageError
            Malformed labels, too many sets, or variants that the labels do not allow.

        Examples
        --------
        >>> stated = Statement(labels=("torso", "leg{1..2}"), minimize="narrow(leg*)")
        >>> stated.label_sets()
        (('torso', 'leg1'), ('torso', 'leg1', 'leg2'))
        """
        for variant in self.variants:
            check_label_names(variant, may_be_open=True)
        labels = check_label_names(self.labels, may_be_open=True)
        if self.is_open and self.has_counts:
            raise UsageError(
                f"labels have a star or counts, not both: {', '.join(labels)}; write"
                f" 'leg{{2..5}}' for numbers of legs that occur, 'part*' for any number of parts"
            )
        return label_sets(labels, self.variants)

    def written_out(self) -> Statement:
        """The same with the labels' counts written out, where there is a single label set.

        Raises
        ------
        UsageError
            There are several.

        Examples
        --------
        >>> Statement(labels=("top", "leg{3}"), minimize="flat(top)").written_out().labels
        ('top', 'leg1', 'leg2', 'leg3')
        """
        if not self.has_counts:
            return self
        sets = self.label_sets()
        if len(sets) > 1 or sets[0] != self.declared:
            raise UsageError(
                f"the labels {', '.join(self.labels)} stand for {len(sets)} label sets; try them"
                f" all, with segment_variants(shape, recipe) in Python, or name one, such as"
                f""" --labels "{set_text(sets[-1], self.labels)}\""""
            )
        return replace(self, labels=sets[0], variants=())

    def with_parts(self, count: int) -> Statement:
        """The same for a certain number of parts, the open label numbered from 1.

        Parameters
        ----------
        count : int
            Of all parts together.

        Raises
        ------
        UsageError
            The number of parts is fixed, there are too few for the labels, or these are malformed.

        Examples
        --------
        >>> Statement(labels=("body", "leg*"), minimize="narrow(leg*)").with_parts(4).labels
        ('body', 'leg1', 'leg2', 'leg3')
        """
        labels = check_label_names(self.labels, may_be_open=True)
        if self.has_counts:
            raise UsageError(
                f"the labels {', '.join(labels)} say which numbers of parts are tried; do not say"
                f" how many there are, or name the labels: --labels"
            )
        if not self.is_open:
            raise UsageError(
                f"the number of parts is fixed by the labels {', '.join(labels)}; do not say how"
                f" many there are, or give one label with a star, such as part*"
            )
        if count > MOST_LABELS:
            raise UsageError(f"there are at most {MOST_LABELS} parts, not {count}")
        numbered = count - len(labels) + 1
        if numbered < 1:
            raise UsageError(
                f"{count} parts are too few for the labels {', '.join(labels)}; give"
                f" {len(labels)} or more"
            )
        several = {
            label: [f"{label[:-1]}{k + 1}" for k in range(numbered)]
            for label in labels
            if label.endswith("*")
        }
        return replace(
            self, labels=tuple(name for label in labels for name in several.get(label, [label]))
        )

    def digest(self) -> str:
        """Sixteen hexadecimal digits that equal statements share."""
        text = json.dumps(self.document(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def levels(self, path: str = "") -> Iterator[tuple[str, Statement]]:
        """Every level with its path, "" for the whole; a part after what it is a part of."""
        yield path, self
        for label, part in self.parts:
            yield from part.levels(joined(path, label))

    def alone(self) -> Statement:
        """The first level, without its parts."""
        return replace(self, parts=())


def check_label_names(labels: Sequence[str], *, may_be_open: bool = False) -> tuple[str, ...]:
    """The labels as a tuple, or a UsageError that says which is malformed or repeated.

    Parameters
    ----------
    labels : sequence of str
    may_be_open : bool
        Whether one label may end with ``*``, for a number of parts that is still to be said, and
        labels may have counts.

    Examples
    --------
    >>> check_label_names(["a", "b", "a"])
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: label 'a' is given twice; labels are distinct names
    """
    if isinstance(labels, str):
        raise UsageError(f"labels must be a list of names, not the text '{labels}'")
    if not isinstance(labels, Iterable):
        raise UsageError(f"labels must be a list of names, not {labels!r}")
    names = tuple(labels)
    if not names:
        raise UsageError("a problem needs at least one label")
    if len(names) > MOST_LABELS:
        raise UsageError(f"a problem has at most {MOST_LABELS} labels, not {len(names)}")
    for name in names:
        if isinstance(name, str) and len(name) > LONGEST_LABEL:
            raise UsageError(
                f"label '{name[:20]}...' has {len(name)} characters; labels have at most"
                f" {LONGEST_LABEL}"
            )
        is_open = isinstance(name, str) and _OPEN_LABEL.match(name)
        counted = is_counted(name)
        if not is_open and not counted and not (isinstance(name, str) and _LABEL.match(name)):
            raise UsageError(
                f"label {name!r} is not allowed; labels are made of letters, digits and '_'"
                + (", and may have a count: 'leg{4}', 'leg{2..5}'" if may_be_open else "")
            )
        if counted and not may_be_open:
            raise UsageError(
                f"label '{name}' has a count, which only the labels of a recipe or --labels may;"
                f" Statement.label_sets() in Python has the labels that it stands for"
            )
        if is_open and not may_be_open:
            raise UsageError(
                f"label '{name}' stands for any number of parts; say how many there are"
                f" altogether: --parts 5, or segment_parts(shape, 5) in Python"
            )
        if names.count(name) > 1:
            raise UsageError(f"label '{name}' is given twice; labels are distinct names")
    declared_labels(names)
    if sum(name.endswith("*") for name in names) > 1:
        raise UsageError(f"one label may end with '*', not several: {', '.join(names)}")
    return names


def check_extent(statement: Statement, whose: str) -> None:
    """Refuse a statement with more labels on all levels together than anybody could look at.

    Parameters
    ----------
    statement : Statement
        Whose parts were checked before.
    whose : str
        For the message.

    Raises
    ------
    UsageError
        There are more than :data:`MOST_LABELS`; a part that several labels have counts for each.

    Examples
    --------
    >>> part = Statement(labels=("a", "b"), minimize="flat(a)")
    >>> check_extent(Statement(labels=("c",), minimize="flat(c)", parts=(("c", part),)), "mine")
    """
    count = sum(len(level.declared) for _, level in statement.levels())
    if count > MOST_LABELS:
        raise UsageError(
            f"{whose} has {count} parts on all levels together; the most is {MOST_LABELS}"
        )


def check_tables(given: Mapping[str, Any] | None) -> Table:
    """Tables by name, from plain data or as they are; or a UsageError that says what is none.

    Examples
    --------
    >>> check_tables({"leg": {"area": "0.06±0.02"}})["leg"]
    Table({'area': Target(value=0.06, spread=0.02)})
    """
    if given is not None and not isinstance(given, Mapping):
        raise UsageError(f"'given' must be tables such as [given.leg]; it is {given!r:.60}")
    tables = given if isinstance(given, Table) else Table(given)
    for name, table in tables.items():
        if not isinstance(table, Table):
            raise UsageError(f"'given' must be tables such as [given.{name}]; {name!r} is {table}")
    return tables


def joined(path: str, label: str) -> str:
    """The path of a label at the end of another path.

    Examples
    --------
    >>> joined("", "head"), joined("head", "ear1")
    ('head', 'head/ear1')
    """
    return f"{path}{SEPARATOR}{label}" if path else label


def _written(choice: Choice) -> str:
    """A component as text, the same for equal ones: parameters in the order of their names."""
    return str(Choice(choice.name, dict(sorted(choice.parameters.items()))))


def _text(table: Mapping[str, Any], key: str) -> str:
    if not isinstance(table.get(key), str):
        raise UsageError(f"'{key}' must be a text; it is {_found(table, key)}")
    text: str = table[key]
    return text


def read_texts(table: Mapping[str, Any], key: str) -> tuple[str, ...]:
    """The list of texts that stands under a key.

    Raises
    ------
    UsageError
        There is no such key, or something else stands there.

    Examples
    --------
    >>> read_texts({"labels": ["a", "b"]}, "labels")
    ('a', 'b')
    """
    given = table.get(key)
    if not isinstance(given, list | tuple):
        raise UsageError(f"'{key}' must be a list of texts; it is {_found(table, key)}")
    for item in given:
        if not isinstance(item, str):
            raise UsageError(f"'{key}' must be a list of texts; {shown(item)} is none")
    return tuple(given)


def _lists(table: Mapping[str, Any], key: str) -> tuple[tuple[str, ...], ...]:
    given = table[key]
    if not isinstance(given, list | tuple):
        raise UsageError(f"'{key}' must be a list of lists of texts; it is {shown(given)}")
    for item in given:
        if not isinstance(item, list | tuple) or not all(isinstance(name, str) for name in item):
            raise UsageError(f"'{key}' must be a list of lists of texts; {shown(item)} is none")
        if not item:
            raise UsageError(f"'{key}': a problem needs at least one label; one of them has none")
    return tuple(map(tuple, given))


def _found(table: Mapping[str, Any], key: str) -> str:
    return shown(table[key]) if key in table else "missing"
