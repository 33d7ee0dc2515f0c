"""The bundle ``symmetry``: names, targets and nothing heavy."""
