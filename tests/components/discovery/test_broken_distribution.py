"""Third-party distributions beside the real ones, two of them broken, and the command line.

Wheels are written by hand, installed by pip without a network into a folder on ``PYTHONPATH``,
and met by fresh processes, as a user would meet them.
"""

from __future__ import annotations

import base64
import hashlib
import importlib.util
import json
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import dedent

import pytest

from moseg_core.cli import plugin as plugin_command
from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import ObjectiveSpec
from tests import shapes

Run = Callable[..., subprocess.CompletedProcess[str]]

SHATTERED = {
    "moseg_shattered/__init__.py": "",
    "moseg_shattered/plugin.py": """
        import sys

        print("moseg_shattered is imported", file=sys.stderr)
        raise ImportError("libshatter.so.3: cannot open shared object file")
    """,
}
MISSPELT = {
    "moseg_misspelt.py": """
        from moseg_core import ObjectiveSpec, hookimpl

        @hookimpl
        def moseg_objective():
            return [ObjectiveSpec(name="curved", target="moseg_misspelt:curved")]
    """,
}
ACME = {
    "moseg_acme/__init__.py": "",
    "moseg_acme/plugin.py": """
        from moseg_core import ObjectiveSpec, RecipeSpec, hookimpl

        @hookimpl
        def moseg_objectives():
            return [
                ObjectiveSpec(
                    name="slender",
                    target="moseg_acme.objectives:slender",
                    summary="one part: long for its girth",
                ),
                ObjectiveSpec(name="grumpy", target="moseg_acme.objectives:grumpy"),
            ]

        @hookimpl
        def moseg_recipes():
            return [RecipeSpec(name="tee", target="moseg_acme.recipes:TEE")]
    """,
    "moseg_acme/objectives.py": """
        from typing import Annotated

        from moseg_core import Interval, Part, objective

        @objective(range=(0, 1), invariant_to=("rigid", "scale"))
        def slender(part: Part, *, power: Annotated[float, Interval(1, 4)] = 1.0) -> float:
            return float(part.scales[1] / part.scales[0]) ** power

        @objective(range=(0, 1))
        def grumpy(part: Part) -> float:
            raise ValueError("not today")
    """,
    "moseg_acme/recipes.py": """
        TEE = '''
        description = "A stem and a bar."
        labels = ["stem", "bar"]
        minimize = "slender(*)"
        optimizer = "pattern_search(max_evaluations=20)"
        '''
    """,
}


