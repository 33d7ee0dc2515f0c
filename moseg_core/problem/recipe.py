"""Recipes: problems with a name, kept as TOML so that they can be read, sent and changed.

::

    description = "A narrow handle with a head set across it."
    labels = ["handle", "head"]
    minimize = "3*narrow(handle) + perpendicular(handle, head) + convex_parts"
    seeder = "kmeans"                       # optional, as are labeler and optimizer
    optimizer = "pattern_search(expansion=2)"
    refiner = "graph_cut"                   # none unless it is given
    resolution = 2000                       # optional; or "full"
    restarts = 4                            # optional, as are finalists and polished

What was learned from examples (:mod:`moseg_core.problem.learning`) says from which::

    learned_from = ["cat.off: body, head, 4 leg", "dog.off: body, head, 4 leg, tail"]

A shape that is known to be symmetric, or that is to be unfolded, adds (Sec. 8 and 9)::

    constraints = ["on_plane(head, body)", "mirror(leg2, leg1)"]
    plane = "auto"                          # where the constraints do not say
    embedding = "mds"                       # where the partition lives
    space = "mds"                           # where terms are evaluated that do not say

What is too much for the expression stands in tables, which it names; targets are texts
(:mod:`moseg_core.language.table`)::

    minimize = "is(leg*, given=leg) + separate_parts"

    [given.leg]
    area = "0.06+-0.02"
    thickness = "0.04+-0.01"

Parts are segmented in their turn by recipes of their own, with the same keys, or by one that has
a name (:mod:`moseg_core.problem.hierarchy`). They are given for labels and globs::

    [parts.head]
    labels = ["ear1", "ear2", "skull"]
    minimize = "narrow(ear*) + similar(ear*) + convex_parts"

    [parts."leg*"]
    recipe = "./leg.toml"                   # or the name of an installed one

The members of a kind of shape may differ. Labels then have counts, and all combinations of these
are searched for (:mod:`moseg_core.problem.label_sets`); or the label sets that occur are listed,
and ``labels`` can be left out, since they follow::

    labels = ["torso", "leg{2..4}", "tail{0..1}"]

    variants = [["torso", "leg{4}"], ["torso", "leg{4}", "tail"]]

A recipe for any number of parts has one label with a star, ``labels = ["part*"]``; who uses it says
how many there are (``--parts 5``, :func:`moseg_core.segment_parts`).

A recipe may come from somebody else, so what it can ask for is limited. The recipes of parts are
files of at most 1 MB in its own folder or below, with the suffix ``.toml``; there are at most
:data:`~moseg_core.problem.statement.MOST_LABELS` parts on all levels together, and
:data:`DEEPEST` levels.

Bundles bring recipes through the hook ``moseg_recipes``; anybody else gives a path. A bundle's
recipe means components that its authors knew: the bundle's own, and those of the distributions that
its own one requires.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from moseg_core.components.discovery.registry import Registry, registry
from moseg_core.errors import REPORT, PluginError, UsageError, nearest, shown, unknown
from moseg_core.problem.full_names import meant_by_bundle, statement_in_full
from moseg_core.problem.hierarchy import Hierarchy, expand_parts
from moseg_core.problem.problem import Problem
from moseg_core.problem.statement import KEYS, Statement, check_extent, joined, read_texts
from moseg_core.problem.toml_table import MOST_BYTES, read_table
from moseg_core.problem.variants import Variants
from moseg_core.untrusted.regular_file import read_regular_file

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+\Z", re.ASCII)
_TERM = re.compile(r" (?=\+ )")
DEEPEST = 20
"""Recipes in recipes: levels of parts of parts."""

_LONG = 100
"""More characters than this are written on several lines."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """A statement of a problem with a name.

    Parameters
    ----------
    name : str
    statement : Statement
        Labels, expression, and whatever else is asked for, also of parts.
    description : str
    learned_from : tuple of str
        What each example was that it was learned from, in words; empty where a person wrote it.

    Examples
    --------
    >>> load_recipe("paper_hammer").statement.labels
    ('handle', 'head')
    """

    name: str
    statement: Statement
    description: str = ""
    learned_from: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "learned_from", tuple(self.learned_from))

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the parts of the whole."""
        return self.statement.labels

    @property
    def minimize(self) -> str:
        """The aggregate objective of the whole."""
        return self.statement.minimize

    def problem(self, *, source: Registry | None = None) -> Problem:
        """The problem that the recipe states for the whole shape.

        Raises
        ------
        UsageError, PluginError
            See :class:`moseg_core.Problem`.

        Examples
        --------
        >>> load_recipe("paper_hammer").problem().labels
        ('handle', 'head')
        """
        return Problem.of(self.statement, registry=source)

    def hierarchy(self, *, source: Registry | None = None) -> Hierarchy:
        """The problems for the whole and for its parts, each with its search options.

        Raises
        ------
        UsageError, PluginError
            As for :meth:`problem`.

        Examples
        --------
        >>> load_recipe("paper_hammer").hierarchy().labels
        ('handle', 'head')
        """
        return Hierarchy.of(self.statement, registry=source)

    def hierarchies(self, *, source: Registry | None = None) -> tuple[Hierarchy, ...]:
        """The same for each label set, where labels have counts; else the one of :meth:`hierarchy`.

        Raises
        ------
        UsageError, PluginError
            As for :meth:`problem`.

        Examples
        --------
        >>> stated = Statement(labels=("top", "leg{3..4}"), minimize="flat(top) + narrow(leg*)")
        >>> [len(task.labels) for task in Recipe(name="table", statement=stated).hierarchies()]
        [4, 5]
        """
        return Variants.of(self.statement, source=source).tasks

    def toml(self) -> str:
        r"""The text of the recipe, which :func:`parse_recipe` reads back to the same.

        Examples
        --------
        >>> stated = Statement(labels=("a", "b"), minimize="narrow(a)")
        >>> print(Recipe(name="mine", statement=stated).toml(), end="")
        labels = ["a", "b"]
        minimize = "narrow(a)"
        """
        said = {"description": self.description, "learned_from": list(self.learned_from)}
        described = {key: value for key, value in said.items() if value}
        lines = _toml_lines({**described, **self.statement.document()}, "")
        return "\n".join(lines) + "\n"


