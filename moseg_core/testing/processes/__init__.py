"""Checks in a process of their own: a component may crash or hang it."""
