"""The bundle ``printing``: names, targets and nothing heavy.

moseg imports this module whenever it lists what is installed. What a target names is imported
when somebody uses it.
"""

from __future__ import annotations

from moseg_core import ObjectiveSpec, hookimpl

#: The contract with moseg that the bundle was written for.
moseg_contract = 1


@hookimpl
def moseg_objectives() -> list[ObjectiveSpec]:
    """What the bundle offers."""
    return [
        ObjectiveSpec(
            name="overhang",
            target="moseg_printing.overhang:overhang",
            summary="one part: can be printed as it stands, without support",
        )
    ]
