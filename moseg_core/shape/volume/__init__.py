"""The volume V of Sec. 10: exact where a mesh encloses one, estimated when the user asks.

:mod:`~moseg_core.shape.volume.volume` is the value with its source, ``enclosed`` the exact one,
``estimated`` what the user asks for (by ``hulls``, or by ``winding`` with ``winding_tree``),
``derived`` that of parts and embeddings (with ``capped`` for what was cut open).
"""
