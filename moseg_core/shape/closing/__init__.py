"""A surface that was cut open, made a closed solid: rims, what fills them, and the whole.

:mod:`~moseg_core.shape.closing.rims` finds the loops at which a surface is open and which of them
bound one cap together, :mod:`~moseg_core.shape.closing.fill` cuts a cap into triangles, and
:mod:`~moseg_core.shape.closing.close` joins them to the surface, outside out.
"""
