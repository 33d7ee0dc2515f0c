"""Recipes: what their TOML may hold, where they are found, and that those installed work."""

from __future__ import annotations

from dataclasses import replace

import pytest

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.errors import ExpressionError, MosegError, PluginError, UsageError
from moseg_core.language import Table, Target
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe, load_recipe, parse_recipe
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.search.request import prepare_components

LEAST = 'labels = ["a"]\nminimize = "narrow(a)"\n'


def test_a_recipe_in_full():
    text = '''
        description = "A narrow handle with a head set across it."
        labels = ["handle", "head"]
        minimize = """
            3*narrow(handle)
            + perpendicular(handle, head)"""
        seeder = "kmeans(rounds=5)"
        labeler = "core:hungarian"
        parameterization = { name = "voronoi", connected = false }

        [optimizer]
        name = "pattern_search"
        expansion = 3
    '''
    recipe = parse_recipe(text, "mine")
    assert recipe.name == "mine"
    assert recipe.labels == ("handle", "head")
    assert recipe.description == "A narrow handle with a head set across it."
    assert recipe.statement.search == Method(
        parameterization=Choice("voronoi", {"connected": False}),
        seeder=Choice("kmeans", {"rounds": 5.0}),
        labeler=Choice("core:hungarian"),
        optimizer=Choice("pattern_search", {"expansion": 3}),
    )
    problem = Problem(recipe.labels, recipe.minimize)
    assert str(problem.expression) == "3*narrow(handle) + perpendicular(handle, head)"


def test_a_recipe_at_least():
    assert parse_recipe(LEAST, "mine") == Recipe(
        name="mine", statement=Statement(labels=("a",), minimize="narrow(a)")
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("labels = [", "recipe 'mine' is not valid TOML: "),
        ("= 3", "recipe 'mine' is not valid TOML: "),
        ("", "recipe 'mine': 'labels' must be a list of texts; it is missing"),
        ('minimize = "f"', "recipe 'mine': 'labels' must be a list of texts; it is missing"),
        ('labels = "a"', "recipe 'mine': 'labels' must be a list of texts; it is 'a'"),
        ("labels = 3", "recipe 'mine': 'labels' must be a list of texts; it is 3"),
        ('labels = ["a"]', "recipe 'mine': 'minimize' must be a text; it is missing"),
        (
            'labels = ["a"]\nminimize = ["f"]',
            "recipe 'mine': 'minimize' must be a text; it is ['f']",
        ),
        (f"{LEAST}seder = 'x'", "recipe 'mine': unknown key 'seder'; did you mean 'seeder'?"),
        (f"{LEAST}[recipe]\nx = 1", "recipe 'mine': unknown key 'recipe'; "),
        (f"{LEAST}zz = 1", "recipe 'mine': unknown key 'zz'; known: constraints, description, "),
        (f"{LEAST}description = 3", "recipe 'mine': 'description' must be a text; it is 3"),
    ],
)
def test_malformed_recipes(text, message):
    with pytest.raises(UsageError) as caught:
        parse_recipe(text, "mine")
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        'labels = []\nminimize = "f"',
        'labels = ["a", "a"]\nminimize = "f"',
        'labels = ["a", 3]\nminimize = "f"',
        'labels = ["leg*", "arm*"]\nminimize = "f"',
        f"{LEAST}seeder = 3",
        f'{LEAST}optimizer = "pattern_search("',
        f"{LEAST}[labeler]\nrounds = 3",
        f'{LEAST}[[optimizer]]\nname = "pattern_search"',
    ],
)
def test_every_complaint_says_which_recipe_it_is_about(text):
    with pytest.raises(UsageError) as caught:
        parse_recipe(text, "mine")
    assert "recipe 'mine'" in str(caught.value)


def test_a_recipe_is_read_from_a_file(tmp_path):
    path = tmp_path / "tête.toml"
    path.write_text(f'{LEAST}description = "Kopf, голова"', encoding="utf-8")
    recipe = load_recipe(str(path))
    assert (recipe.name, recipe.description) == ("tête", "Kopf, голова")


@pytest.mark.parametrize(
    "name", ["missing.toml", "./missing", "folder.toml", "folder/", "latin.toml"]
)
def test_files_that_cannot_be_read(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "folder").mkdir()
    (tmp_path / "latin.toml").write_bytes(b'labels = ["t\xeate"]')
    with pytest.raises(UsageError) as caught:
        load_recipe(name)
    assert str(caught.value).startswith(f"recipe '{name}' cannot be read: ")


