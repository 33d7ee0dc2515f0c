"""Readers: bytes of a file to a geometry, one module a format."""
