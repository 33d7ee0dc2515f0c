"""The page of a batch: a picture of each shape, those that are unlike the others first.

Each result is drawn and measured (:mod:`~moseg_core.batching.report.describing`) by a guarded
child, as it was made by one. How unlike the others a shape is
(:mod:`~moseg_core.batching.report.outliers`) follows from the measures of all, and the page
(:mod:`~moseg_core.batching.report.page`) shows it.
"""
