"""Which plane a constraint is about, from the text that the user gave.

A plane of the file is read (:mod:`moseg_symmetry.planes`); ``auto`` is found on the shape
(:mod:`moseg_symmetry.plane_detection`), once for each shape. A coarse shape asks for the plane of
the input shape that it stands for, so that both levels of a search use the same one.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

from moseg_core import Shape
from moseg_symmetry.planes import Plane, read_plane, refuse_in

_found: WeakKeyDictionary[Shape, Plane] = WeakKeyDictionary()


def plane_of(shape: Shape, text: str) -> Plane:
    """The plane that `text` means on a shape, in the shape's unit coordinates.

    Parameters
    ----------
    shape : Shape
    text : str
        ``auto``, ``x``, ``y``, ``z`` or ``px,py,pz,nx,ny,nz`` in model units.

    Returns
    -------
    Plane
        In unit coordinates.

    Raises
    ------
    UsageError
        A text of another form; says what is allowed.
    ShapeError
        ``auto`` on a shape that has no plane of symmetry; a plane of the file in an embedded
        space.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> print(plane_of(horse, "y"))
    0,0,0,0,1,0
    """
    source, frame = shape.input, shape.frame
    if text.strip() == "auto":
        plane = _found.get(source)
        if plane is None:
            from moseg_symmetry.plane_detection import require_plane

            plane = _found[source] = require_plane(source).plane
    else:
        plane = read_plane(text, center=source.frame.center)
        refuse_in(shape.space, text)
    return plane.to_unit(frame.center, frame.scale)
