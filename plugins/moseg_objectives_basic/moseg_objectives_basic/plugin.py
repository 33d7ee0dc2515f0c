"""The bundle ``basic``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import FieldSpec, MeasureSpec, ObjectiveSpec, RecipeSpec, hookimpl

_PACKAGE = "moseg_objectives_basic"

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_objectives() -> list[ObjectiveSpec]:
    """The objectives of Sec. 10, those that Sec. 3 only names, and the words.

    A summary says, in this form, of how many parts it is and where it is small: the tables in the
    README and in ``docs/objectives.md`` are made of it.
    """
    return [
        ObjectiveSpec(
            name="narrow",
            target=f"{_PACKAGE}.proportions:narrow",
            summary="one part: long and thin",
        ),
        ObjectiveSpec(
            name="flat",
            target=f"{_PACKAGE}.proportions:flat",
            summary="one part: like a plate",
        ),
        ObjectiveSpec(
            name="compact",
            target=f"{_PACKAGE}.proportions:compact",
            summary="one part: as wide and high as it is long",
        ),
        ObjectiveSpec(
            name="planar_symmetric",
            target=f"{_PACKAGE}.symmetry:planar_symmetric",
            summary="one part: its own mirror image",
        ),
        ObjectiveSpec(
            name="axial_symmetric",
            target=f"{_PACKAGE}.symmetry:axial_symmetric",
            summary="one part: a surface of revolution",
        ),
        ObjectiveSpec(
            name="rotational_symmetric",
            target=f"{_PACKAGE}.symmetry:rotational_symmetric",
            summary="one part: the same n times in a full turn",
        ),
        ObjectiveSpec(
            name="ellipsoidal",
            target=f"{_PACKAGE}.ellipsoid:ellipsoidal",
            summary="one part: close to an ellipsoid",
        ),
        ObjectiveSpec(
            name="convex",
            target=f"{_PACKAGE}.convexity:convex",
            summary="one part: fills its convex hull",
        ),
        ObjectiveSpec(
            name="area_fraction",
            target=f"{_PACKAGE}.area:area_fraction",
            summary="one part: its share of the area is within the bounds",
        ),
        ObjectiveSpec(
            name="is",
            target=f"{_PACKAGE}.likeness:is_",
            summary="one part: measures as expected, give or take",
        ),
        ObjectiveSpec(
            name="thin",
            target=f"{_PACKAGE}.girth:thin",
            summary="one part: thin, beside the whole shape",
        ),
        ObjectiveSpec(
            name="thick",
            target=f"{_PACKAGE}.girth:thick",
            summary="one part: thick, beside the whole shape",
        ),
        ObjectiveSpec(
            name="even_thickness",
            target=f"{_PACKAGE}.girth:even_thickness",
            summary="one part: as thick everywhere",
        ),
        ObjectiveSpec(
            name="central",
            target=f"{_PACKAGE}.middle:central",
            summary="one part: near the middle of the shape",
        ),
        ObjectiveSpec(
            name="remote",
            target=f"{_PACKAGE}.middle:remote",
            summary="one part: far from the middle of the shape",
        ),
        ObjectiveSpec(
            name="small",
            target=f"{_PACKAGE}.size:small",
            summary="one part: of little area",
        ),
        ObjectiveSpec(
            name="large",
            target=f"{_PACKAGE}.size:large",
            summary="one part: of much area",
        ),
        ObjectiveSpec(
            name="short_boundary",
            target=f"{_PACKAGE}.seams:short_boundary",
            summary="one part: its boundary is short for its area",
        ),
        ObjectiveSpec(
            name="creased_boundary",
            target=f"{_PACKAGE}.seams:creased_boundary",
            summary="one part: its boundary lies in creases",
        ),
        ObjectiveSpec(
            name="perpendicular",
            target=f"{_PACKAGE}.axes:perpendicular",
            summary="two parts: long axes at a right angle",
        ),
        ObjectiveSpec(
            name="parallel",
            target=f"{_PACKAGE}.axes:parallel",
            summary="two parts: long axes parallel",
        ),
        ObjectiveSpec(
            name="coaxial",
            target=f"{_PACKAGE}.axes:coaxial",
            summary="two parts: long axes on one line",
        ),
        ObjectiveSpec(
            name="above",
            target=f"{_PACKAGE}.order:above",
            summary="two parts: the first is higher up than the second",
        ),
        ObjectiveSpec(
            name="similar_proportions",
            target=f"{_PACKAGE}.similarity:similar_proportions",
            summary="several parts: alike in length, width and height",
        ),
        ObjectiveSpec(
            name="similar",
            target=f"{_PACKAGE}.similarity:similar",
            summary="several parts: alike in proportions, whatever their size",
        ),
        ObjectiveSpec(
            name="touching",
            target=f"{_PACKAGE}.neighbours:touching",
            summary="several parts: the first touches each of the others",
        ),
        ObjectiveSpec(
            name="apart",
            target=f"{_PACKAGE}.neighbours:apart",
            summary="several parts: no two of them touch",
        ),
        ObjectiveSpec(
            name="convex_parts",
            target=f"{_PACKAGE}.convexity:convex_parts",
            summary="all parts: their convex hulls fill the volume once",
        ),
        ObjectiveSpec(
            name="short_boundaries",
            target=f"{_PACKAGE}.seams:short_boundaries",
            summary="all parts: their boundaries are short together",
        ),
        ObjectiveSpec(
            name="separate",
            target=f"{_PACKAGE}.seams:separate",
            summary="one part: joined to the rest along a short line, in creases",
        ),
        ObjectiveSpec(
            name="separate_parts",
            target=f"{_PACKAGE}.seams:separate_parts",
            summary="all parts: joined along short lines, in creases",
        ),
        ObjectiveSpec(
            name="even_parts",
            target=f"{_PACKAGE}.girth:even_parts",
            summary="all parts: each as thick everywhere",
        ),
        ObjectiveSpec(
            name="creased_boundaries",
            target=f"{_PACKAGE}.seams:creased_boundaries",
            summary="all parts: their boundaries lie in creases",
        ),
    ]


@hookimpl
def moseg_measures() -> list[MeasureSpec]:
    """What the objectives share, and others may."""
    return [
        MeasureSpec(
            name="likeness",
            target=f"{_PACKAGE}.profile:likeness",
            summary="all that 'is' compares: area, length, thickness, remoteness, ...",
        ),
        MeasureSpec(
            name="hull_volume",
            target=f"{_PACKAGE}.convexity:hull_volume",
            summary="volume of the part's convex hull",
        ),
        MeasureSpec(
            name="closed_volume",
            target=f"{_PACKAGE}.convexity:closed_volume",
            summary="volume of the part with its boundary loops capped",
        ),
        MeasureSpec(
            name="surface_samples",
            target=f"{_PACKAGE}.surface_distance:surface_samples",
            summary="points and weights for integrals over the part's surface",
            keep=False,
        ),
        MeasureSpec(
            name="surface_tree",
            target=f"{_PACKAGE}.surface_distance:surface_tree",
            summary="search tree for distances to the part's surface",
            keep=False,
        ),
    ]


@hookimpl
def moseg_fields() -> list[FieldSpec]:
    """What every element is like."""
    return [
        FieldSpec(
            name="thickness",
            target=f"{_PACKAGE}.fields.thickness:thickness",
            summary="how far it is to the other side, in diagonals of the shape",
            requires=("surface",),
            invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
        ),
        FieldSpec(
            name="log_thickness",
            target=f"{_PACKAGE}.fields.thickness:log_thickness",
            summary="the logarithm of the thickness",
            requires=("surface",),
            invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
        ),
        FieldSpec(
            name="remoteness",
            target=f"{_PACKAGE}.fields.remoteness:remoteness",
            summary="mean distance to the whole surface, 1 in the middle",
            requires=("adjacency",),
            invariant_to=("rigid", "scale", "reflection", "order"),
        ),
        FieldSpec(
            name="concavity",
            target=f"{_PACKAGE}.fields.concavity:concavity",
            summary="how sharply the surface turns in: 2 at most, 0 where flat",
            requires=("surface", "adjacency"),
            invariant_to=("rigid", "scale", "reflection", "order"),
        ),
        FieldSpec(
            name="uncreased",
            target=f"{_PACKAGE}.fields.concavity:uncreased",
            summary="how little a boundary is expected: 0 in creases, 1 on bulges",
            requires=("surface", "adjacency"),
            invariant_to=("rigid", "scale", "reflection", "order"),
        ),
        FieldSpec(
            name="height",
            target=f"{_PACKAGE}.fields.height:height",
            summary="how high up, 0 at the lowest vertex, 1 at the highest",
            invariant_to=("scale", "order", "tessellation"),
        ),
    ]


@hookimpl
def moseg_recipes() -> list[RecipeSpec]:
    """Shapes as a person would say them; of the paper's those that need no constraint."""
    return [
        RecipeSpec(
            name="any_shape",
            target=f"{_PACKAGE}.recipes:ANY_SHAPE",
            summary="any number of parts of any shape: short boundaries in creases, even thickness",
        ),
        RecipeSpec(
            name="hammer",
            target=f"{_PACKAGE}.recipes:HAMMER",
            summary="a long, narrow handle and a head set across its end",
        ),
        RecipeSpec(
            name="words_fourleg",
            target=f"{_PACKAGE}.recipes:WORDS_FOURLEG",
            summary="a four-legged animal: body, neck, head, four legs",
        ),
        RecipeSpec(
            name="words_bird",
            target=f"{_PACKAGE}.recipes:WORDS_BIRD",
            summary="a bird: body, head, tail, two wings",
        ),
        RecipeSpec(
            name="words_octopus",
            target=f"{_PACKAGE}.recipes:WORDS_OCTOPUS",
            summary="an octopus: body, eight legs",
        ),
        RecipeSpec(
            name="words_hand",
            target=f"{_PACKAGE}.recipes:WORDS_HAND",
            summary="a hand: palm, thumb, four fingers",
        ),
        RecipeSpec(
            name="words_chair",
            target=f"{_PACKAGE}.recipes:WORDS_CHAIR",
            summary="a chair: seat, back, four legs, two arms",
        ),
        RecipeSpec(
            name="words_table",
            target=f"{_PACKAGE}.recipes:WORDS_TABLE",
            summary="a table: top, four legs",
        ),
        RecipeSpec(
            name="words_cup",
            target=f"{_PACKAGE}.recipes:WORDS_CUP",
            summary="a cup: body, handle",
        ),
        RecipeSpec(
            name="paper_hammer",
            target=f"{_PACKAGE}.recipes:PAPER_HAMMER",
            summary="as the paper prints it: a narrow handle and a head set across it",
        ),
        RecipeSpec(
            name="paper_horse",
            target=f"{_PACKAGE}.recipes:PAPER_HORSE",
            summary="as the paper prints it: a four-legged animal, with head, body, four legs",
        ),
        RecipeSpec(
            name="symmetry_then_convex",
            target=f"{_PACKAGE}.recipes:SYMMETRY_THEN_CONVEX",
            summary="on two levels: symmetric parts, then convex pieces of them",
        ),
    ]
