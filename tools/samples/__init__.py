"""Development-only pieces of ``tools/make_samples.py``, which makes the sample shapes.

``fields`` holds the signed distances that shapes are built from; ``bulldog``, ``dove``, ``hammer``,
``horse`` and ``octopus`` are the shapes; and ``remesh`` turns a zero level set into an even
triangle mesh. Nothing here is imported by moseg itself.
"""
