"""A fixed zoo of shapes on which components are tried."""
