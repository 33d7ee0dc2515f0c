"""Benchmarks: how well results agree with people, over whole collections of shapes.

:mod:`~moseg_core.bench.psb` finds the models of a collection, :mod:`~moseg_core.bench.names` puts
the names that people gave to parts and the labels of a recipe beside each other,
:mod:`~moseg_core.bench.cases` does what is to be measured, :mod:`~moseg_core.bench.tables` sums it
up and :mod:`~moseg_core.bench.page` shows it.
"""
