"""Recipes learned from labelled examples: two or three shapes in, a text that can be read out.

:mod:`~moseg_learn.learner` puts the recipe together. An example is cut into parts, each of a kind
(:mod:`~moseg_learn.pieces`, :mod:`~moseg_learn.names`); of these come what parts of a kind measure
(:mod:`~moseg_learn.profile`), which touch (:mod:`~moseg_learn.relations`), how many there are
(:mod:`~moseg_learn.label_sets`), and how likely each place is to bear a label
(:mod:`~moseg_learn.discriminant`, over what :mod:`~moseg_learn.looks` and
:mod:`~moseg_learn.surroundings` see), which the objective :mod:`~moseg_learn.likely` asks for.
:mod:`~moseg_learn.command` is ``moseg learn``: it reads examples (:mod:`~moseg_learn.reading`),
writes the recipe with comments (:mod:`~moseg_learn.text`), and leaves each example out in turn
(:mod:`~moseg_learn.left_out`).
"""
