"""The container of a glTF file: a JSON document, blocks of bytes, and arrays that lie in them.

A binary glTF 2.0 file (``.glb``) is a header of 12 bytes and chunks, the first of JSON; a ``.gltf``
file is the JSON alone. The document describes arrays ("accessors") as stretches ("views") of
buffers: the binary chunk, bytes within the document, or files beside it
(:mod:`moseg_core.io.read.gltf_buffers`). This module takes the file apart and hands out those
arrays, checked against the bytes that are there; :mod:`moseg_core.io.read.glb_scene` walks the
scene and knows what they mean.

Nothing in the document is trusted: every member is fetched through a function that knows which
kind of value the format asks for and says which one is wrong.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, shown
from moseg_core.io.read.gltf_buffers import read_buffer
from moseg_core.types import FloatArray

Json: TypeAlias = Mapping[str, Any]

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

# Required extensions that say nothing about which triangles there are or where.
_HARMLESS = (
    "EXT_lights_", "EXT_mesh_features", "EXT_structural_metadata", "EXT_texture_",
    "KHR_animation_pointer", "KHR_lights_", "KHR_materials_", "KHR_mesh_quantization",
    "KHR_texture_", "KHR_xmp", "VRM",
)  # fmt: skip
_LARGEST_STRIDE = 252  # by the format; more is let pass where there are data for it
_COMPRESSED = (
    "open it in a program that reads it, such as Blender, and export it without compression"
)


@dataclass(frozen=True, eq=False)
class GlbFile:
    """A glTF file taken apart; build one with :meth:`parse`.

    Parameters
    ----------
    path : Path
        For messages.
    document : mapping
        The JSON chunk.
    binary : bytes
        The binary chunk; empty where there is none.
    notes : tuple of str
        What was passed over.
    length : int
        Bytes of the file itself.
    """

    path: Path
    document: Json
    binary: bytes
    notes: tuple[str, ...] = ()
    length: int = 0
    _buffers: dict[int, bytes] = field(default_factory=dict, repr=False)
    _files: dict[Path, bytes] = field(default_factory=dict, repr=False)

    @classmethod
    def parse(cls, path: Path, data: bytes) -> GlbFile:
        """Take the bytes of a file apart.

        Raises
        ------
        ShapeError
            They are not a whole glTF file of version 2, or one that needs an extension which
            moseg does not know.
        """
        if data[:4] != b"glTF":
            if data.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] != b"{":
                raise file_error(
                    path, "is not a GLB file (no 'glTF' at the beginning); export it as binary glTF"
                )
            return cls._checked(cls(path, _document(path, data), b"", length=len(data)))
        if len(data) < 20:
            raise file_error(path, "ends within its header; it is cut off, export it again")
        version, length = _uint32(data, 4), _uint32(data, 8)
        if version != 2:
            raise file_error(path, f"has glTF version {version}; export it as version 2")
        if not 20 <= length <= len(data):
            raise file_error(
                path,
                f"announces {length} bytes, but there are {len(data)};"
                " it is cut off or damaged, export it again",
            )
        notes: tuple[str, ...] = ()
        if length < len(data):
            notes = (f"bytes behind the end of the file: {len(data) - length}; passed over",)
        chunks: list[tuple[bytes, bytes]] = []
        at, filled = 12, len(data[:length].rstrip(b"\0 \r\n"))
        while at < length:
            if length - at < 8 or at >= filled:
                notes = (*notes, f"bytes behind the last chunk: {length - at}; passed over")
                break
            end = at + 8 + _uint32(data, at)
            if end > length:
                raise file_error(
                    path, "has a chunk that runs past its end; it is damaged, export it again"
                )
            chunks.append((data[at + 4 : at + 8], data[at + 8 : end]))
            at = end
        if not chunks or chunks[0][0] != b"JSON":
            raise file_error(path, "does not begin with a JSON chunk; it is damaged")
        binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else b""
        return cls._checked(cls(path, _document(path, chunks[0][1]), binary, notes, len(data)))

    @property
    def size(self) -> int:
        """Bytes of the file and of all others that were read so far."""
        return self.length + sum(map(len, self._files.values()))

    @classmethod
    def _checked(cls, parsed: GlbFile) -> GlbFile:
        """The file, unless it says itself that moseg cannot read it."""
        version = parsed.mapping(parsed.document, "asset").get("version", "2.0")
        if not str(version).startswith("2"):
            raise file_error(
                parsed.path, f"has glTF version {shown(str(version))}; export it as version 2"
            )
        for extension in map(str, parsed.members(parsed.document, "extensionsRequired")):
            if not extension.startswith(_HARMLESS):
                raise parsed.unreadable(extension)
        return parsed

    def unreadable(self, extension: str) -> ShapeError:
        """The error that the file needs an extension that moseg does not know."""
        compressed = "draco" in extension or "meshopt" in extension
        what = "is compressed with" if compressed else "needs the extension"
        remedy = _COMPRESSED if compressed else "export it without"
        return file_error(self.path, f"{what} {shown(extension)}; {remedy}")

    def damaged(self, what: str) -> ShapeError:
        """The error that the document is not glTF, with what is wrong in it."""
        return file_error(self.path, f"is damaged: {what}; export it again")

    def integer(self, owner: Json, key: str, default: int | None = None) -> int:
        """A member that is an integer from 0."""
        value = owner.get(key, default)
        if type(value) is not int or value < 0:
            raise self.damaged(f"'{key}' must be an integer from 0, not {json.dumps(value)[:40]}")
        return value

    def members(self, owner: Json, key: str) -> list[Any]:
        """A member that is a list; empty where there is none."""
        value = owner.get(key, [])
        if not isinstance(value, list):
            raise self.damaged(f"'{key}' must be a list")
        return value

    def mapping(self, owner: Json, key: str) -> Json:
        """A member that is an object; empty where there is none."""
        value = owner.get(key, {})
        if not isinstance(value, dict):
            raise self.damaged(f"'{key}' must be an object")
        return value

    def numbers(self, owner: Json, key: str, default: list[float]) -> FloatArray:
        """A member that is a list of as many finite numbers as the default has."""
        value = self.members(owner, key) if key in owner else default
        good = len(value) == len(default) and all(
            isinstance(x, (int, float)) and not isinstance(x, bool) and abs(x) < 1e300
            for x in value
        )
        if not good:
            raise self.damaged(f"'{key}' must be {len(default)} finite numbers")
        return np.array(value, np.float64)

    def item(self, kind: str, index: object) -> Json:
        """The object at a place in one of the document's lists, such as "nodes"."""
        items = self.members(self.document, kind)
        if type(index) is not int or not 0 <= index < len(items):
            raise self.damaged(f"{json.dumps(index)[:40]} names none of the {len(items)} {kind}")
        found = items[index]
        if not isinstance(found, dict):
            raise self.damaged(f"{kind}[{index}] must be an object")
        return found

    def array(self, index: object) -> npt.NDArray[Any]:
        """The numbers of an accessor.

        Parameters
        ----------
        index : object
            As the document gives it; checked.

        Returns
        -------
        (count, width) array
            Of the file's type; normalized integers are float, in [-1, 1] or [0, 1].

        Raises
        ------
        ShapeError
            The accessor is malformed, reaches past the data, or lies outside of the file.
        """
        values, normalized = self._stretch(index)
        if normalized:
            return np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1.0)
        return values

    def _stretch(self, index: object) -> tuple[npt.NDArray[Any], bool]:
        """The numbers of an accessor where they lie; whether they stand for shares of the most."""
        accessor = self.item("accessors", index)
        name = f"accessors[{index}]"
        if "sparse" in accessor:
            raise file_error(
                self.path,
                f"has a sparse accessor ({name}); open it in a program that reads it, such as"
                f" Blender, and export it again",
            )
        if "bufferView" not in accessor:
            raise self.damaged(f"{name} has no data")
        component = self.integer(accessor, "componentType")
        width = _WIDTHS.get(str(accessor.get("type")))
        if component not in _COMPONENTS or width is None:
            raise self.damaged(f"{name} has an unknown type")
        count, offset = self.integer(accessor, "count"), self.integer(accessor, "byteOffset", 0)
        view, stride = self._view(accessor["bufferView"])
        dtype = np.dtype(_COMPONENTS[component])
        packed = dtype.itemsize * width
        if stride > max(len(view), _LARGEST_STRIDE):
            raise self.damaged(f"{name} has items {stride:.6g} bytes apart")
        stride = stride or packed
        last = offset + stride * (count - 1) + packed if count else offset
        if stride < packed or last > len(view):
            raise self.damaged(f"{name} reaches past the end of its data")
        values = np.ndarray(
            (count, width), dtype, buffer=view, offset=offset, strides=(stride, dtype.itemsize)
        ) if count else np.empty((0, width), dtype)  # fmt: skip
        return values, accessor.get("normalized") is True and dtype.kind in "iu"

    def count(self, index: object) -> int:
        """How many items an accessor has; see :meth:`array`."""
        return len(self._stretch(index)[0])

    def _view(self, index: object) -> tuple[memoryview, int]:
        """The bytes of a buffer view, and its stride (0 where its items are packed)."""
        view = self.item("bufferViews", index)
        for extension in self.mapping(view, "extensions"):
            if extension.endswith("meshopt_compression"):
                raise self.unreadable(extension)
        number = self.integer(view, "buffer")
        held = self._buffer(number)
        start = self.integer(view, "byteOffset", 0)
        end = start + self.integer(view, "byteLength")
        if end > len(held):
            raise self.damaged(f"bufferViews[{index}] reaches past the end of the data")
        return memoryview(held)[start:end], self.integer(view, "byteStride", 0)

    def _buffer(self, number: int) -> bytes:
        """The bytes of a buffer, as many as the document says at most."""
        if number not in self._buffers:
            buffer = self.item("buffers", number)
            length = self.integer(buffer, "byteLength")
            if "uri" in buffer:
                data = read_buffer(self.path, buffer["uri"], length, self._files)
            elif number == 0:
                data = self.binary[:length]
            else:
                raise self.damaged(f"buffers[{number}] is nowhere")
            self._buffers[number] = data
        return self._buffers[number]


def _document(path: Path, text: bytes) -> Json:
    """The JSON of a file."""
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise file_error(path, f"has damaged JSON ({error}); export it again") from error
    if not isinstance(document, dict):
        raise file_error(path, "has JSON that is no object; it is damaged, export it again")
    return document


def _uint32(data: bytes, at: int) -> int:
    return int.from_bytes(data[at : at + 4], "little")