def test_a_mistake_in_a_file_is_told_with_its_name(tmp_path):
    (tmp_path / "mine.toml").write_text("labels = 3")
    with pytest.raises(UsageError, match=r"^recipe 'mine': 'labels' must be"):
        load_recipe(str(tmp_path / "mine.toml"))


def test_an_unknown_recipe_is_answered_with_the_nearest():
    with pytest.raises(UsageError, match=r"^unknown recipe 'hamer'; did you mean 'hammer'\?"):
        load_recipe("hamer")


def test_a_recipe_of_a_bundle_that_is_set_aside_gives_the_reason():
    broken = Bundle("broken", "moseg-broken", "2.1", "broken", problem="moseg-broken 2.1: it fell")
    with pytest.raises(PluginError, match=r"recipe 'broken:x' is not available.*it fell"):
        load_recipe("broken:x", source=Registry((broken,)))


def add_recipe(site, source: str) -> Registry:
    site.add(
        "acme-recipes",
        "1.2",
        bundles={"acme": "acme_bundle"},
        acme_bundle="""
            from moseg_core import RecipeSpec, hookimpl

            @hookimpl
            def moseg_recipes():
                return [RecipeSpec(name="chair", target="acme_texts:CHAIR")]
        """,
        acme_texts=source,
    )
    return site.discover()


@pytest.mark.parametrize("name", ["chair", "acme:chair"])
def test_a_bundle_brings_recipes(site, name):
    found = add_recipe(site, f"CHAIR = {LEAST!r}")
    recipe = load_recipe(name, source=found)
    assert (recipe.name, recipe.labels) == ("chair", ("a",))


@pytest.mark.parametrize(
    "source",
    ["CHAIR = 3", "CHAIR = None", "def CHAIR(): ...", "CHAIR = {'labels': ['a']}", "CHAIR = b''"],
)
def test_a_recipe_that_is_no_text_is_the_fault_of_its_distribution(site, source):
    found = add_recipe(site, source)
    with pytest.raises(PluginError, match=r"'acme:chair' of acme-recipes 1\.2"):
        load_recipe("chair", source=found)


def test_a_malformed_recipe_of_a_bundle_is_refused(site):
    found = add_recipe(site, "CHAIR = 'labels = 3'")
    with pytest.raises(MosegError, match="'labels' must be a list of texts"):
        load_recipe("chair", source=found)


@pytest.mark.parametrize("component", registry().components("recipe"), ids=lambda c: c.id)
def test_every_installed_recipe_makes_a_problem_and_a_method(component):
    recipe = load_recipe(component.id)
    assert recipe.description
    for task in closed(recipe).hierarchies():
        assert task.problem.terms
    for kind in ("parameterization", "seeder", "labeler", "optimizer"):
        prepare(getattr(SearchOptions().settled(recipe.statement.search), kind), kind, registry())


def test_a_mistake_in_the_expression_shows_with_the_problem():
    recipe = parse_recipe('labels = ["a"]\nminimize = "narow(a)"', "mine")
    with pytest.raises(ExpressionError, match="did you mean 'narrow'"):
        Problem(recipe.labels, recipe.minimize)


def closed(recipe: Recipe) -> Recipe:
    """The recipe for two parts more than it names, where it leaves the number open."""
    stated = recipe.statement
    if not stated.is_open:
        return recipe
    return replace(recipe, statement=stated.with_parts(len(stated.labels) + 2))


def components_of(recipe: Recipe) -> list[str]:
    """Ids of all components that a recipe comes to, level by level."""
    found = []
    tasks = closed(recipe).hierarchies()
    for level in (level for task in tasks for _, level in task.levels()):
        problem = level.problem
        found += [term.id for term in problem.terms] + [
            rule.id for rule in problem.bound_constraints
        ]
        found += [problem.embedding_component.component.id] if problem.embedding_component else []
        ready = prepare_components(problem, SearchOptions().settled(level.search))
        found += [prepared.component.id for prepared in ready.values()]
    return found


@pytest.mark.parametrize("component", registry().components("recipe"), ids=lambda c: c.id)
def test_a_recipe_means_the_same_whatever_else_is_installed(component, install_stranger):
    alone = components_of(load_recipe(component.id))
    crowded = install_stranger()
    with pytest.raises(UsageError, match="'narrow' is ambiguous; say which: basic:narrow, strange"):
        crowded.find("objective", "narrow")
    assert components_of(load_recipe(component.id)) == alone