def _toml_lines(table: Mapping[str, Any], heading: str) -> list[str]:
    """The lines of a table: its values, then the tables in it, each under its heading."""
    values = {key: value for key, value in table.items() if not isinstance(value, dict)}
    lines = [_toml_line(_toml_key(key), value) for key, value in values.items()]
    if heading and (values or not table):  # a table of tables alone needs no heading of its own
        lines = ["", f"[{heading}]", *lines]
    for key, value in table.items():
        if isinstance(value, dict):
            lines += _toml_lines(value, f"{heading}.{_toml_key(key)}" if heading else key)
    return lines


def _toml_line(key: str, value: Any) -> str:
    r"""A key and its value; what is long on several lines, as a person would write it.

    Examples
    --------
    >>> print(_toml_line("minimize", " + ".join(["narrow(part1)"] * 8)).splitlines()[2])
    + narrow(part1) \
    """
    line = f"{key} = {_toml_value(value)}"
    if len(line) <= _LONG:
        return line
    if isinstance(value, list | tuple):
        return "\n".join([f"{key} = [", *(f"    {_toml_value(item)}," for item in value), "]"])
    if isinstance(value, str) and (terms := _TERM.split(value))[1:]:
        # A line that ends with a backslash goes on with the next one.
        written = " \\\n".join(_toml_value(term)[1:-1] for term in terms)
        return f'{key} = """\n{written}"""'
    return line


def _toml_key(key: str) -> str:
    return key if _BARE_KEY.match(key) else _toml_value(key)


def _toml_value(value: Any) -> str:
    """Texts, numbers and lists of texts are written in TOML as in JSON, but for what is unseen."""
    text = json.dumps(value, ensure_ascii=False)
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in text)


def parse_recipe(text: str, name: str, *, source: Registry | None = None) -> Recipe:
    r"""Read the TOML text of a recipe.

    Parameters
    ----------
    text : str
    name : str
        What to call it in messages.
    source : Registry, optional
        Where to look for recipes that it names for its parts.

    Raises
    ------
    UsageError
        Not TOML, an unknown or missing key, or a value of the wrong kind.

    Examples
    --------
    >>> parse_recipe('labels = ["a"]\nminimize = "narrow(a)"', "mine").labels
    ('a',)
    """
    return _parse(text, name, _Library(registry() if source is None else source))


def load_recipe(name: str, *, source: Registry | None = None) -> Recipe:
    """A recipe by name, or from a ``.toml`` file by path.

    Raises
    ------
    UsageError
        Unknown name, with the nearest; a file that does not exist or is malformed.
    PluginError
        The recipe's bundle is broken.

    Examples
    --------
    >>> load_recipe("paper_hammer").labels
    ('handle', 'head')
    """
    return _Library(registry() if source is None else source).load(name)


