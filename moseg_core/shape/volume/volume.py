"""The volume V of a shape (Sec. 10), with where it came from.

``convex_parts`` compares the hulls of the parts with V, whatever its origin. What is made out of a
shape, a part or an embedding, asks more: a volume that was computed from the surface itself vouches
that the faces are oriented alike, an estimate does not. So a volume carries its source:

- ``exact``: the surface, or the cells of a grid, enclose it; the cuts of a part are capped;
- ``hull``, ``winding``: estimated in this way because the user asked for it;
- ``user``: a number that the user knows.

:mod:`moseg_core.shape.volume.enclosed` and :mod:`moseg_core.shape.volume.estimated` make volumes of
shapes as they were given, :mod:`moseg_core.shape.volume.derived` those of parts and of deformed
shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Source: TypeAlias = Literal["exact", "user", "hull", "winding"]


@dataclass(frozen=True, kw_only=True)
class Volume:
    """A volume and its source, or the reason why there is none.

    Parameters
    ----------
    value : float or None, model units cubed
        Positive.
    source : {"exact", "user", "hull", "winding"} or None
        None where there is no volume.
    reason : str
        Why there is no volume, as a clause such as "it has 12 boundary edges"; empty where there
        is one.
    remedy : str
        What helps, where only some of what is usually tried does: "take --volume winding, which
        turns faces alike"; else empty.
    note : str
        What the user should know of how the volume was found; else empty.

    Examples
    --------
    >>> Volume.exact(8.0).source, Volume.none("it is flat").value
    ('exact', None)
    """

    value: float | None
    source: Source | None
    reason: str = ""
    remedy: str = ""
    note: str = ""

    @classmethod
    def exact(cls, value: float, note: str = "") -> Volume:
        """A volume that the elements enclose by themselves."""
        return cls(value=value, source="exact", note=note)

    @classmethod
    def none(cls, reason: str, remedy: str = "") -> Volume:
        """No volume, for a reason."""
        return cls(value=None, source=None, reason=reason, remedy=remedy)
