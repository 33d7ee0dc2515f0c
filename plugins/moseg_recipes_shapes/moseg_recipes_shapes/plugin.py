"""The bundle ``shapes``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import RecipeSpec, hookimpl

_PACKAGE = "moseg_recipes_shapes"

#: The contract with moseg that the bundle was written for.
moseg_contract = 1

#: What each recipe is of, in the words that the recipe describes itself with. Parts are called
#: what the Princeton Segmentation Benchmark's labels call them.
RECIPES = {
    "human": "a person: head, torso, upper and lower arms and legs, hands, feet",
    "fourleg": "a four-legged animal: torso, neck, head, legs, tail, ears or horns",
    "bird": "a bird: body, head, wings, tail, legs",
    "fish": "a fish: body, tail, fins",
    "ant": "an ant: head, torso, back (the hind part), six legs, antennae",
    "octopus": "an octopus: body, legs",
    "hand": "a hand: palm (called hand), thumb, four fingers",
    "teddy": "a teddy bear: head, ears, torso, hands, legs",
    "chair": "a chair: support (the seat), backsupport (the back), legs, arms",
    "table": "a table: support (the top), legs",
    "cup": "a cup: body, handle",
    "glasses": "a pair of glasses: lenses, the middle between them, the skeleton around them",
    "plier": "a pair of pliers: center (the joint), handles, edges (the jaws)",
    "airplane": "an airplane: body, wings, stabilizers, rudder, engines",
    "vase": "a vase: body, top, base, handles, spout",
    "armadillo": "a figure like the Armadillo: head, ears, torso, back, tail,"
    " arms, hands, legs, feet",
    "bust": "a bust: face, eyes, ears, nose, mouth, hair, neck, background (all else)",
    "mech": "a machine part: larger and smaller boxes and cylinders",
    "bearing": "a bearing: rollers from tiny to big, on a base of two sides",
}


@hookimpl
def moseg_recipes() -> list[RecipeSpec]:
    """Recipes learned from some five models each."""
    return [
        RecipeSpec(name=name, target=f"{_PACKAGE}.recipes:{name.upper()}", summary=f"learned: {of}")
        for name, of in RECIPES.items()
    ]
