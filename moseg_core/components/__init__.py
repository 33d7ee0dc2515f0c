"""The small core: what a component is, what it sees, and how it is found (Sec. 3).

:mod:`~moseg_core.components.protocols` has one protocol for each kind of component. Objectives are
functions of what :mod:`~moseg_core.components.part` and
:mod:`~moseg_core.components.segmentation` show them, made from plain functions by
:mod:`~moseg_core.components.objectives`, and constraints by
:mod:`~moseg_core.components.constraint_function`; their parameters are declared in their signatures
(:mod:`~moseg_core.components.parameters`), their values remembered by
:mod:`~moseg_core.components.memo` and compared as a :mod:`~moseg_core.components.cost`.
:mod:`moseg_core.components.discovery` finds what is installed,
:mod:`~moseg_core.components.chosen` is one of them that somebody named, and
:mod:`~moseg_core.components.explanation` is what it says of itself.
"""
