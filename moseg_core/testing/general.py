"""Checks of general; see :mod:`moseg_core.testing.check`."""