def test_a_recipe_names_the_recipes_of_its_own_bundle(site):
    for name in ("one", "two"):
        site.add(
            f"moseg-{name}",
            bundles={name: f"{name}_bundle"},
            **{
                f"{name}_bundle": """
                    from moseg_core import RecipeSpec, hookimpl

                    WHOLE = 'labels = ["a"]\\nminimize = "f(a)"\\n[parts.a]\\nrecipe = "piece"'
                    PIECE = 'labels = ["NAME1", "NAME2"]\\nminimize = "f(NAME1)"'

                    @hookimpl
                    def moseg_recipes():
                        return [
                            RecipeSpec(name="NAME_whole", target=__name__ + ":WHOLE"),
                            RecipeSpec(name="piece", target=__name__ + ":PIECE"),
                        ]
                """.replace("NAME", name)
            },
        )
    found = site.discover()
    for name in ("one", "two"):
        ((_, part),) = load_recipe(f"{name}_whole", source=found).statement.parts
        assert part.labels == (f"{name}1", f"{name}2")
    with pytest.raises(UsageError, match="ambiguous"):
        load_recipe("piece", source=found)


def test_a_recipe_means_its_own_objectives_beside_others_of_the_same_name():
    others = registry()
    rival = Component("rival", "rival 1.0", ObjectiveSpec(name="narrow", target="rival:narrow"))
    crowded = Registry(
        [*others.bundles, Bundle("rival", "rival", "1.0", "rival", components=(rival,))]
    )
    alone, beside = (
        load_recipe("paper_hammer", source=others),
        load_recipe("paper_hammer", source=crowded),
    )
    assert alone.minimize.startswith("3*narrow(handle)")
    assert beside.minimize == (
        "3*basic:narrow(handle) + perpendicular(handle, head) + convex_parts"
    )
    problem = Problem(beside.labels, beside.minimize, registry=crowded)
    assert problem.terms[0].id == "basic:narrow"


def test_a_recipe_may_give_a_label_several_centres():
    text = """
        labels = ["head", "body"]
        minimize = "thin(head)"
        parameterization = 'voronoi(centers="body=3")'
    """
    recipe = parse_recipe(text, "mine")
    chosen = recipe.statement.search.parameterization
    assert chosen == Choice("voronoi", {"centers": "body=3"})
    again = parse_recipe(recipe.toml(), "mine")
    assert again.statement.search.parameterization.parameters == {"centers": "body=3"}


OPEN = 'labels = ["body", "limb*"]\nminimize = "narrow(limb*)"\n'


TABLES = """\
labels = ["leg1", "leg2"]
minimize = "is(leg*, given=leg)"

[given.leg]
area = "0.06+-0.02"
crease = "0+-0.5"

[given.looks.leg]
bias = -1.5
"mean thickness" = 3

[parts.leg1]
labels = ["upper", "lower"]
minimize = "is(upper, given=half)"

[parts.leg1.given.half]
area = "0.5+-0.1"
"""


def test_tables_stand_under_their_headings():
    recipe = parse_recipe(TABLES, "mine")
    assert recipe.toml() == TABLES
    assert recipe.statement.given["leg"]["area"] == Target(0.06, 0.02)
    assert recipe.statement.parts[0][1].given == Table({"half": {"area": "0.5+-0.1"}})
    task = recipe.hierarchy()
    assert task.problem.terms[0].parameters == {
        "area": Target(0.06, 0.02),
        "crease": Target(0, 0.5),
    }
    (half,) = task.children["leg1"].problem.terms
    assert half.parameters == {"area": Target(0.5, 0.1)}


def test_a_mistake_in_a_table_is_told_with_the_recipe():
    with pytest.raises(UsageError, match=r"^recipe 'mine': 'leg\.area' in the tables is no target"):
        parse_recipe(TABLES.replace("0.06+-0.02", "0.06+-"), "mine")
    with pytest.raises(UsageError, match=r"^recipe 'mine/leg1': 'half\.area' in the tables"):
        parse_recipe(TABLES.replace("0.5+-0.1", "0.5+-"), "mine")


def test_a_recipe_may_leave_the_number_of_parts_open():
    recipe = parse_recipe(OPEN, "mine")
    assert recipe.statement.is_open
    assert recipe.labels == ("body", "limb*")
    assert recipe.toml() == OPEN
    assert Hierarchy.of(recipe.statement.with_parts(3)).labels == ("body", "limb1", "limb2")


@pytest.mark.parametrize("make", [Recipe.problem, Recipe.hierarchy])
def test_who_uses_an_open_recipe_says_how_many_parts_there_are(make):
    recipe = parse_recipe(OPEN, "mine")
    with pytest.raises(UsageError, match=r"'limb\*' stands for any number of parts.* --parts 5"):
        make(recipe)
