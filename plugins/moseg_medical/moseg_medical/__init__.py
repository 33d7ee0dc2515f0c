"""Medical masks for moseg: NIfTI and NRRD in, label maps out.

:mod:`~moseg_medical.nifti` and :mod:`~moseg_medical.nrrd_files` read a mask as a solid voxel grid
in millimetres, with x to the right, y to the front and z up of the patient, and write the parts of
a result as a label map of the same grid. :mod:`~moseg_medical.masks` holds what both share;
:mod:`~moseg_medical.label_names` says what labels are called and coloured, in the ways of ITK-SNAP
and 3D Slicer; :mod:`~moseg_medical.examples` makes small files for checks.
"""