@dataclass(frozen=True)
class _Library:
    """Where recipes are found that others name, and which of them are being read.

    Parameters
    ----------
    source : Registry
    folder : Path
        What paths are relative to: the folder of the file that gives them.
    reading : tuple of str
    bundle : str or None
        Whose recipe it is that names others.
    """

    source: Registry
    folder: Path = Path()
    reading: tuple[str, ...] = ()
    bundle: str | None = None

    def load(self, name: str) -> Recipe:
        """A recipe by name or path."""
        if name.endswith(".toml") or "/" in name or "\\" in name:
            path = self._path(name)
            try:
                text = read_regular_file(path, most=MOST_BYTES).decode("utf-8-sig")
            except FileNotFoundError as error:
                near = nearest(path.name, [each.name for each in path.parent.glob("*.toml")])
                instead = f"; did you mean '{path.with_name(near)}'?" if near else ""
                raise UsageError(
                    f"recipe '{name}' cannot be read: there is no such file{instead}"
                ) from error
            except OSError as error:
                raise UsageError(
                    f"recipe '{name}' cannot be read: {error.strerror or error}"
                ) from error
            except UnicodeDecodeError as error:
                raise UsageError(f"recipe '{name}' cannot be read: {error}") from error
            return _parse(text, path.stem, self._within(str(path.resolve()), path.parent))
        component = self.source.find("recipe", name, scope=self.bundle)
        text = component.load()
        if not isinstance(text, str):
            raise PluginError(
                f"recipe '{component.id}' of {component.distribution} is a {type(text).__name__},"
                f" not a text; {REPORT}"
            )
        within = self._within(component.id, Path(), component.bundle)
        recipe = _parse(text, component.spec.name, within)
        meaning = meant_by_bundle(component.bundle, self.source)
        return replace(recipe, statement=statement_in_full(recipe.statement, meaning))

    def _path(self, name: str) -> Path:
        """Where a recipe is: anywhere if a user says so, of a part's in the folder of its whole."""
        path = self.folder / name
        if not self.reading:
            return path
        try:
            inside = path.resolve().is_relative_to(self.folder.resolve())
        except (OSError, ValueError, RuntimeError):  # a NUL in the name, links in a circle
            inside = False
        if not inside or ".." in path.parts or path.suffix != ".toml":
            raise UsageError(
                f"recipe '{self.reading[-1]}' names '{name}' for a part; the recipe of a part is a"
                f" .toml file in the same folder or below, such as './leg.toml', or has the name of"
                f" an installed one"
            )
        return path

    def _within(self, key: str, folder: Path, bundle: str | None = None) -> _Library:
        """The library for the parts of a recipe, which may not name a recipe that it is part of."""
        if key in self.reading:
            raise UsageError(f"recipe '{key}' is among its own parts; parts end somewhere")
        if len(self.reading) > DEEPEST:
            raise UsageError(f"recipe '{key}' is more than {DEEPEST} levels below the whole")
        return _Library(self.source, folder, (*self.reading, key), bundle)


def _parse(text: str, name: str, library: _Library) -> Recipe:
    return _read(read_table(text, name), name, library)


def _read(table: Mapping[str, Any], name: str, library: _Library) -> Recipe:
    for key in table:
        if key not in (allowed := ("description", "learned_from", "parts", *KEYS)):
            raise UsageError(f"recipe '{name}': {unknown('key', key, allowed)}")
    description = _required({"description": ""} | dict(table), "description", name)
    nested = table.get("parts", {})
    try:
        learned_from = read_texts(table, "learned_from") if "learned_from" in table else ()
        statement = Statement.read({key: table[key] for key in KEYS if key in table})
        statement.label_sets()
        if not isinstance(nested, dict):
            raise UsageError(f"'parts' must be tables such as [parts.head]; it is {shown(nested)}")
        expand_parts(nested.items(), statement.declared)
    except UsageError as error:
        raise UsageError(f"recipe '{name}': {error}") from error
    read = [
        (key, _fixed(_read_part(part, joined(name, key), library).statement, joined(name, key)))
        for key, part in nested.items()
    ]
    whole = replace(statement, parts=tuple(expand_parts(read, statement.declared).items()))
    check_extent(whole, f"recipe '{name}'")
    return Recipe(
        name=name,
        statement=whole,
        description=description,
        learned_from=learned_from,
    )


def _fixed(part: Statement, name: str) -> Statement:
    """A part's statement, which must say which parts there are."""
    if part.is_open or (part.has_counts and len(part.label_sets()) > 1):
        raise UsageError(
            f"recipe '{name}' leaves the number of parts open"
            f" ({', '.join(part.labels)}), which only the recipe of the whole may; list them"
        )
    return part.written_out()


def _read_part(table: object, name: str, library: _Library) -> Recipe:
    """The recipe of a part: a table with a recipe's keys, or with the name of one."""
    if not isinstance(table, dict):
        raise UsageError(f"recipe '{name}' must be a table with labels and minimize, or a recipe")
    if "recipe" not in table:
        return _read(table, name, library)
    others = [key for key in table if key != "recipe"]
    if others:
        raise UsageError(f"recipe '{name}': 'recipe' stands alone, without '{others[0]}'")
    return library.load(_required(table, "recipe", name))


def _required(table: Mapping[str, Any], key: str, name: str) -> str:
    if not isinstance(table.get(key), str):
        found = shown(table[key]) if key in table else "missing"
        raise UsageError(f"recipe '{name}': '{key}' must be a text; it is {found}")
    text: str = table[key]
    return text
