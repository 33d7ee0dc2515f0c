"""Examples in the help of commands."""

from __future__ import annotations

import pytest

from moseg_core.cli.app import app


@pytest.mark.parametrize("command", [name for name in app if not name.startswith("-")])
def test_every_command_has_an_example_in_its_help(moseg, command):
    if command == "plugin":
        command = "plugin new"
    shown = moseg(*command.split(), "--help").out
    lines = [line.strip() for line in shown.partition("Examples")[2].splitlines()]
    assert any(line.startswith(f"moseg {command}") for line in lines), shown


def test_a_command_of_a_bundle_has_them_too(moseg):
    assert "moseg learn " in moseg("learn", "--help").out.partition("Examples")[2]
