"""Labels from files, in every form that programs write them in, and to the simplest of them.

:func:`~moseg_core.io.labels.reading.read_labels` is the one reader of labels; all commands use it.
A file says less than a labelling is. It gives labels to things, and mostly not what the things are:
a *listing* (:mod:`~moseg_core.io.labels.listing`) is what each form is read as, in a module of its
own:

=========================================  ==================================================
module                                     forms
=========================================  ==================================================
:mod:`~moseg_core.io.labels.columns`       text: a label a line, tables, points with labels
:mod:`~moseg_core.io.labels.named_lines`   text: a name, a line of face ids, and so on
:mod:`~moseg_core.io.labels.json_forms`    lists and maps, results of moseg, ScanNet's segments
:mod:`~moseg_core.io.labels.arrays`        ``.npy`` and ``.npz``
:mod:`~moseg_core.io.labels.ply`           properties of faces and of vertices
:mod:`~moseg_core.io.labels.obj`           groups, objects, materials
:mod:`~moseg_core.io.labels.stl`           solids, attributes
:mod:`~moseg_core.io.labels.glb`           nodes, meshes, materials
=========================================  ==================================================

:mod:`~moseg_core.io.labels.fitting` then lays the listing onto the elements of a shape: one to one,
from vertices to faces, or by where faces lie. Which of several properties are labels is known by
their names (:mod:`~moseg_core.io.labels.properties`). :mod:`~moseg_core.io.labels.writing` goes the
other way.

In memory a label is a number from 0, and -1 (:data:`moseg_core.types.UNLABELLED`) where there is
none.
"""

from moseg_core.io.labels.labelling import Labelling
from moseg_core.io.labels.reading import read_labels
from moseg_core.io.labels.writing import encode_named_labels, encode_seg, save_labels

__all__ = ["Labelling", "encode_named_labels", "encode_seg", "read_labels", "save_labels"]