def write_wheel(
    folder: Path, name: str, version: str, bundles: Mapping[str, str], modules: Mapping[str, str]
) -> Path:
    """A pure-Python wheel: modules, metadata and a record of their digests."""
    stem = f"{name.replace('-', '_')}-{version}"
    info = f"{stem}.dist-info"
    points = "".join(f"{bundle} = {module}\n" for bundle, module in bundles.items())
    files = {path: dedent(source) for path, source in modules.items()} | {
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\n"
        "Tag: py3-none-any\n",
        f"{info}/entry_points.txt": f"[moseg]\n{points}",
    }
    record = ""
    for path, text in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=")
        record += f"{path},sha256={digest.decode()},{len(text.encode())}\n"
    wheel = folder / f"{stem}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for path, text in files.items():
            archive.writestr(path, text)
        archive.writestr(f"{info}/RECORD", f"{record}{info}/RECORD,,\n")
    return wheel


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the three distributions are installed."""
    folder = tmp_path_factory.mktemp("wheels")
    wheels = [
        write_wheel(
            folder,
            "moseg-shattered",
            "0.9.1",
            {"shattered": "moseg_shattered.plugin"},
            SHATTERED,
        ),
        write_wheel(folder, "moseg-misspelt", "2.0", {"misspelt": "moseg_misspelt"}, MISSPELT),
        write_wheel(folder, "moseg-acme", "1.4.0", {"acme": "moseg_acme.plugin"}, ACME),
    ]
    target = folder / "site"
    if importlib.util.find_spec("pip") is not None:
        options = ["--no-deps", "--no-index", "--no-cache-dir", "--disable-pip-version-check"]
        subprocess.run(
            [sys.executable, "-m", "pip", "install", *options, "--target", target, *wheels],
            check=True,
            capture_output=True,
        )
    else:  # what an installer does with a wheel of pure Python
        for wheel in wheels:
            zipfile.ZipFile(wheel).extractall(target)
    return target


@pytest.fixture(scope="module")
def tee(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small T-shaped mesh."""
    vertices, faces = shapes.tee()
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(f"{x:g}" for x in vertex) for vertex in vertices]
    lines += [f"{len(face)} {' '.join(map(str, face))}" for face in faces]
    path = tmp_path_factory.mktemp("meshes") / "tee.off"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def moseg(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Run a command line in a process that sees the distributions."""
    folder = tmp_path_factory.mktemp("work")
    path = os.pathsep.join(filter(None, [str(installed), os.environ.get("PYTHONPATH")]))

    def run(*arguments: str | Path, code: int = 0, **variables: str):
        environment = {k: v for k, v in os.environ.items() if k != "MOSEG_PLUGINS"}
        done = subprocess.run(
            [sys.executable, "-m", "moseg_core", *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=folder,
            env=environment | {"PYTHONPATH": path} | variables,
        )
        assert done.returncode == code, done.stderr
        assert "Traceback" not in done.stderr
        return done

    return run


LABELS = ("--labels", "stem,bar", "--optimizer", "pattern_search(max_evaluations=40)", "--json")

IMPORT_FAILED = (
    "moseg-shattered 0.9.1: importing 'moseg_shattered.plugin' failed with ImportError:"
    " libshatter.so.3: cannot open shared object file; update or reinstall moseg-shattered, or"
    " uninstall it"
)
MISSPELT_HOOK = (
    "moseg-misspelt 2.0: 'moseg_objective' is marked as a hook, but there is no such hook (did you"
    " mean 'moseg_objectives'?); report it to the authors of moseg-misspelt, or uninstall it"
)


def test_the_list_shows_each_bundle_with_its_distribution_and_what_is_wrong(moseg):
    text = " ".join(moseg("plugin", "list").stdout.split())
    assert f"shattered moseg-shattered 0.9.1 set aside: {IMPORT_FAILED}" in text
    assert f"misspelt moseg-misspelt 2.0 set aside: {MISSPELT_HOOK}" in text
    assert "acme moseg-acme 1.4.0 objective acme:slender one part: long for its girth" in text
    assert "core moseg-core " in text
    assert "basic moseg-objectives-basic " in text
    assert text.count("set aside:") == 2


def test_the_list_as_json(moseg):
    bundles = {
        bundle["name"]: bundle for bundle in json.loads(moseg("plugin", "list", "--json").stdout)
    }
    assert {"core", "basic", "acme", "shattered", "misspelt"} <= set(bundles)
    assert bundles["shattered"] == {
        "name": "shattered",
        "distribution": "moseg-shattered",
        "version": "0.9.1",
        "module": "moseg_shattered.plugin",
        "contract": 1,
        "note": "",
        "problem": IMPORT_FAILED,
        "components": [],
    }
    assert bundles["misspelt"]["problem"] == MISSPELT_HOOK
    assert (bundles["misspelt"]["distribution"], bundles["misspelt"]["version"]) == (
        "moseg-misspelt",
        "2.0",
    )
    for name in ("core", "basic", "acme"):
        assert bundles[name]["problem"] is None
        assert bundles[name]["components"]
    assert bundles["acme"]["version"] == "1.4.0"


def test_everything_else_goes_on(moseg, tee):
    done = moseg("segment", tee, *LABELS, "--minimize", "narrow(*) + perpendicular(stem, bar)")
    document = json.loads(done.stdout)
    assert [part["label"] for part in document["parts"]] == ["stem", "bar"]
    assert sum(part["elements"] for part in document["parts"]) == document["elements"] == 46
    assert "set aside" not in done.stderr


@pytest.mark.parametrize(
    ("name", "reason"), [("shattered:thing", IMPORT_FAILED), ("misspelt:curved", MISSPELT_HOOK)]
)
def test_asking_for_a_component_of_a_broken_bundle_gives_the_reason(moseg, tee, name, reason):
    done = moseg("segment", tee, *LABELS, "--minimize", f"{name}(stem)", code=1)
    bundle = name.partition(":")[0]
    assert done.stdout == ""
    assert done.stderr.splitlines()[-1] == (
        f"moseg: objective '{name}' is not available: bundle '{bundle}' is set aside: {reason}"
    )


def test_an_unknown_name_mentions_the_broken_bundles(moseg, tee):
    done = moseg("segment", tee, *LABELS, "--minimize", "3*curved(stem)", code=2)
    headline, text, carets = done.stderr.splitlines()[-3:]
    assert headline.startswith("moseg: unknown objective 'curved' in \"3*curved(stem)\"; ")
    assert headline.endswith("(set aside, see 'moseg plugin list': misspelt, shattered)")
    assert text == "  3*curved(stem)"
    assert carets == "    ^^^^^^"


def test_help_imports_none_of_them(moseg):
    assert moseg("--help").stderr == ""


def test_the_environment_hides_them(moseg, tee):
    done = moseg("plugin", "list", "--json", MOSEG_PLUGINS="core,basic")
    assert [bundle["name"] for bundle in json.loads(done.stdout)] == ["core", "basic"]
    assert done.stderr == ""
    done = moseg(
        "segment", tee, *LABELS, "--minimize", "slender(stem)", code=2, MOSEG_PLUGINS="core,basic"
    )
    assert "unknown objective 'slender'" in done.stderr
    assert "set aside" not in done.stderr


def test_an_installed_objective_is_used_by_name(moseg, tee, tmp_path):
    out = tmp_path / "tee.json"
    minimize = "2*slender(stem, power=2) + acme:slender(bar) + perpendicular(stem, bar)"
    done = moseg("segment", tee, *LABELS, "--minimize", minimize, "-o", out)
    terms = json.loads(done.stdout)["terms"]
    assert [(term["term"], term["objective"], term["weight"]) for term in terms] == [
        ("slender(stem, power=2)", "acme:slender", 2.0),
        ("acme:slender(bar)", "acme:slender", 1.0),
        ("perpendicular(stem, bar)", "basic:perpendicular", 1.0),
    ]
    assert all(0 < term["calls"][0]["value"] < 1 for term in terms[:2])
    versions = json.loads(out.read_text())["versions"]
    assert versions["acme:slender"] == "moseg-acme 1.4.0"
    assert versions["basic:perpendicular"].startswith("moseg-objectives-basic ")


def test_an_installed_recipe_needs_nothing_but_its_bundle(moseg, tee):
    done = moseg("segment", tee, "--recipe", "tee", "--json", MOSEG_PLUGINS="acme")
    (term,) = json.loads(done.stdout)["terms"]
    assert [call["labels"] for call in term["calls"]] == [["stem"], ["bar"]]


def test_its_parameters_are_checked_and_pointed_at(moseg, tee):
    done = moseg("segment", tee, *LABELS, "--minimize", "slender(stem, power=9)", code=2)
    assert done.stderr.splitlines()[-3:] == [
        "moseg: 'slender': parameter 'power' is 9 in \"slender(stem, power=9)\"; allowed is 1 to 4",
        "  slender(stem, power=9)",
        "                ^^^^^",
    ]


def test_its_failure_names_its_distribution(moseg, tee):
    done = moseg("segment", tee, *LABELS, "--minimize", "slender(*) + grumpy(bar)", code=1)
    message = done.stderr.splitlines()[-1]
    assert message.startswith(
        "moseg: objective 'acme:grumpy' of moseg-acme 1.4.0 failed in 'grumpy(bar)' for "
    )
    assert re.search(
        r': ValueError: not today \(\S*moseg_acme/objectives\.py:12: "raise ValueError'
        r'\("not today"\)"\); report it to its authors, or do without it$',
        message,
    )
    # Also while labels are being assigned, and the term is tried on the part of another label.
    assert "for stem" not in message


# --- listing, whatever authors write


@pytest.mark.parametrize(
    "summary", ["length in [mm]", "a [/b] c", "[red]x", "ends in \\", "about [bold]"]
)
def test_a_summary_is_printed_as_it_is(monkeypatch, capsys, summary):
    spec = ObjectiveSpec(name="slim", target="a:b", summary=summary)
    bundle = Bundle("x", "moseg-x", "1.0", "x", (Component("x", "moseg-x 1.0", spec),))
    monkeypatch.setattr(plugin_command, "registry", lambda: Registry((bundle,)))
    plugin_command.run_list(as_json=False)
    assert summary in capsys.readouterr().out


@pytest.mark.parametrize("name", ["[red]", "[/x]", "a[b]c"])
def test_an_odd_namespace_is_printed_as_it_is(monkeypatch, capsys, name):
    bundle = Bundle(name, "moseg-x", "1.0", "x", problem=f"'{name}' is not a valid namespace")
    monkeypatch.setattr(plugin_command, "registry", lambda: Registry((bundle,)))
    plugin_command.run_list(as_json=False)
    assert capsys.readouterr().out.startswith(f"{name}  moseg-x 1.0\n")


def test_long_summaries_fold_under_themselves(monkeypatch, capsys):
    long = " ".join(["as long as it is wide"] * 8)
    specs = [
        ObjectiveSpec(name="slim", target="a:b", summary=long),
        ObjectiveSpec(name="at_length", target="a:b", summary="short"),
    ]
    components = tuple(Component("x", "moseg-x 1.0", spec) for spec in specs)
    bundle = Bundle("x", "moseg-x", "1.0", "x", components)
    monkeypatch.setattr(plugin_command, "registry", lambda: Registry((bundle,)))
    plugin_command.run_list(as_json=False)
    title, first, second, last, end = capsys.readouterr().out.splitlines()
    assert (title, end) == ("x  moseg-x 1.0", "")
    assert first.startswith("  objective  x:slim       as long as it")
    assert last == "  objective  x:at_length  short"
    assert second.startswith(" " * last.index("short"))
    assert len(first) <= 120
    assert f"{first} {second.strip()}".endswith(long)
