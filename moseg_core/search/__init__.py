"""The method: from a shape and a problem to a result (Sec. 4 to 9).

:mod:`~moseg_core.search.segment` is the whole in one call. It has what is asked for checked
(:mod:`~moseg_core.search.request`), makes one :mod:`~moseg_core.search.evaluator` for each
resolution and hands them to :mod:`~moseg_core.search.restarts`, which begins several runs
(:mod:`~moseg_core.search.beginning`: seeds and labels), goes on with the best
(:mod:`~moseg_core.search.run`: ask and tell) and polishes what they found on the input's own
elements; then :mod:`~moseg_core.search.last_steps` moves the boundaries.
:mod:`~moseg_core.search.levels` does the same part by part, and
:mod:`~moseg_core.search.variants` for labels of which some may be missing.

Around these: the assignment of labels (:mod:`~moseg_core.search.assignment`), strangers'
parameterizations held to what they promise (:mod:`~moseg_core.search.checked_partition`), processes
(:mod:`~moseg_core.search.workers`) and what is left of them where one fails
(:mod:`~moseg_core.search.best_so_far`), the result (:mod:`~moseg_core.search.result`), and the same
with smooth boundaries (:mod:`~moseg_core.search.clipped_result`).
"""
