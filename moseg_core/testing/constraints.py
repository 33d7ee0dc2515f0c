"""Checks of constraints; see :mod:`moseg_core.testing.check`."""
