"""Recipes of everyday shapes, learned from labelled models: ``fourleg``, ``chair`` and others.

They are TOML files in :mod:`~moseg_recipes_shapes.recipes`, made by the learner ``profiles`` of
moseg-learn and never by hand; :mod:`~moseg_recipes_shapes.plugin` says what each is of.
"""
