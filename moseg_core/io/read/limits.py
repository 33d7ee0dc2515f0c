"""How much a file may become in memory: limits in proportion to the file, each with a name.

A few bytes can say a lot: one mesh placed at thousands of nodes of a scene, a run of empty cells, a
packed grid. Most files that do are damaged or meant to do harm, some are sound. So what a byte may
stand for is limited, and the limits are the user's to raise: ``--limit triangles_per_byte=20``,
``--limit none``, or :class:`ReadLimits` in :func:`moseg_core.io.files.load`. A file of moderate
contents is read however short it is.

A reader is given the limits where it takes ``limits`` by keyword. It should ask
(:meth:`ReadLimits.refuse_triangles`, :meth:`ReadLimits.refuse_cells`) before it makes what the file
announces, not after.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from pathlib import Path

from moseg_core.errors import ShapeError, UsageError, unknown

FEW_TRIANGLES, FEW_CELLS = 10_000, 1_000_000
"""As many are always read, however short the file is."""


@dataclass(frozen=True, kw_only=True)
class ReadLimits:
    """How much a file may become; each limit is a number, infinite for none.

    Parameters
    ----------
    triangles_per_byte : float
        Triangles, and vertices, of a scene for each byte of its files; 10,000 at least. A mesh
        that is placed once has about a tenth of one.
    cells_per_byte : float
        Occupied cells of a voxel grid for each byte of the file; a million at least.
    cells : float
        Occupied cells of a voxel grid: elements of its solid.
    grid_cells : float
        Cells of a voxel grid, empty ones as well.
    columns : float
        Numbers in a row of a point cloud.
    unpacked_bytes : float
        Bytes that a packed file of values, such as a mask in ``.nii.gz``, may unpack to.

    Examples
    --------
    >>> ReadLimits().triangles_per_byte
    0.5
    """

    triangles_per_byte: float = 0.5
    cells_per_byte: float = 100.0
    cells: float = 10_000_000.0
    grid_cells: float = 2.0**28
    columns: float = 1000.0
    unpacked_bytes: float = 2.0**29

    @classmethod
    def read(cls, texts: Iterable[str]) -> ReadLimits:
        """The limits of ``--limit``: ``name=number``, ``name=none``, or ``none`` for all of them.

        Raises
        ------
        UsageError
            An unknown name, or no number above 0.

        Examples
        --------
        >>> ReadLimits.read(["cells=2e7", "columns=none"]).cells
        20000000.0
        """
        found = cls()
        names = [each.name for each in fields(cls)]
        for text in texts:
            name, equals, value = (word.strip() for word in text.partition("="))
            if not equals and name == "none":
                found = cls(**dict.fromkeys(names, math.inf))
                continue
            if name not in names:
                raise UsageError(unknown("limit", name[:80], names))
            try:
                number = math.inf if value == "none" else float(value)
            except ValueError:
                number = math.nan
            if not number > 0:
                raise UsageError(
                    f"a limit is a number above 0 or 'none', such as"
                    f" {name}={getattr(cls(), name):.10g}, not '{text[:80]}'"
                )
            found = replace(found, **{name: number})
        return found

    def refuse_triangles(self, path: Path, count: int, size: int) -> None:
        """Refuse more triangles than the files of a shape may stand for.

        Parameters
        ----------
        path : Path
            For the message.
        count : int
            Triangles, or vertices, that there are so far.
        size : int
            Bytes of all files that the shape is read from.

        Raises
        ------
        ShapeError
            Names the limit and the option that raises it.
        """
        if count > max(FEW_TRIANGLES, self.triangles_per_byte * size):
            raise ShapeError(
                f"{path.name} shows its meshes so often that {size} bytes become {count:,}"
                f" triangles and more; {_raise('triangles_per_byte', self.triangles_per_byte)}"
            )

    def refuse_cells(self, path: Path, *, occupied: int, grid: int, size: int) -> None:
        """Refuse a grid of too many cells, or with too many occupied ones.

        Parameters
        ----------
        path : Path
            For the message.
        occupied, grid : int
            Cells that are not empty, and all of them; 0 where it is not known yet.
        size : int
            Bytes of the file.

        Raises
        ------
        ShapeError
            Names the limit and the option that raises it.
        """
        if grid > self.grid_cells:
            raise ShapeError(
                f"{path.name} holds a grid of {grid:,} cells;"
                f" {_raise('grid_cells', self.grid_cells)}"
            )
        if occupied > self.cells:
            raise ShapeError(
                f"{path.name} holds {occupied:,} occupied cells; resample the grid, or"
                f" {_raise('cells', self.cells)}"
            )
        if occupied > max(FEW_CELLS, self.cells_per_byte * size):
            raise ShapeError(
                f"{path.name} stands for {occupied:,} occupied cells in {size} bytes;"
                f" {_raise('cells_per_byte', self.cells_per_byte)}"
            )

    def refuse_columns(self, path: Path, count: int) -> None:
        """Refuse rows of more numbers than points have.

        Raises
        ------
        ShapeError
            Names the limit and the option that raises it.
        """
        if count > self.columns:
            raise ShapeError(
                f"{path.name} holds rows of {count:,} cells, too many for points;"
                f" {_raise('columns', self.columns)}"
            )

    def refuse_unpacked(self, path: Path, count: int, *, size: int) -> None:
        """Refuse a packed file that stands for too many bytes, before it is unpacked.

        Parameters
        ----------
        path : Path
            For the message.
        count : int
            Bytes that there would be.
        size : int
            Bytes of the file.

        Raises
        ------
        ShapeError
            Names the limit and the option that raises it.
        """
        if count > self.unpacked_bytes:
            raise ShapeError(
                f"{path.name} is to unpack from {size:,} bytes to {count:,};"
                f" {_raise('unpacked_bytes', self.unpacked_bytes)}"
            )


def _raise(name: str, limit: float) -> str:
    return f"the limit is {name}={limit:.10g}, --limit {name}=... raises it, =none lifts it"


LIMITS = ReadLimits()
"""Those that hold unless the user says otherwise."""
