"""Checks of labelers; see :mod:`moseg_core.testing.check`."""
