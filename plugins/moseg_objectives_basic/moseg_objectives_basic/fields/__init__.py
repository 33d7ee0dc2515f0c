"""What every element of a surface is like, computed once per shape (``part.field("basic:...")``).

:mod:`~moseg_objectives_basic.fields.thickness`: how far it is to the other side.
:mod:`~moseg_objectives_basic.fields.remoteness`: how far from the middle, along the surface.
:mod:`~moseg_objectives_basic.fields.concavity`: how sharply the surface turns in, and how little a
boundary is expected there.
:mod:`~moseg_objectives_basic.fields.height`: how high up.

Large shapes are looked at in some thousand places (:mod:`~moseg_objectives_basic.fields.places`).
"""
