"""The page of a result: one HTML file to turn a segmented shape in, which needs no network.

:mod:`~moseg_core.view.page.content` is what a page shows, whether it comes from a search or from a
file of labels; :mod:`~moseg_core.view.page.document` makes plain data of it, with the geometry
packed by :mod:`~moseg_core.view.page.packing`, a large one thinned by
:mod:`~moseg_core.view.page.thinning`, and the steps of the search from
:mod:`~moseg_core.view.page.steps`; :mod:`~moseg_core.view.page.html` puts the data into the file,
beside ``viewer.js``, ``page.css`` and ``page.html`` of this folder.
:mod:`~moseg_core.view.page.writer` offers it as a format of results.

``viewer.js`` is bundled from the sources in ``tools/viewer`` by ``tools/make_viewer.py``, with
three.js, whose licence is in ``three-license.txt``.
"""
