"""The bundle ``learn``: names, targets and nothing heavy."""

from __future__ import annotations

#: The contract with moseg that the bundle was written for.
moseg_contract = 1
