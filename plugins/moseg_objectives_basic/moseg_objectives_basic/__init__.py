"""moseg's basic objectives: what the paper defines in Section 10 or names in Section 3."""
