"""The bundle ``mds``: names, targets and nothing heavy."""
