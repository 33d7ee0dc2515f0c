"""Commands that bundles bring."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from moseg_core.cli import foreign
from moseg_core.cli.app import app

COMMANDS = """\
    from cyclopts import App
    from moseg_core import UsageError

    def greet(name: str, /, *, twice: bool = False):
        '''Say hello.'''
        print("hello", name, *([name] if twice else []))

    gauge = App(name="gauge", help="How large things are.")

    @gauge.command
    def ball(*, radius: float):
        '''The volume of a ball.'''
        if radius < 0:
            raise UsageError(f"a ball has no radius of {radius:g}")
        print(f"{4.18879 * radius**3:.2f}")
"""
BUNDLE = """\
    from moseg_core import CommandSpec, hookimpl

    @hookimpl
    def moseg_commands():
        return [
            CommandSpec(name="greet", target="acme_commands:greet", summary="Be polite."),
            CommandSpec(name="gauge", target="acme_commands:gauge", summary="Sizes."),
            CommandSpec(name="segment", target="acme_commands:greet", summary="Not mine."),
        ]
"""


@pytest.fixture
def acme(site, monkeypatch):
    """A bundle with two commands, and one that has the name of one of the core's."""
    site.add("acme", bundles={"acme": "acme_bundle"}, acme_bundle=BUNDLE, acme_commands=COMMANDS)
    monkeypatch.setattr(foreign, "registry", site.discover)
    yield site
    for name in ("greet", "gauge", "other:greet"):
        if name in app:
            del app[name]


def test_a_function_is_a_command(moseg, acme):
    run = moseg("greet", "Ann", "--twice")
    assert (run.code, run.out) == (0, "hello Ann Ann\n")
    assert "Say hello." in moseg("greet", "--help").out


def test_an_app_is_a_command_with_commands_of_its_own(moseg, acme):
    run = moseg("gauge", "ball", "--radius", "1")
    assert (run.code, run.out) == (0, "4.19\n")
    assert "How large things are." in moseg("gauge", "--help").out
    assert "The volume of a ball." in moseg("gauge", "ball", "--help").out


def test_errors_of_commands_within_commands_have_their_exit_codes(moseg, acme):
    run = moseg("gauge", "ball", "--radius", "-1")
    assert run.code == 2
    assert run.err == "moseg: a ball has no radius of -1\n"
    run = moseg("gauge", "bal")
    assert run.code == 2
    assert 'Did you mean "ball"' in run.err


def test_the_cores_own_commands_come_first(moseg, acme):
    assert "Cut a shape into named parts." in moseg("segment", "--help").out


def test_a_misspelled_command_suggests_all_and_imports_none(moseg, acme):
    run = moseg("gaug")
    assert run.code == 2
    assert "unknown command 'gaug'; did you mean 'gauge'?" in run.err
    assert "unknown command 'segmen'; did you mean 'segment'?" in moseg("segmen").err
    assert "acme_commands" not in sys.modules


def test_a_command_that_two_bundles_have_is_asked_for_by_its_full_name(moseg, acme):
    other = "def greet():\n    print('good evening')\n"
    bundle = """\
        from moseg_core import CommandSpec, hookimpl

        @hookimpl
        def moseg_commands():
            return [CommandSpec(name="greet", target="other_commands:greet")]
    """
    acme.add("other", bundles={"other": "other_bundle"}, other_bundle=bundle, other_commands=other)
    run = moseg("greet")
    assert run.code == 2
    assert "command 'greet' is ambiguous; say which: acme:greet, other:greet" in run.err
    assert moseg("other:greet").out == "good evening\n"


def test_a_command_that_cannot_be_imported_is_in_nobody_elses_way(moseg, acme):
    (acme.folder / "acme_commands.py").write_text("import nothing_of_the_kind\n")
    run = moseg("gauge", "ball")
    assert run.code == 1
    assert "command 'acme:gauge' of acme 1.0 cannot be loaded" in run.err
    assert "did you mean 'segment'?" in moseg("segmen").err


def test_a_command_of_a_bundle_is_imported_when_it_is_asked_for(site):
    modules = {
        name: f'def {name}() -> None:\n    """Say {name}."""\n    print("said {name}")\n'
        for name in ("hum", "sing")
    }
    hooks = (
        "from moseg_core import CommandSpec, hookimpl\n@hookimpl\ndef moseg_commands():\n"
        "    return [CommandSpec(name=n, target=f'{n}:{n}', summary=n) for n in ('hum', 'sing')]\n"
    )
    site.add("choir", bundles={"choir": "choir_bundle"}, choir_bundle=hooks, **modules)
    code = (
        "import sys\nfrom moseg_core.cli import main\ntry:\n    main(sys.argv[1:])\n"
        "finally:\n    print(sorted({'hum', 'sing'} & set(sys.modules)))\n"
    )
    ended = {}
    for word in ("hum", "hun", "recipes"):
        ended[word] = subprocess.run(
            [sys.executable, "-c", code, word],
            env=os.environ | {"PYTHONPATH": str(site.folder)},
            capture_output=True,
            text=True,
        )
    assert (ended["hum"].returncode, ended["hum"].stdout) == (0, "said hum\n['hum']\n")
    assert (ended["recipes"].returncode, ended["recipes"].stdout[-3:]) == (0, "[]\n")
    assert ended["hun"].returncode == 2
    assert "did you mean 'hum'" in ended["hun"].stderr
