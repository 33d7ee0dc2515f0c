"""What each kind of component promises, a module of checks for each.

All kinds: :mod:`~moseg_core.testing.checks.general` (found, loaded, documented),
:mod:`~moseg_core.testing.checks.declarations` (parameters) and
:mod:`~moseg_core.testing.checks.repeats` (the same again, nothing on the side). Objectives:
:mod:`~moseg_core.testing.checks.objectives`, :mod:`~moseg_core.testing.checks.vectorized` and
:mod:`~moseg_core.testing.checks.invariances`. The others by their names: ``fields``,
``parameterizations``, ``seeders``, ``labelers``, ``optimizers``, ``refiners``, ``constraints``,
``embeddings``, ``learners``.
"""
