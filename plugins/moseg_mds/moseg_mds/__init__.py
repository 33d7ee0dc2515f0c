"""Shapes under articulation for moseg: geodesic distances and their 3-D embedding."""
