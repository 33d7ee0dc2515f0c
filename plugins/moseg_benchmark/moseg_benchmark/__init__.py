"""Benchmarks: how well results agree with people, over whole collections of shapes.

:mod:`~moseg_benchmark.psb` finds the models of a collection, :mod:`~moseg_benchmark.label_matching`
puts the names that people gave to parts and the labels of a recipe beside each other,
:mod:`~moseg_benchmark.cases` measures one case, :mod:`~moseg_benchmark.records` keeps what it came
to on disk, :mod:`~moseg_benchmark.run` does many, :mod:`~moseg_benchmark.tables` sums them up and
:mod:`~moseg_benchmark.page` shows them. :mod:`~moseg_benchmark.command` is ``moseg benchmark``.
"""
