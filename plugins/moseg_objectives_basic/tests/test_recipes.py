from __future__ import annotations

from moseg_core import Problem, SearchOptions, load_recipe

LEGS = [("leg1",), ("leg2",), ("leg3",), ("leg4",)]

# Figure 9 of the paper: weight, objective, and the labels of each call.
FIGURE_9 = {
    "hammer": (
        ("handle", "head"),
        [
            (3.0, "basic:narrow", [("handle",)]),
            (1.0, "basic:perpendicular", [("handle", "head")]),
            (1.0, "basic:convex_parts", [()]),
        ],
    ),
    "horse": (
        ("head", "body", "leg1", "leg2", "leg3", "leg4"),
        [
            (1.0, "basic:planar_symmetric", [("head",)]),
            (1.0, "basic:planar_symmetric", [("body",)]),
            (1.0, "basic:ellipsoidal", [("body",)]),
            (10.0, "basic:narrow", LEGS),
            (1.0, "basic:similar_proportions", [("leg1", "leg2", "leg3", "leg4")]),
            (1.0, "basic:convex_parts", [()]),
        ],
    ),
}


def bound(name):
    recipe = load_recipe(name)
    problem = Problem(recipe.labels, recipe.minimize)
    terms = [
        (term.weight, term.id, [tuple(recipe.labels[k] for k in call) for call in term.calls])
        for term in problem.terms
    ]
    assert all(term.parameters == {} for term in problem.terms)
    return recipe, problem, terms


def test_recipes_are_figure_9():
    for name, (labels, terms) in FIGURE_9.items():
        recipe, _, found = bound(name)
        assert recipe.name == name
        assert recipe.labels == labels
        assert found == terms
        assert recipe.description.endswith(".")


def test_recipes_are_solved_as_in_the_paper():
    for name in FIGURE_9:
        found = SearchOptions(settings="paper").settled(load_recipe(name).statement.search)
        chosen = [found.parameterization, found.seeder, found.labeler, found.optimizer]
        seeder = {"hammer": "kmeans", "horse": "evolution"}[name]
        names = [str(choice).removeprefix("core:") for choice in chosen]
        assert names == ["voronoi", seeder, "hungarian", "pattern_search"]


def test_hammer_recipe_prefers_a_hammer_cut_as_one(make):
    handle = make.box(8, 1, 1)
    head = make.moved(make.box(1.2, 3, 1.2), shift=[4.6, 0, 0])
    whole = make.segmented([handle, head])
    shape, labels = whole.shape, whole.labels
    _, problem, _ = bound("hammer")
    right = problem.evaluate(shape, labels)
    assert right.cost.empty == 0
    assert max(abs(term.value) for term in right.terms[1:]) < 1e-12
    assert right.cost < problem.evaluate(shape, 1 - labels).cost


def test_horse_recipe_takes_any_shape_of_six_parts(make):
    meshes = [make.moved(make.box(3, 2, 1), shift=[5 * k, 0, 0]) for k in range(6)]
    whole = make.segmented(meshes)
    _, problem, _ = bound("horse")
    found = problem.evaluate(whole.shape, whole.labels)
    worth = {term.text: term.value for term in found.terms}
    # Six equal boxes: symmetric, alike, and their own hulls.
    for text in (
        "planar_symmetric(head)",
        "planar_symmetric(body)",
        "similar_proportions(leg*)",
        "convex_parts",
    ):
        assert abs(worth[text]) < 1e-20
    legs = next(term for term in found.terms if term.text == "narrow(leg*)")
    assert len(legs.calls) == 4
    assert found.cost.value > legs.weighted > 0
