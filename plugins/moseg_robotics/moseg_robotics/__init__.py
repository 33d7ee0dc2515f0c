"""Results of moseg for robot simulators.

:mod:`~moseg_robotics.bodies` makes a rigid body of each part; :mod:`~moseg_robotics.urdf` and
:mod:`~moseg_robotics.mjcf` write them, each with its meshes in a folder beside it.
"""
