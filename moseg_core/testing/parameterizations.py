"""Checks of parameterizations; see :mod:`moseg_core.testing.check`."""
