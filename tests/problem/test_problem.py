"""Problems: labels, sums of terms, empty parts, and shapes that do not do."""

from __future__ import annotations

import itertools
import json
import textwrap
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.cli import main
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Registry
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ExpressionError, PluginError, ShapeError, UsageError
from moseg_core.language import Target, parse
from moseg_core.problem.problem import Problem
from moseg_core.problem.statement import Statement
from moseg_core.shape.shape import Shape
from tests import shapes

NONE = Registry(())


def size(part: Part) -> float:
    return float(part.n_elements)


def gap(first: Part, second: Part) -> float:
    return float(first.n_elements - second.n_elements)


def first_to_last(parts: Sequence[Part]) -> float:
    return float(parts[0].n_elements - parts[-1].n_elements)


def total(segmentation: Segmentation) -> float:
    return float(sum(part.n_elements for part in segmentation.parts))


def scaled(
    part: Part,
    *,
    by: Annotated[float, Interval(0, 10)] = 2.0,
    plus: Annotated[int, Interval(0)] = 0,
) -> float:
    return part.n_elements * by + plus


def usual(part: Part, *, elements: Target) -> float:
    return elements.cost(part.n_elements)


OWN = {
    **{"size": size, "gap": gap, "first_to_last": first_to_last, "total": total},
    **{"scaled": scaled, "usual": usual},
}


def problem(labels: str, minimize: str, **more) -> Problem:
    return Problem(labels.split(), minimize, objectives={**OWN, **more}, registry=NONE)


# --- labels


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ([], "a problem needs at least one label"),
        ((), "a problem needs at least one label"),
        ("handle", "labels must be a list of names, not the text 'handle'"),
        (["a", "b", "a"], "label 'a' is given twice; labels are distinct names"),
        (["a", ""], "label '' is not allowed; labels are made of letters, digits and '_'"),
        (["a b"], "label 'a b' is not allowed; labels are made of letters, digits and '_'"),
        (["*"], "label '*' is not allowed; labels are made of letters, digits and '_'"),
        (
            ["leg*"],
            "label 'leg*' stands for any number of parts; say how many there are altogether:"
            " --parts 5, or segment_parts(shape, 5) in Python",
        ),
        (["a\n"], "label 'a\\n' is not allowed; labels are made of letters, digits and '_'"),
        (["tête"], "label 'tête' is not allowed; labels are made of letters, digits and '_'"),
        ([3], "label 3 is not allowed; labels are made of letters, digits and '_'"),
        ([None], "label None is not allowed; labels are made of letters, digits and '_'"),
        ([["a"]], "label ['a'] is not allowed; labels are made of letters, digits and '_'"),
        ([{"a": 1}], "label {'a': 1} is not allowed; labels are made of letters, digits and '_'"),
        (b"ab", "label 97 is not allowed; labels are made of letters, digits and '_'"),
    ],
)
def test_labels_are_distinct_names(labels, message):
    with pytest.raises(UsageError) as caught:
        Problem(labels, "size(a)", objectives=OWN, registry=NONE)
    assert str(caught.value) == message


@pytest.mark.parametrize("labels", [None, 3, 2.5])
def test_what_is_no_list_of_labels_is_refused(labels):
    with pytest.raises(UsageError, match="labels must be a list of names"):
        Problem(labels, "size(a)", objectives=OWN, registry=NONE)


# --- what is minimised


def test_a_problem_in_text():
    made = problem("a b", "3*size( a )-total")
    assert repr(made) == "Problem(['a', 'b'], '3*size(a) - total')"
    assert [term.id for term in made.terms] == ["python:size", "python:total"]
    assert [term.id for term in made.unary_terms] == ["python:size"]


def test_what_is_usual_is_said_by_a_target():
    made = problem("a b", "usual(a, elements=6±2) + 2*usual(b, elements=1+-1)")
    assert str(made.expression) == "usual(a, elements=6+-2) + 2*usual(b, elements=1+-1)"
    stated = made.statement
    assert Statement.read(json.loads(json.dumps(stated.document()))) == stated
    assert parse(stated.minimize) == made.expression
    strip = Shape.from_mesh(*shapes.strip(8))
    # 4 is one spread from 6; 4 is three from 1, beyond the bend.
    assert made.evaluate(strip, [0] * 4 + [1] * 4).cost.value == 1 + 2 * (4 * 3 - 4)


