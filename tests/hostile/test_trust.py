"""Results, labels, recipes, expressions and names that nobody should trust: each is refused in a
line, or done within bounds, and no terminal obeys a word of it.

All commands run in one child process, under limits on its memory and processor time that are
generous by a factor: what reads a device until memory is full ends there.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

DATA = Path(__file__).parent / "data"
SHAPE = str(DATA / "4_faces.off")

#: Runs commands one after the other, and tells of each exit code, stdout and stderr.
CHILD = """
import contextlib, io, json, resource, sys, traceback

resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
resource.setrlimit(resource.RLIMIT_CPU, (240, 240))
from moseg_core.cli import main

found = []
for command in json.load(sys.stdin):
    out, err = io.StringIO(), io.StringIO()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main(command)
        except SystemExit as ended:
            code = ended.code
        except BaseException:  # what should not be is told, and fails the test
            code = traceback.format_exc()
    seconds = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
    found.append((code, out.getvalue(), err.getvalue(), seconds))
print(json.dumps(found))
"""

RESULTS = ("bigint_labels", "term_null", "markup", "warning_escape", "deep")
TERM = ("--labels", "a,b", "--minimize", "narrow(a)")


def data(name: str) -> str:
    return str(DATA / name)


def recipes(folder: Path) -> dict[str, str]:
    """Recipes that ask for too much, by name."""
    plain = 'labels = ["a", "b"]\nminimize = "narrow(a)"\n'
    many = " + ".join(100_000 * ["flat(a)"])

    def part(name: str) -> str:
        return f"{plain}[parts.a]\nrecipe = {json.dumps(name)}\n"

    outside = folder.parent / "outside.toml"
    outside.write_text(plain)
    os.mkfifo(folder / "pipe.toml")
    (folder / "link.toml").symlink_to(outside)
    (folder / "circle.toml").symlink_to("circle.toml")
    (folder / "zero.toml").symlink_to("/dev/zero")
    (folder / "large.toml").write_text(plain + "#" * 2**20)
    (folder / "mine.txt").write_text(plain)
    (folder / "folder.toml").mkdir()
    return {
        "pipe": part("./pipe.toml"),
        "up": part("../outside.toml"),
        "up and down": part(f"../{folder.name}/mine.toml"),
        "root": part(str(outside)),
        "passwd": part("../../../../../../etc/passwd"),
        "link": part("./link.toml"),
        "circle": part("./circle.toml"),
        "zero": part("./zero.toml"),
        "large part": part("./large.toml"),
        "text": part("./mine.txt"),
        "folder": part("./folder.toml"),
        "NUL": part("./a\0.toml"),
        "long": part("./" + 5000 * "a" + ".toml"),
        "itself": part("./itself.toml"),
        "lists": "labels = " + 50_000 * "[",
        "tables": plain + "given = " + 50_000 * "{a = ",
        "points": plain + "given." + ".".join(50_000 * "a") + " = 1",
        "parts": plain + "".join(f"[{'parts.a.' * k}parts.a]\n{plain}" for k in range(40)),
        "digits": plain + "seed = " + 5000 * "9",
        "starts": plain + "restarts = 1000000000",
        "finalists": plain + "finalists = 9223372036854775807",
        "a count": plain.replace('"b"', '"b{1000000000}"'),
        "a long count": plain.replace('"b"', '"b{' + 5000 * "9" + '}"'),
        "sets": plain.replace('"b"', ", ".join(f'"b{k}_{{0..9}}"' for k in range(9))),
        "labels": plain.replace('"b"', ", ".join(f'"b{k}"' for k in range(50_000))),
        "a long label": plain.replace('"b"', f'"{10_000 * "b"}"'),
        "a label that is a path": plain.replace('"b"', '"../../x"'),
        "a label of two lines": plain.replace('"b"', '"b\\nc"'),
        "a label from right to left": plain.replace('"b"', '"b\u202ec"'),
        "a label that is a device": plain.replace('"b"', '"con."'),
        "many terms": plain.replace("narrow(a)", many),
        "a mistake in many terms": plain.replace("narrow(a)", many + " + narow(a)"),
        "parentheses": plain.replace("narrow(a)", 10_000 * "("),
        "parentheses in a call": plain.replace("narrow(a)", f"narrow{10_000 * '('}{10_000 * ')'}"),
        "parameters": plain.replace(
            "(a)", "(a, " + ", ".join(f"k{k}=1" for k in range(9000)) + ")"
        ),
        "stars": plain.replace("(a)", f"({5000 * '*a'})"),
        "a weight": plain.replace("narrow", "1e308*narrow"),
        "a weight of digits": plain.replace("narrow", 400 * "9" + "*narrow"),
        "an escape in a key": f'{plain}"\\u001b[2J" = 1',
        "an escape in a plane": f'{plain}plane = "\\u001b[2J"\nconstraints = ["on_plane(a)"]',
        "an escape in a seeder": f'{plain}seeder = "\\u001b[2J"',
        "an escape in a table": f'{plain}[given.a]\n"\\u009b1A" = [1]',
        "an escape in a recipe": f'{plain}[parts.a]\nrecipe = "\\u001b]0;x\\u0007"',
        "an escape in a label": plain.replace('"b"', '"\\u001b[2J"'),
        "an escape in an expression": plain.replace("narrow(a)", "\\u009d0;x\\u009c(a)"),
        "markup": plain.replace("narrow(a)", "[/x](a)"),
    }


def labels(folder: Path) -> dict[str, str | bytes]:
    """Files of labels by name, all for four faces and all to be read or refused."""
    return {
        "escape.txt": "leg\x1b[2J\x07\n1 2\nbody\u202e\n3 4\n",
        "lines.json": json.dumps(["a\nb", "a\nb", "c\u2028d", "e"]),
        "long.txt": f"{10_000 * 'a'}\n1 2\n{10_000 * 'a'}b\n3 4\n",
        "paths.txt": "../../x\n1\ncon\n2\n[bold]\n3\n<script>alert(1)</script>\n4\n",
        "pair.json": '["\\ud800", "a", "a", "a"]',
        "deep.json": 100_000 * "[",
        "digits.json": f"[{5000 * '9'}, 1, 1, 1]",
        "large.json": "[1e999, 1, 1, 1]",
        "large.txt": f"1\n1\n1\n{5000 * '9'}\n",
        "far.txt": "0\n1\n2\n999999999999\n",
        "names.json": json.dumps({"labels": [0, 1, 0, 1], "names": {"9" * 18: "x", "0": "a"}}),
        "cells.csv": 'face,part\n0,"' + 200_000 * "a" + '"\n1,b\n2,b\n3,b\n',
        "digits.csv": f"face,label\n{5000 * '9'},a\n1,b\n2,c\n3,d\n",
        "nothing.npz": b"PK\x05\x06" + bytes(18),
    }


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """What each command came to, by its words."""
    folder = tmp_path_factory.mktemp("trust")
    inner = folder / "recipes"
    inner.mkdir()
    commands: dict[str, list[str]] = {}
    for name in ("nested2000", "int5000", "restarts_1e9", "part_dev_zero", "escape"):
        recipe = data(f"recipe_{name}.toml")
        commands[f"recipe_{name}"] = ["segment", SHAPE, "--recipe", recipe, "--max-seconds", "3"]
    commands["exponential"] = ["segment", SHAPE, "--recipe", data("exponential/e0.toml")]
    for name, text in recipes(inner).items():
        path = inner / (f"{name}.toml" if name == "itself" else f"a {name}.toml")
        path.write_text(text)
        commands[f"recipe {name}"] = ["segment", SHAPE, "--recipe", str(path)]
    for path in ("/dev/zero", inner / "pipe.toml", inner / "zero.toml", inner / "large.toml"):
        commands[f"recipe at {Path(path).name}"] = ["segment", SHAPE, "--recipe", str(path)]
    for name in RESULTS:
        path = data(f"result_{name}.json")
        for command in (
            ["explain", path],
            ["measure", path],
            ["plot", path, "-o", str(folder / "a.svg")],
            ["export", path, "-o", str(folder / "a.ply")],
            ["view", SHAPE, path, "--no-open", "-o", str(folder / "a.html")],
            ["render", SHAPE, path, "-o", str(folder / "a.png")],
            ["evaluate", SHAPE, path, path],
            ["explain", SHAPE, "--parts", path, *TERM],
            ["segment", SHAPE, *TERM, "--start", path],
            ["segment", SHAPE, *TERM, "--seeder", "given", "--start", path],
        ):
            commands[f"result_{name} {command[0]} {len(command)}"] = command
    for name in ("hugeshape.npz", "minus.npz", "deepd.npz", "markup.txt"):
        path = data(f"labels_{name}")
        commands[f"labels_{name}"] = ["evaluate", SHAPE, path, path]
    for name, content in labels(folder).items():
        path = folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        commands[f"labels {name}"] = ["evaluate", SHAPE, str(path), str(path)]
    for suffix in (".off", ".json", ".npz", ".txt", ".ply", ".nii"):
        pipe = folder / f"pipe{suffix}"
        os.mkfifo(pipe)
        if suffix != ".off":
            commands[f"pipe {suffix}"] = ["evaluate", SHAPE, str(pipe), str(pipe)]
        if suffix in (".off", ".ply", ".nii"):
            commands[f"shape pipe {suffix}"] = ["segment", str(pipe), *TERM]
    zero = folder / "zero.json"
    zero.symlink_to("/dev/zero")
    commands["zero explain"] = ["explain", str(zero)]
    commands["zero evaluate"] = ["evaluate", SHAPE, str(zero), str(zero)]
    for word in ("1e308*narrow(a)+1e308*narrow(b)", "-1e200*narrow(a)"):
        commands[f"weight {word}"] = ["segment", SHAPE, "--labels", "a,b", f"--minimize={word}"]
    commands["json"] = ["evaluate", SHAPE, *2 * [str(folder / "escape.txt")], "--json"]
    for suffix in (".html", ".png"):
        command = ["view" if suffix == ".html" else "render", SHAPE, str(folder / "long.txt")]
        more = ["--no-open"] if suffix == ".html" else []
        commands[f"long {suffix}"] = [*command, *more, "-o", str(folder / f"long{suffix}")]
    script = ["view", SHAPE, str(folder / "paths.txt"), "--no-open"]
    commands["script"] = [*script, "-o", str(folder / "script.html")]
    done = subprocess.run(
        [sys.executable, "-c", CHILD],
        input=json.dumps(list(commands.values())),
        capture_output=True,
        text=True,
        cwd=folder,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(zip(commands, json.loads(done.stdout), strict=True)), folder


def is_safe(text: str) -> bool:
    """Whether a terminal shows every character, and obeys none."""
    return text.replace("\n", "").isprintable()


def test_everything_is_told_in_a_line_that_no_terminal_obeys(runs):
    for name, (code, out, err, _) in runs[0].items():
        assert code in (0, None, 2, 3), (name, code, err)
        assert is_safe(out + err), name
        assert len(err) < 3000, name
        if code:
            # An expression is repeated with a caret below it.
            assert len(err.splitlines()) in (1, 3), (name, err)


def test_nothing_takes_long(runs):
    slow = {name: seconds for name, (*_, seconds) in runs[0].items() if seconds > 20}
    assert slow == {}


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("recipe_nested2000", "lists and tables are nested more than 64 deep"),
        ("recipe_int5000", "has a value that is too large"),
        ("recipe_restarts_1e9", "there are at most 10000 starts, not 1000000000"),
        ("recipe_part_dev_zero", "names '/dev/zero' for a part"),
        ("recipe_escape", r"unexpected character '\x1b' in"),
        ("exponential", "parts on all levels together; the most is 1000"),
        ("recipe at zero", "it is a device, not a file"),
        ("recipe at pipe.toml", "it is a pipe, not a file"),
        ("recipe at large.toml", "it is larger than 1 MB"),
        ("recipe link", "names './link.toml' for a part"),
        ("recipe pipe", "it is a pipe, not a file"),
        ("recipe itself", "is among its own parts"),
        ("recipe a label that is a path", "label '../../x' is not allowed"),
        ("recipe a long label", "has 10000 characters; labels have at most 200"),
        ("recipe a mistake in many terms", "an expression has at most 100000 characters"),
        ("weight 1e308*narrow(a)+1e308*narrow(b)", "the weight 1e+308 is too large"),
    ],
)
def test_a_recipe_or_expression_that_asks_for_too_much_is_a_usage_error(runs, name, says):
    code, _, err, _ = runs[0][name]
    assert (code, says in err) == (2, True), err


def test_every_recipe_that_asks_for_too_much_is_refused(runs):
    codes = {name: run[0] for name, run in runs[0].items() if name.startswith("recipe")}
    assert {name for name, code in codes.items() if code != 2} == set()
    assert len(codes) > 50


@pytest.mark.parametrize("name", RESULTS)
def test_a_damaged_result_is_refused_by_every_command(runs, name):
    found = {key: run for key, run in runs[0].items() if key.startswith(f"result_{name} ")}
    assert len(found) == 10
    for key, (code, _, err, _) in found.items():
        # As a file of labels it is one of another shape.
        of_labels = key.split()[1] in ("evaluate", "render", "view") or key.endswith("explain 8")
        assert code == (3 if of_labels else 2), (key, err)


@pytest.mark.parametrize("name", ["hugeshape", "minus", "deepd"])
def test_labels_whose_headers_lie_are_refused(runs, name):
    code, _, err, _ = runs[0][f"labels_{name}.npz"]
    assert (code, len(err) < 300) == (3, True)


def test_names_of_labels_are_printed_as_they_are(runs):
    code, out, _, _ = runs[0]["labels_markup.txt"]
    assert code in (0, None)
    assert "wing[/left]" in out
    for name in ("lines.json", "paths.txt", "escape.txt"):
        assert runs[0][f"labels {name}"][0] in (0, None)
    assert r"leg\x1b[2J" in runs[0]["labels escape.txt"][1]
    assert "[bold]" in runs[0]["labels paths.txt"][1]


def test_json_on_stdout_stays_json(runs):
    code, out, _, _ = runs[0]["json"]
    assert code in (0, None)
    assert json.loads(out)["truths"][0]["confusion"]["true_names"]


@pytest.mark.parametrize("suffix", [".html", ".png"])
def test_long_names_are_drawn_in_bounded_time(runs, suffix):
    (code, _, err, _), folder = runs[0][f"long {suffix}"], runs[1]
    assert code in (0, None), err
    assert (folder / f"long{suffix}").stat().st_size < 10**7


def test_a_name_is_no_script_on_the_page(runs):
    page = (runs[1] / "script.html").read_text()
    assert "alert(1)" in page
    assert "<script>alert(1)" not in page


@pytest.mark.parametrize("suffix", [".off", ".json", ".npz", ".txt", ".ply", ".nii"])
def test_a_pipe_is_no_file(runs, suffix):
    for name in (f"pipe {suffix}", f"shape pipe {suffix}"):
        if name in runs[0]:
            code, _, err, _ = runs[0][name]
            assert (code, "a pipe" in err) == (3, True), err


def test_a_device_is_no_file(runs):
    assert "it is a device, not a file" in runs[0]["zero explain"][2]
    assert "it is a device, not a file" in runs[0]["zero evaluate"][2]
