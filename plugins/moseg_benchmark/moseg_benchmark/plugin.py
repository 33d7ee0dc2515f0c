"""The bundle ``benchmark``: names, targets and nothing heavy."""

from __future__ import annotations

from moseg_core import CommandSpec, hookimpl

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_commands() -> list[CommandSpec]:
    """``moseg benchmark``, with a command for each collection."""
    return [
        CommandSpec(
            name="benchmark",
            target="moseg_benchmark.command:benchmark",
            summary="How well results agree with people.",
        )
    ]
