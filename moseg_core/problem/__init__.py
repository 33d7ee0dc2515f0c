"""What is asked for: labels, an expression, constraints, and what each of them means (Sec. 3, 8).

:mod:`~moseg_core.problem.statement` is the request as plain data, read from a recipe
(:mod:`~moseg_core.problem.recipe`), a result or the command line, with the search options of
:mod:`~moseg_core.problem.settings`; :mod:`~moseg_core.problem.full_names` keeps the meaning of
names that have become ambiguous since it was written. :mod:`~moseg_core.problem.problem` is the
same with every name looked up. :mod:`~moseg_core.problem.binding` and
:mod:`~moseg_core.problem.aggregate` give an expression meaning and value,
:mod:`~moseg_core.problem.constraint_calls` and :mod:`~moseg_core.problem.constraints` what centres
must obey, :mod:`~moseg_core.problem.hierarchy` parts that are segmented in their turn.
:mod:`~moseg_core.problem.slow_calls` names objectives that take long.
"""
