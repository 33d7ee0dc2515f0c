"""Symmetry for moseg: planes and axes of a shape, mirrored centres, centres on a plane."""
