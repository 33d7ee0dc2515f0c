"""Checks of objectives; see :mod:`moseg_core.testing.check`."""