@objective(share=lambda given: given.get("share"))
def part_of(part: Part, *, share: Annotated[float, Interval(0, 1)] = 0.5) -> float:
    return abs(part.area / part.shape.area - share)


@objective(share=lambda given: given.get("share"))
def even(parts: Sequence[Part], *, share: float | None = None) -> float:
    return 0.0


@objective(share=lambda given: 0.9)
def all_of_it(segmentation: Segmentation) -> float:
    return 0.0


SHARES = {"part_of": part_of, "even": even, "all_of_it": all_of_it}


@pytest.mark.parametrize(
    ("minimize", "shares"),
    [
        ("size(*)", [None, None, None]),
        ("part_of(a, share=0.2)", [0.2, None, None]),
        ("part_of(a) + all_of_it", [None, None, None]),
        ("part_of(leg*, share=0.05) + part_of(a, share=1)", [1.0, 0.05, 0.05]),
        ("even(leg*, share=0.1) + size(a)", [None, 0.1, 0.1]),
        ("part_of(a, share=0.2) - part_of(a, share=0.9)", [0.2, None, None]),
        ("-part_of(a, share=0.9)", [None, None, None]),
        ("part_of(a, share=0.1) + part_of(*, share=0.4)", [0.2, 0.4, 0.4]),
        (
            "part_of(a, share=0.1) + 3*part_of(a, share=0.4) + 2*even(leg1, a, share=0.3)",
            [(0.1 * 0.4**3 * 0.3**2) ** (1 / 6), 0.3, None],
        ),
    ],
)
def test_the_shares_that_the_terms_expect(minimize, shares):
    found = problem("a leg1 leg2", minimize, **SHARES).expected_shares
    np.testing.assert_allclose(found, np.array(shares, float), rtol=1e-15)
    with pytest.raises(ValueError, match="read-only"):
        found[0] = 0.5


def test_a_share_that_is_none_ends_with_the_name_of_the_objective():
    made = problem("a b", "size(b) + part_of(a, share=0)", **SHARES)
    with pytest.raises(PluginError, match=r"'python:part_of' of the calling program failed to say"):
        _ = made.expected_shares


def test_an_expression_is_as_good_as_its_text():
    made = Problem(["a"], parse("size(a)"), objectives=OWN, registry=NONE)
    assert made.expression == problem("a", "size(a)").expression


@pytest.mark.parametrize("minimize", [None, 3, ["size(a)"]])
def test_what_is_no_expression_is_refused(minimize):
    with pytest.raises(UsageError):
        Problem(["a"], minimize, objectives=OWN, registry=NONE)


def test_mistakes_show_when_the_problem_is_made():
    with pytest.raises(ExpressionError, match="unknown label 'c'"):
        problem("a b", "size(a) + size(c)")


# --- evaluation

LABELLING = [0, 0, 0, 1, 1, 2]


@pytest.mark.parametrize(
    ("text", "value", "calls"),
    [
        ("size(a)", 3.0, [(("a",), 3.0)]),
        ("size(a, c)", 4.0, [(("a",), 3.0), (("c",), 1.0)]),
        ("size(c, a)", 4.0, [(("c",), 1.0), (("a",), 3.0)]),
        ("size(*)", 6.0, [(("a",), 3.0), (("b",), 2.0), (("c",), 1.0)]),
        ("gap(a, b)", 1.0, [(("a", "b"), 1.0)]),
        ("gap(b, a)", -1.0, [(("b", "a"), -1.0)]),
        ("first_to_last(*)", 2.0, [(("a", "b", "c"), 2.0)]),
        ("first_to_last(c, b, a)", -2.0, [(("c", "b", "a"), -2.0)]),
        ("total", 6.0, [((), 6.0)]),
    ],
)
def test_a_term_adds_up_its_calls(row, text, value, calls):
    found = problem("a b c", f"10*{text}").evaluate(row, LABELLING)
    (term,) = found.terms
    assert [(call.labels, call.value) for call in term.calls] == calls
    assert (term.value, term.weighted, term.weight) == (value, 10 * value, 10.0)
    assert term.text == text
    assert found.cost == Cost(0, 10 * value)
    assert found.empty == ()


