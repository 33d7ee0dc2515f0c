"""A recipe tuned by hand: weights and centres moved while the result is looked at.

:mod:`~moseg_core.tune.session` knows what is tuned and searches on; :mod:`~moseg_core.tune.server`
serves it to a browser on the same machine, as the page of the result
(:mod:`moseg_core.view.page`) with sliders beside it.
"""
