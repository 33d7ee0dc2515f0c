"""The bundle keeps what moseg asks of every objective, as it is installed."""

from moseg_core.testing import parametrize_contract


@parametrize_contract("printing")
def test_contract(check):
    check()