def test_the_worst_value_is_the_end_of_the_range_that_the_weight_makes_bad(row):
    ranged = objective(range=(0, 3))(size)
    found = problem("a b", "r(a, b) - r(a, b)", r=ranged).evaluate(row, [0, 0, 0, 1, 1, 1])
    assert [term.worst for term in found.terms] == [3.0, 0.0]
    assert [[call.labels for call in term.at_worst] for term in found.terms] == [
        [("a",), ("b",)],
        [],
    ]


FLOATS = st.floats(-1e6, 1e6, allow_nan=False)


@given(
    st.lists(st.integers(0, 3), min_size=6, max_size=6),
    st.lists(
        st.tuples(
            FLOATS.filter(bool),
            st.sampled_from(["odd(*)", "odd(b, c)", "pair(a, d)", "pair(*)", "all", "odd(d)"]),
        ),
        min_size=1,
        max_size=5,
    ),
    st.integers(0, 2**32 - 1),
)
def test_the_cost_is_exactly_the_sum_of_its_terms(row, labelling, weighted, seed):
    values: dict[tuple[int, ...], float] = {}
    known = Segmentation.from_labels(row, labelling, 4).parts
    number = {part.membership: k for k, part in enumerate(known)}
    rng = np.random.default_rng(seed)

    def value_of(*parts: Part) -> float:
        key = tuple(number[part.membership] for part in parts)
        return values.setdefault(key, float(rng.normal() * 10.0 ** rng.integers(-8, 8)))

    def odd(part: Part) -> float:
        return value_of(part)

    def pair(parts: Sequence[Part]) -> float:
        return value_of(*parts)

    def everything(segmentation: Segmentation) -> float:
        return value_of()

    text = " + ".join(f"{weight!r}*{call}" for weight, call in weighted).replace("+ -", "- ")
    made = problem("a b c d", text, odd=odd, pair=pair, all=everything)
    found = made.evaluate(row, labelling)
    expected = 0.0
    for (weight, _), term in zip(weighted, found.terms, strict=True):
        inner = 0.0
        for call in term.calls:
            if call.value is not None:
                key = tuple("abcd".index(name) for name in call.labels)
                assert call.value == values[key]
                inner += call.value
        assert term.value == inner
        assert term.weighted == weight * inner
        expected += term.weighted
    assert found.cost.value == expected
    assert found.cost.empty == len(found.empty) == 4 - len(set(labelling))


# --- empty parts


@pytest.fixture(scope="module")
def flawed() -> Shape:
    """Four squares in a row, then a face without area, then one that is a mere point."""
    x = np.repeat(np.arange(5.0), 2)
    vertices = np.column_stack([x, np.tile([0.0, 1.0], 5), np.zeros(10)])
    faces = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(4)]
    return Shape.from_mesh(vertices, [*faces, [0, 4, 8], [1, 1, 1]])


def test_every_labelling_ranks_first_by_the_number_of_its_empty_parts(flawed):
    seen: list[Part] = []

    def watch(part: Part) -> float:
        seen.append(part)
        return -1000.0 * part.n_elements

    def watch_all(segmentation: Segmentation) -> float:
        seen.extend(segmentation.parts)
        return 0.0

    def watch_two(first: Part, second: Part) -> float:
        seen.extend([first, second])
        return 0.0

    made = problem(
        "a b c",
        "watch(*) + watch_two(a, b) + watch_all",
        watch=watch,
        watch_two=watch_two,
        watch_all=watch_all,
    )
    costs = []
    for labelling in itertools.product(range(3), repeat=6):
        found = made.evaluate(flawed, labelling)
        # Faces 4 and 5 have no area: a part made of these alone has no extent.
        gone = sorted({0, 1, 2} - set(labelling[:4]))
        assert found.empty == tuple("abc"[k] for k in gone)
        assert found.cost.empty == len(gone)
        one, two, whole = found.terms
        assert [call.value is None for call in one.calls] == [k in gone for k in range(3)]
        assert (two.calls[0].value is None) == bool({0, 1} & set(gone))
        assert (whole.calls[0].value is None) == bool(gone)
        costs.append(found.cost)
    assert seen
    assert all(part.n_elements > 0 and part.area > 0.5 for part in seen)
    assert all(np.isfinite(part.centroid).all() and part.scales[0] > 0 for part in seen)
    best = {n: min(cost for cost in costs if cost.empty == n) for n in (0, 1, 2)}
    assert best[0] < best[1] < best[2]
    assert max(cost for cost in costs if cost.empty == 0) < best[1]
    assert max(cost for cost in costs if cost.empty == 1) < best[2]


