"""The method: from a shape and a problem to a result (Sec. 4 to 8).

:mod:`~moseg_core.search.segment` is the whole in one call. It makes one
:mod:`~moseg_core.search.evaluator` for each resolution and hands them to
:mod:`~moseg_core.search.restarts`, which begins several runs
(:mod:`~moseg_core.search.beginning`: seeds and labels), goes on with the best
(:mod:`~moseg_core.search.run`: ask and tell) and polishes what they found on the input's own
elements. :mod:`~moseg_core.search.levels` does the same part by part.
"""
