"""Checks of embeddings; see :mod:`moseg_core.testing.check`."""
