"""Recipes: problems with a name, kept as TOML so that they can be read, sent and changed.

::

    description = "A narrow handle with a head set across it."
    labels = ["handle", "head"]
    minimize = "3*narrow(handle) + perpendicular(handle, head) + convex_parts"
    seeder = "kmeans"                       # optional, as are labeler and optimizer
    optimizer = "pattern_search(expansion=2)"
    resolution = 2000                       # optional; or "full"
    restarts = 4                            # optional, as is finalists

A shape that is known to be symmetric, or that is to be unfolded, adds (Sec. 8 and 9)::

    constraints = ["on_plane(head, body)", "mirror(leg2, leg1)"]
    plane = "auto"                          # where the constraints do not say
    embedding = "mds"                       # where the partition lives
    space = "mds"                           # where terms are evaluated that do not say

Bundles bring recipes through the hook ``moseg_recipes``; anybody else gives a path.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from moseg_core.choice import Choice
from moseg_core.errors import PluginError, UsageError, unknown
from moseg_core.language import parse
from moseg_core.method import Method, read_finalists, read_resolution, read_restarts
from moseg_core.plugins import Registry, registry
from moseg_core.problem import Problem, check_label_names
from moseg_core.specs import Kind

_PROBLEM_KEYS = ("constraints", "plane", "embedding", "space")
_METHOD_KEYS: tuple[Kind, ...] = ("parameterization", "seeder", "labeler", "optimizer")
_EXTENT: dict[str, Callable[[object], Any]] = {
    "resolution": read_resolution,
    "restarts": read_restarts,
    "finalists": read_finalists,
}


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """A named problem and the components to solve it with.

    Parameters
    ----------
    name : str
    labels : tuple of str
    minimize : str
    method : Method
    description : str
    constraints : tuple of str
    plane : str or None
    embedding : Choice or None
    space : str or None
        See :class:`moseg_core.Problem`.
    """

    name: str
    labels: tuple[str, ...]
    minimize: str
    method: Method = field(default_factory=Method)
    description: str = ""
    constraints: tuple[str, ...] = ()
    plane: str | None = None
    embedding: Choice | None = None
    space: str | None = None

    def problem(self, *, source: Registry | None = None) -> Problem:
        """The problem that the recipe states.

        Raises
        ------
        UsageError, PluginError
            See :class:`moseg_core.Problem`.

        Examples
        --------
        >>> load_recipe("hammer").problem().labels
        ('handle', 'head')
        """
        return Problem(
            self.labels,
            self.minimize,
            constraints=self.constraints,
            plane=self.plane,
            embedding=self.embedding,
            space=self.space,
            registry=source,
        )


def parse_recipe(text: str, name: str) -> Recipe:
    r"""Read the TOML text of a recipe.

    Parameters
    ----------
    text : str
    name : str
        What to call it in messages.

    Raises
    ------
    UsageError
        Not TOML, an unknown or missing key, or a value of the wrong kind.

    Examples
    --------
    >>> parse_recipe('labels = ["a"]\nminimize = "narrow(a)"', "mine").labels
    ('a',)
    """
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"recipe '{name}' is not valid TOML: {error}") from error
    allowed = ("description", "labels", "minimize", *_PROBLEM_KEYS, *_METHOD_KEYS, *_EXTENT)
    for key in table:
        if key not in allowed:
            raise UsageError(f"recipe '{name}': {unknown('key', key, allowed)}")
    given = _required(table, "labels", list, name)
    minimize = _required(table, "minimize", str, name)
    description = _required({"description": ""} | table, "description", str, name)
    constraints = _required({"constraints": []} | table, "constraints", list, name)
    words = {key: _required(table, key, str, name) for key in ("plane", "space") if key in table}
    try:
        labels = check_label_names(given)
        choices: dict[str, Any] = {
            key: Choice.read(table[key], key) for key in _METHOD_KEYS if key in table
        }
        extent = {key: read(table[key]) for key, read in _EXTENT.items() if key in table}
        embedding = None
        if "embedding" in table:
            embedding = Choice.read(table["embedding"], "embedding")
        for text in constraints:
            if not isinstance(text, str):
                raise UsageError(f"a constraint is a text such as 'mirror(a, b)', not {text!r}")
    except UsageError as error:
        raise UsageError(f"recipe '{name}': {error}") from error
    return Recipe(
        name=name,
        labels=labels,
        minimize=minimize,
        method=Method(**choices, **extent),
        description=description,
        constraints=tuple(constraints),
        embedding=embedding,
        **words,
    )


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
    >>> load_recipe("hammer").labels
    ('handle', 'head')
    """
    if name.endswith(".toml") or "/" in name or "\\" in name:
        try:
            text = Path(name).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise UsageError(f"recipe '{name}' cannot be read: {error}") from error
        return parse_recipe(text, Path(name).stem)
    component = (registry() if source is None else source).find("recipe", name)
    text = component.load()
    if not isinstance(text, str):
        raise PluginError(
            f"recipe '{component.id}' of {component.distribution} is a {type(text).__name__}, not"
            f" a text"
        )
    recipe = parse_recipe(text, component.spec.name)
    found = registry() if source is None else source
    return replace(
        recipe,
        minimize=said_in_full(recipe.minimize, lambda word: f"{component.bundle}:{word}", found),
    )


def said_in_full(text: str, full: Callable[[str], str | None], source: Registry) -> str:
    """An expression in which names that have become ambiguous stand for what was meant.

    A recipe's own objectives are meant by its names, whatever is installed beside its bundle.

    Parameters
    ----------
    text : str
    full : callable
        For the name of an objective the id that is meant, or None where that is not known.
    source : Registry
    """
    expression = parse(text)
    offered = [component.spec.name for component in source.components("objective")]
    ids = [component.id for component in source.components("objective")]
    terms = tuple(
        replace(term, name=full(term.name) or term.name)
        if offered.count(term.name) > 1 and full(term.name) in ids
        else term
        for term in expression.terms
    )
    return text if terms == expression.terms else str(replace(expression, terms=terms))


def _required(table: Mapping[str, Any], key: str, kind: type, name: str) -> Any:
    if not isinstance(table.get(key), kind):
        what = "a list of texts" if kind is list else "a text"
        found = repr(table[key]) if key in table else "missing"
        raise UsageError(f"recipe '{name}': '{key}' must be {what}; it is {found}")
    return table[key]
