"""Checks of seeders; see :mod:`moseg_core.testing.check`."""
