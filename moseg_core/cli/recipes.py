"""``moseg recipes``: which recipes are installed, and their text as a start for one's own."""

from __future__ import annotations

import sys
from typing import Any

from rich.table import Table

from moseg_core.cli.console import cell, console, print_json, print_text
from moseg_core.components.discovery.registry import Component, registry
from moseg_core.errors import MosegError, PluginError
from moseg_core.problem.recipe import Recipe, load_recipe, parse_recipe


def run_recipes(name: str | None, *, as_json: bool) -> None:
    """Print the list, or one recipe."""
    if name is not None:
        component = registry().find("recipe", name)
        text = _text(component)
        if as_json:
            read = parse_recipe(text, component.spec.name)
            print_json({**_document(component, read, None), "toml": text})
        else:
            print_text(_for_a_file(component, text))
        return
    found = [(component, *read_shipped(component)) for component in registry().components("recipe")]
    if as_json:
        print_json([_document(*entry) for entry in found])
        return
    short = set(registry().names("recipe"))
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("recipe", "bundle", "parts", "description"):
        table.add_column(heading, overflow="fold")
    for component, recipe, problem in found:
        called = component.spec.name if component.spec.name in short else component.id
        description = (
            cell(recipe.description) if recipe else cell(f"cannot be used: {problem}", "red")
        )
        table.add_row(called, component.bundle, how_many(recipe), description)
    console(sys.stdout).print(table)


def how_many(recipe: Recipe | None) -> str:
    """How many parts a recipe cuts the whole into."""
    if recipe is None:
        return ""
    if recipe.statement.is_open:
        return "any"
    counts = [len(names) for names in recipe.statement.label_sets()]
    least, most = min(counts), max(counts)
    return str(least) if least == most else f"{least} to {most}"


def _text(component: Component) -> str:
    """The TOML of a recipe, character by character as its bundle has it."""
    text = component.load()
    if not isinstance(text, str):
        raise PluginError(f"{component.who} is a {type(text).__name__}, not a text")
    return text


def _for_a_file(component: Component, text: str) -> str:
    """The text as it was shipped, with ids for names that are ambiguous outside of its bundle."""
    try:
        shipped, meant = parse_recipe(text, component.spec.name), load_recipe(component.id)
    except MosegError:  # what is no recipe can still be looked at
        return text
    return text if shipped.statement == meant.statement else meant.toml()


def read_shipped(component: Component) -> tuple[Recipe | None, str | None]:
    """A recipe as its bundle has it, or what is wrong with it."""
    try:
        return parse_recipe(_text(component), component.spec.name), None
    except MosegError as error:
        return None, str(error)


def _document(component: Component, recipe: Recipe | None, problem: str | None) -> dict[str, Any]:
    return {
        "name": component.spec.name,
        "id": component.id,
        "bundle": component.bundle,
        "distribution": component.distribution,
        "problem": problem,
        "description": recipe.description if recipe else None,
        "labels": list(recipe.labels) if recipe else None,
        "variants": [list(one) for one in recipe.statement.variants] if recipe else None,
        "minimize": recipe.minimize if recipe else None,
        "parts": [label for label, _ in recipe.statement.parts] if recipe else None,
    }
