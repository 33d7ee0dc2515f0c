"""A result made by hand, as the kit makes it for writers."""

from moseg_core.testing.fixtures.results import area, result_on

__all__ = ["area", "result_on"]
