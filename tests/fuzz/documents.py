"""Results, recipes and expressions that nobody wrote: any value anywhere, circles, bombs."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case, Made
from tests.fuzz.labellings import HOSTILE_NAMES
from tests.fuzz.statements import RECIPE, box_file, result, result_bytes

VALUES: tuple[Any, ...] = (
    *(None, True, -1, 0.5, 1e308, -1e308, 2**31, 2**63, 2**64, 10**400, float("nan"), float("inf")),
    *(
        "",
        "x",
        "\x1b]0;owned\x07",
        "\u202egnp",
        "x" * 10_000,
        "[/x]",
        [],
        [[]],
        [None],
        {},
        {"": 0},
    ),
    *([0] * 44, ["a"] * 44, [{}], {"x": {"x": {}}}),
)


def document_cases() -> Iterator[Case]:
    yield from _results()
    yield from _recipes()
    yield from _expressions()


def _shown(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) < 30 else f"{text[:20]}... of {len(text)}"


# --- results

_PLACES: tuple[tuple[Any, ...], ...] = (
    *((key,) for key in ("format", "shape", "problem", "cost", "terms", "parts", "method",
      "dimension")),
    *((key,) for key in ("seed", "reason", "warnings", "versions", "history", "labels")),
    *(("shape", key) for key in ("name", "file", "elements", "fingerprint", "notes")),
    *(("problem", key) for key in ("labels", "minimize", "constraints", "embedding", "levels",
      "given")),
    *(("cost", key) for key in ("value", "empty", "broken_pins")),
    *(("terms", 0, key) for key in ("term", "objective", "weight", "value", "weighted", "worst",
      "calls")),
    ("terms", 0), ("terms", 0, "calls", 0), ("terms", 0, "calls", 0, "labels"),
    ("terms", 0, "calls", 0, "value"), ("terms", 0, "calls", 0, "details"), ("parts", 0),
    *(("parts", 0, key) for key in ("label", "elements", "area", "center", "weight", "more")),
    *(("method", key) for key in ("seeder", "optimizer", "settings", "resolution", "restarts")),
    ("dimension", "free"), ("versions", "core:voronoi"), ("history", "search"),
    ("history", "search", 0), ("history", "search", 0, "value"), ("labels", 0), ("warnings", 0),
)  # fmt: skip


def _results() -> Iterator[Case]:
    def changed(kind: str, name: str, change: Callable[[dict[str, Any]], Any],
                expected: str = EITHER) -> Case:  # fmt: skip
        def make() -> Made:
            document = copy.deepcopy(result())
            text = change(document)
            return {"": text if isinstance(text, bytes) else result_bytes(document), **box_file()}

        return Case(format="result", suffix=".json", kind=kind, name=name, make=make, task="result",
                    expected=expected, elements=(44, 44))  # fmt: skip

    for place in _PLACES:
        where = ".".join(map(str, place))
        for value in VALUES:
            yield changed(
                "structure",
                f"{where}: {_shown(value)}",
                lambda d, place=place, value=value: _put(d, place, value),
            )
        if not isinstance(place[-1], int):
            yield changed("structure", f"no {where}", lambda d, place=place: _drop(d, place))
    for name, hostile in HOSTILE_NAMES.items():
        yield changed(
            "names",
            f"a part called {name}",
            lambda d, h=hostile: _all(
                _put(d, ("problem", "labels"), [h, "handle"]), _put(d, ("parts", 0, "label"), h)
            ),
        )
        yield changed(
            "names", f"a warning of {name}", lambda d, h=hostile: _put(d, ("warnings",), [h])
        )
        yield changed(
            "names", f"a shape at {name}", lambda d, h=hostile: _put(d, ("shape", "file"), h)
        )
    for file in ("/dev/zero", "/dev/stdin", "/etc/passwd", "../../../etc/passwd", "/proc/self/mem",
      ".",
                 "/", "x" * 5000 + ".off", "case.json", "missing.off", "box.off/"):  # fmt: skip
        shown = file if len(file) < 40 else "a name of 5,000 characters"
        yield changed(
            "references", f"a shape at {shown}", lambda d, f=file: _put(d, ("shape", "file"), f)
        )
    for n in (500, 2000, 100_000):
        yield changed(
            "nesting",
            f"{n} lists in each other",
            lambda d, n=n: b'{"format": "moseg-result/1", "labels": ' + b"[" * n + b"]" * n + b"}",
            REFUSED,
        )
        yield changed(
            "nesting",
            f"a warning {n} lists deep",
            lambda d, n=n: result_bytes({**d, "warnings": "?"}).replace(
                b'"?"', b"[" * n + b"]" * n
            ),
        )
        yield changed(
            "nesting",
            f"history {n} objects deep",
            lambda d, n=n: result_bytes({**d, "history": "?"}).replace(
                b'"?"', b'{"a":' * n + b"1" + b"}" * n
            ),
        )
    for digits in (400, 5000, 3_000_000):
        for key in ("seed", "labels"):
            yield changed("numbers", f"{key}: an integer of {digits} digits", lambda d, k=key,
              n=digits: (
                result_bytes({**d, k: "?"}).replace(
                    b'"?"', b"9" * n if k == "seed" else b"[" + b"9" * n + b"]")))  # fmt: skip
    yield changed("large", "a million labels", lambda d: d.update(labels=[0] * 1_000_000), REFUSED)
    yield changed("large", "100,000 terms", lambda d: d.update(terms=d["terms"] * 50_000))
    yield changed("large", "100,000 parts", lambda d: d.update(parts=d["parts"] * 50_000))
    yield changed("large", "100,000 warnings", lambda d: d.update(warnings=["a"] * 100_000))
    yield changed(
        "large",
        "an expression of 100,000 terms",
        lambda d: _put(d, ("problem", "minimize"), " + ".join(["narrow(head)"] * 100_000)),
    )


def _all(*done: Any) -> None:
    """Nothing: what the arguments did is what counts."""


def _put(document: Any, place: Sequence[Any], value: Any) -> None:
    for key in place[:-1]:
        document = document[key]
    document[place[-1]] = value


def _drop(document: Any, place: Sequence[Any]) -> None:
    for key in place[:-1]:
        document = document[key]
    if isinstance(document, dict):
        document.pop(place[-1], None)


# --- recipes

_SMALL = 'description = "a"\nlabels = ["head", "handle"]\nminimize = "narrow(handle)"\n'
_TOML_VALUES = (
    '""', '"x"', "0", "-1", "1.5", "nan", "inf", "-inf", "1e308", "9223372036854775807", "true",
      "[]",
    "[[]]", "{}", '[""]', "[1, 2]", '["a", "a"]', '["a", 1]', "1979-05-27", "07:32:00",
    "9" * 400, '"""\nmany\nlines"""', '"\\u001b]0;owned\\u0007"', '"\\u202egnp"', '"[/x]"',
    '["' + "x" * 10_000 + '"]', '"' + "y" * 10_000 + '"', '{ a = { b = { c = 1 } } }', '["*"]',
      '["**"]',
    '["a{2..1}"]', '["a{0..0}"]', '["a{1..1000000000}"]', '["a{99999999999999999999}"]',
      '["a{-1}"]',
    '["a{0..9}", "b{0..9}", "c{0..9}", "d{0..9}", "e{0..9}", "f{0..9}"]', '["part*", "b*"]',
)  # fmt: skip
_KEYS = ("description", "labels", "minimize", "seeder", "labeler", "optimizer", "refiner",
  "resolution",
         "restarts", "finalists", "polished", "constraints", "plane", "embedding", "space",
         "given", "parts", "variants", "learned_from", "adjacency", "typo")  # fmt: skip


def _recipe(kind: str, name: str, made: Made | Callable[[], Made], expected: str = EITHER) -> Case:
    make = made if callable(made) else lambda: made
    return Case(format="recipe", suffix=".toml", kind=kind, name=name, make=make, task="recipe",
                expected=expected, elements=(1, 100_000))  # fmt: skip


def _recipes() -> Iterator[Case]:
    for key in _KEYS:
        lines = [line for line in _SMALL.splitlines() if not line.startswith(f"{key} ")]
        rest = "\n".join(lines) + "\n"
        yield _recipe("structure", f"no {key}", rest.encode())
        for value in _TOML_VALUES:
            shown = value if len(value) < 40 else f"{value[:20]}... of {len(value)}"
            yield _recipe("structure", f"{key} = {shown!r}", f"{rest}{key} = {value}\n".encode())
    for name, hostile in HOSTILE_NAMES.items():
        if name == "half of a pair":
            continue
        quoted = json.dumps(hostile, ensure_ascii=True)
        yield _recipe("names", f"a part called {name}", _SMALL.replace('"head"', quoted).encode())
        yield _recipe("names", f"a key called {name}", f"{_SMALL}{quoted} = 1\n".encode(), REFUSED)
        yield _recipe(
            "names",
            f"an objective called {name}",
            _SMALL.replace('"narrow(handle)"', json.dumps(f"{hostile}(handle)")).encode(),
            REFUSED,
        )
        yield _recipe("names", f"a plane called {name}", f"{_SMALL}plane = {quoted}\n".encode())
        yield _recipe("names", f"a seeder called {name}", f"{_SMALL}seeder = {quoted}\n".encode())
        yield _recipe(
            "references",
            f"a part's recipe at {name}",
            f"{_SMALL}[parts.head]\nrecipe = {quoted}\n".encode(),
            REFUSED,
        )
    for file in ("./case.toml", "case.toml", "/etc/passwd", "../../../../etc/passwd", "/dev/zero",
                 "/dev/random", "/proc/self/mem", ".", "./", "/", "./missing.toml",
                   "./sub/../case.toml",
                 "./big.toml", "./sub", "./a.txt", "~/x.toml", "file:///etc/passwd"):  # fmt: skip
        yield _recipe("references", f"a part's recipe at {file}", lambda file=file: {
            "": f'{_SMALL}[parts.head]\nrecipe = "{file}"\n'.encode(), "a.txt": _SMALL.encode(),
            "big.toml": b"#" * 3_000_000, "sub/b.toml": _SMALL.encode()}, REFUSED)  # fmt: skip
    yield _recipe("references", "a part's recipe beside it", lambda: {
        "": f'{_SMALL}[parts.head]\nrecipe = "./sub/b.toml"\n'.encode(),
        "sub/b.toml": _SMALL.encode()}, SOUND)  # fmt: skip
    yield _recipe("references", "two recipes that are each other's part", lambda: {
        "": f'{_SMALL}[parts.head]\nrecipe = "./b.toml"\n'.encode(),
        "b.toml": f'{_SMALL}[parts.head]\nrecipe = "./case.toml"\n'.encode()}, REFUSED)  # fmt: skip
    yield from _recipe_bombs()


def _levels(depth: int, width: int) -> Made:
    """Recipes each of which has the next for all of its parts."""
    labels = [f"p{k}" for k in range(width)]
    head = f"description = 'a'\nlabels = {labels}\nminimize = 'short_boundaries'\n"
    parts = "".join(f"[parts.{label}]\nrecipe = './r%d.toml'\n" for label in labels)
    files = {f"r{k}.toml": (head + parts % ((k + 1,) * width)).encode() for k in range(1, depth)}
    return {"": (head + parts % ((1,) * width)).encode(), **files, f"r{depth}.toml": head.encode()}


def _recipe_bombs() -> Iterator[Case]:
    for depth, width in ((3, 4), (9, 4), (40, 2), (30, 1), (300, 1)):
        yield _recipe(
            "expansion",
            f"{width}^{depth} parts",
            lambda d=depth, w=width: _levels(d, w),
            EITHER if depth in (3, 30) else REFUSED,
        )
    for n in (100, 2000, 50_000):
        dotted = ".".join(["parts.head"] * n)
        yield _recipe(
            "nesting",
            f"{n} arrays in each other",
            f"{_SMALL}x = {'[' * n}{']' * n}".encode(),
            REFUSED,
        )
        yield _recipe(
            "nesting",
            f"{n} tables in each other",
            f"{_SMALL}x = {'{a=' * n}1{'}' * n}".encode(),
            REFUSED,
        )
        yield _recipe(
            "nesting", f"a key of {n} words", f"{_SMALL}{'a.' * n}a = 1".encode(), REFUSED
        )
        yield _recipe(
            "nesting", f"a table of {n} words", f"{_SMALL}[{'a.' * n}a]".encode(), REFUSED
        )
        yield _recipe("nesting", f"parts {n} deep", f"{_SMALL}[{dotted}]\nlabels = ['a']".encode())
        yield _recipe("nesting", f"given {n} deep", f"{_SMALL}[given.{'a.' * n}a]\nb = 1".encode())
        many = ", ".join(f'"p{k}"' for k in range(n))
        yield _recipe("large", f"{n} labels", _SMALL.replace('"head"', many).encode())
        yield _recipe(
            "large",
            f"{n} parts",
            (_SMALL + "".join(f"[parts.p{k}]\nlabels = ['a']\n" for k in range(n))).encode(),
            REFUSED,
        )
        yield _recipe(
            "large",
            f"{n} tables given",
            (_SMALL + "".join(f"[given.p{k}]\narea = '1+-1'\n" for k in range(n))).encode(),
        )
        variants = ", ".join('["head", "handle"]' for _ in range(n))
        yield _recipe("large", f"{n} variants", f"{_SMALL}variants = [{variants}]".encode())
    for digits in (5000, 3_000_000):
        yield _recipe(
            "numbers",
            f"an integer of {digits} digits",
            f"{_SMALL}restarts = {'9' * digits}".encode(),
            REFUSED,
        )
        yield _recipe(
            "numbers",
            f"a float of {digits} digits",
            f"{_SMALL}restarts = 0.{'9' * digits}".encode(),
            REFUSED,
        )
    for key in ("restarts", "finalists", "polished", "resolution"):
        for value in (
            "1000000000",
            "1000",
            "9223372036854775807",
            "9223372036854775808",
            "0",
            "-1",
            "2.0",
        ):
            yield _recipe("numbers", f"{key} = {value}", f"{_SMALL}{key} = {value}\n".encode())
    yield _recipe("large", "3 megabytes of comments", (_SMALL + "# a\n" * 750_000).encode())
    yield _recipe("structure", "labels twice", (_SMALL + 'labels = ["a"]\n').encode(), REFUSED)
    yield _recipe("structure", "nothing", b"# nothing\n", REFUSED)
    yield _recipe("structure", "JSON", json.dumps({"labels": ["a"]}).encode(), REFUSED)
    yield _recipe("encoding", "NUL", RECIPE.encode() + b"\0", REFUSED)


# --- expressions


def _expressions() -> Iterator[Case]:
    def words(kind: str, name: str, text: str | Callable[[], str], expected: str = EITHER) -> Case:
        def make() -> bytes:
            made = text() if callable(text) else text
            return made.encode("utf-8", "surrogatepass")

        return Case(format="expression", suffix=".expression", kind=kind, name=name, make=make,
                    task="expression", expected=expected, elements=(1, 100_000))  # fmt: skip

    for n in (1000, 100_000):
        terms = " + ".join(["narrow(head)"] * n)
        yield words("large", f"{n} terms", terms)
        yield words("large", f"{n} terms and a typing error", f"{terms} + narow(head)", REFUSED)
        yield words("large", f"{n} terms and no end", f"{terms} +", REFUSED)
        yield words("large", f"{n} labels", f"similar({', '.join(['head'] * n)})")
        yield words(
            "large",
            f"{n} parameters",
            f"narrow(head, {', '.join(f'a{k}=1' for k in range(n))})",
            REFUSED,
        )
        yield words("nesting", f"{n} parentheses", "narrow" + "(" * n + "head" + ")" * n, REFUSED)
        yield words(
            "nesting", f"{n} calls in each other", "narrow(" * n + "head" + ")" * n, REFUSED
        )
        yield words("nesting", f"{n} signs", "-" * n + "narrow(head)", REFUSED)
        yield words("nesting", f"a path of {n} words", f"narrow(head, given={'a.' * n}a)", REFUSED)
        yield words("large", f"a name of {n} letters", f"{'a' * n}(head)", REFUSED)
        yield words("large", f"a label of {n} letters", f"narrow({'a' * n})", REFUSED)
        yield words("large", f"a number of {n} digits", f"{'9' * n}*narrow(head)")
        yield words("large", f"a fraction of {n} digits", f"0.{'9' * n}*narrow(head)")
        yield words("large", f"a quote of {n} letters", f'narrow(head, a="{"x" * n}")', REFUSED)
        yield words("large", f"{n} blanks", " " * n + "narrow(head)", SOUND if n < 9999 else EITHER)
        yield words("large", f"{n} stars", f"narrow({'*' * n})")
        yield words("large", f"{n} globs", f"similar({', '.join(['h*'] * n)})")
        yield words("large", f"a glob of {n} stars", f"narrow({'h*' * n}x)", REFUSED)
    for weight in ("1e308", "1e309", "-1e308", "1e-320", "0", "-0", "nan", "inf", "1e", ".5", "5.",
      "1_0",
                   "0x1", "1e+", "--1", "\u0661", "1e99999999999"):  # fmt: skip
        yield words("numbers", f"the weight {weight}", f"{weight}*narrow(head)")
        yield words(
            "numbers",
            f"the weight {weight} twice",
            f"{weight}*narrow(head) + {weight}*narrow(handle)",
        )
        yield words("numbers", f"an area of {weight}", f"is(head, area={weight}+-0.1)")
        yield words("numbers", f"an area give or take {weight}", f"is(head, area=0.1+-{weight})")
        yield words("numbers", f"a bound of {weight}", f"area_fraction(head, least={weight})")
    for name, hostile in HOSTILE_NAMES.items():
        for what, text in (
            ("a name", "{}(head)"),
            ("a label", "narrow({})"),
            ("a key", "narrow(head, {}=1)"),
            ("a value", "narrow(head, a={})"),
            ("a quote", 'narrow(head, a="{}")'),
            ("a space", "narrow(head) @ {}"),
            ("anything", "narrow(head) {}"),
        ):
            yield words("names", f"{name} as {what}", text.replace("{}", hostile))
    for text in (
        "",
        "   ",
        "+",
        "(",
        ")",
        "()",
        "narrow",
        "narrow(",
        "narrow(head",
        "narrow(head,)",
        "narrow(,head)",
        "narrow()",
        "narrow(head))",
        "narrow(head) narrow(head)",
        "3",
        "3*",
        "*3",
        "3*3*narrow(head)",
        "narrow(head)*3",
        "narrow(head) @",
        "@",
        "narrow(head) @ mds @ mds",
        ":narrow(head)",
        "basic:(head)",
        "basic:narrow:x(head)",
        "basic::narrow(head)",
        "a=1",
        "narrow(a=1)",
        "narrow(head, a=)",
        "narrow(head, =1)",
        "narrow(head, a=1, a=2)",
        "narrow(head head)",
        "narrow(1)",
        "narrow('head')",
        'narrow("head")',
        "narrow(head;)",
        "narrow(head); import os",
        "__import__('os')",
        "narrow(head) # a",
        "narrow(head, given=)",
        "narrow(head, given=.)",
        "narrow(head, given=a..b)",
        "narrow(head, given=nowhere)",
        "is(head, area=1+-)",
        "is(head, area=+-1)",
        "is(head, area=1+-1+-1)",
        "is(head, area=1\u00b1-1)",
        "narrow(head, head)",
        "perpendicular(head)",
        "perpendicular(head, head)",
        "narrow(*)",
        "narrow(tail)",
        "convex_parts(head)",
        'narrow(head, a="\\x")',
        'narrow(head, a="',
        "\\",
    ):
        yield words("structure", f"'{text}'", text)
