"""Writers: a result to the bytes of a file, one module a format."""