def test_a_term_without_its_parts_counts_nothing(row):
    found = problem("a b", "size(a) + 5*size(b) + gap(a, b) + total").evaluate(row, [0] * 6)
    assert found.cost == Cost(1, 6.0)
    assert [term.value for term in found.terms] == [6.0, 0.0, 0.0, 0.0]
    assert [term.at_worst for term in found.terms] == [()] * 4


def test_measures_come_from_the_registry_of_the_problem(row, site):
    site.add(
        "acme-parts",
        bundles={"acme": "acme_bundle"},
        acme_bundle="""
            from moseg_core import MeasureSpec, ObjectiveSpec, hookimpl

            @hookimpl
            def moseg_objectives():
                return [ObjectiveSpec(name="doubled", target="acme_sizes:doubled")]

            @hookimpl
            def moseg_measures():
                return [MeasureSpec(name="size", target="acme_sizes:size")]
        """,
        acme_sizes="""
            from moseg_core import Part, objective

            def size(part):
                return part.n_elements

            @objective()
            def doubled(part: Part) -> float:
                return 2.0 * part.measure("acme:size")
        """,
    )
    made = Problem(["a"], "doubled(a)", registry=site.discover())
    assert made.evaluate(row, [0] * 6).cost == Cost(0, 12.0)


# --- memory


def test_values_are_computed_once_for_the_same_part(row):
    calls = []

    def counted(part: Part, *, k: float = 0.0) -> float:
        calls.append((part.n_elements, k))
        return k

    made = problem("a b", "counted(a) + 2*counted(a) + counted(a, k=1)", counted=counted)
    memo = Memo()
    made.evaluate(row, [0, 0, 1, 1, 1, 1], memo=memo)
    assert calls == [(2, 0.0), (2, 1.0)]
    made.evaluate(row, [0, 0, 1, 1, 1, 1], memo=memo)
    # The same elements under another label are the same part.
    made.evaluate(row, [1, 1, 0, 0, 0, 0], memo=memo)
    assert calls == [(2, 0.0), (2, 1.0), (4, 0.0), (4, 1.0)]


def test_two_functions_of_one_name_do_not_share_values(row):
    memo = Memo()
    for value in (1.0, 2.0):

        def mine(part: Part, *, is_bound: float = value) -> float:
            return is_bound

        found = problem("a", "mine(a)", mine=mine).evaluate(row, [0] * 6, memo=memo)
        assert found.cost.value == value


# --- shapes that do not do


@objective(requires=("volume",))
def hollow(segmentation: Segmentation) -> float:
    return 0.0


@objective(requires=("adjacency",))
def touching(part: Part) -> float:
    return 0.0


def test_a_shape_without_a_volume_is_refused_with_the_reason(row):
    made = problem("a", "size(a) + 2*hollow", hollow=hollow)
    with pytest.raises(ShapeError) as caught:
        made.evaluate(row, [0] * 6)
    assert str(caught.value) == (
        "'hollow' needs an enclosed volume, but 'row' encloses none: it is open (14 boundary"
        " edges); repair the mesh, leave out the term or have it estimated (--volume"
        " VALUE|hull|winding)"
    )
    assert caught.value.exit_code == 3
    problem("a", "size(a)").check(row)


def test_a_shape_with_a_volume_is_not(box):
    problem("a", "hollow", hollow=hollow).check(box)


