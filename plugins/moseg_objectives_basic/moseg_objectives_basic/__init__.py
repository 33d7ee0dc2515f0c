"""moseg's basic objectives: what Section 10 of the paper defines, one formula a function."""
