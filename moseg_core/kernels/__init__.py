"""The few hot loops, compiled by numba; each has a literal, slow reference in ``tests/``."""
