"""Parts that a 3-D printer can make, for moseg."""
