"""Recipes learned from labelled examples."""