def test_a_shape_without_adjacency_is_refused(row):
    made = problem("a", "touching(a)", touching=touching)
    made.check(row)
    with pytest.raises(ShapeError, match="'touching' needs to know which elements touch"):
        made.check(replace(row, adjacency=None))


def test_fewer_elements_than_labels_are_too_few(row):
    problem("a b c d e f", "size(*)").check(row)
    with pytest.raises(ShapeError) as caught:
        problem("a b c d e f g", "size(*)").check(row)
    assert str(caught.value) == "'row' has 6 faces, too few for 7 labels"


@pytest.mark.parametrize(
    "labels", [[0, 0, 0], [0] * 7, [[0] * 6], [0.0] * 6, [0] * 5 + [2], [0] * 5 + [-1], [True] * 6]
)
def test_labels_that_do_not_fit_the_shape_are_refused(row, labels):
    with pytest.raises(ShapeError):
        problem("a b", "size(a)").evaluate(row, labels)


def test_the_command_line_ends_with_3_before_it_searches(tmp_path, capsys):
    path = tmp_path / "sheet.off"
    path.write_text("OFF\n4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n")
    with pytest.raises(SystemExit) as ended:
        main(["segment", str(path), "--labels", "a", "--minimize", "convex_parts"])
    assert ended.value.code == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert "'convex_parts' needs an enclosed volume" in err
    assert "it is open (4 boundary edges)" in err
    assert "Traceback" not in err


# -- Fields -----------------------------------------------------------------------------------


@objective(fields=("fine:height",))
def high(part: Part) -> float:
    return part.field("fine:height").mean


@objective(fields=lambda parameters: ("fine:height", f"fine:{parameters.get('of', 'girth')}"))
def wide(part: Part, *, of: str = "girth") -> float:
    return part.field(f"fine:{of}").mean


@pytest.fixture
def with_fields(site):
    """A registry of two fields, of which one requires a volume."""
    bundle = """
        from moseg_core import FieldSpec, hookimpl

        @hookimpl
        def moseg_fields():
            return [
                FieldSpec(name="height", target="fine_fields:height"),
                FieldSpec(name="girth", target="fine_fields:girth", requires=("volume",)),
            ]
    """
    functions = """
        def height(shape):
            return shape.points[:, 2]

        def girth(shape):
            return shape.areas / shape.volume
    """
    site.add("Fine", "1.0", bundles={"fine": "fine_bundle"}, fine_bundle=bundle)
    (site.folder / "fine_fields.py").write_text(textwrap.dedent(functions))
    return site.discover()


def with_terms(text, registry):
    return Problem(["a", "b"], text, objectives={"high": high, "wide": wide}, registry=registry)


def test_a_problem_names_each_field_once(with_fields):
    assert with_terms("high(a) + high(b)", with_fields).fields == ("fine:height",)
    assert with_terms("high(a) + wide(b)", with_fields).fields == ("fine:height", "fine:girth")
    assert with_terms("wide(b, of=height)", with_fields).fields == ("fine:height",)
    assert Problem(["a"], "size(a)", objectives={"size": size}, registry=NONE).fields == ()


def test_a_shape_that_lacks_what_a_field_requires_is_refused_by_the_term(with_fields):
    flat = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 2], [0, 1, 2]], [[0, 1, 2], [0, 2, 3]])
    problem = with_terms("high(a) + wide(b)", with_fields)
    with pytest.raises(ShapeError, match="'wide' needs an enclosed volume"):
        problem.check(flat)
    with pytest.raises(ShapeError, match="'wide' needs an enclosed volume"):
        problem.evaluate(flat, [0, 1])
    allowed = with_terms("high(a) + wide(b, of=height)", with_fields)
    heights = flat.points[:, 2]
    assert allowed.evaluate(flat, [0, 1]).cost.value == pytest.approx(heights.sum())


def test_a_field_that_nobody_has_is_named_with_the_nearest(with_fields):
    flat = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 2], [0, 1, 2]], [[0, 1, 2], [0, 2, 3]])
    problem = with_terms("wide(b, of=hight)", with_fields)
    with pytest.raises(UsageError, match="unknown field 'fine:hight'; did you mean 'fine:height'"):
        problem.check(flat)
