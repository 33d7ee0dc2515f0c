"""Checks of optimizers; see :mod:`moseg_core.testing.check`."""
