"""The contract kit: checks of whether components keep what their kinds promise.

For the authors of bundles, in one line of their tests (``pytest`` is theirs, not ours)::

    from moseg_core.testing import parametrize_contract

    @parametrize_contract("mybundle")
    def test_contract(check):
        check()

and the same without it: ``moseg plugin check mybundle``. Both go through the installed entry
point, so that the packaging is tested too. What is checked, and why, is in
:func:`load_checks`; a table of it in ``docs/authors/checks.md``.
"""

from moseg_core.testing.check import CHECKS, Check, ContractFailure, Subject, check
from moseg_core.testing.run import (
    Case,
    Outcome,
    cases_of,
    load_checks,
    parametrize_contract,
    run_cases,
)

__all__ = [
    "CHECKS",
    "Case",
    "Check",
    "ContractFailure",
    "Outcome",
    "Subject",
    "cases_of",
    "check",
    "load_checks",
    "parametrize_contract",
    "run_cases",
]
