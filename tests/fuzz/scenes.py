"""glTF files that lie: counts and strides, nodes in circles, addresses out of the folder, bombs."""

from __future__ import annotations

import copy
import json
import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.fuzz.case import EITHER, REFUSED, SOUND, Case, Made
from tests.fuzz.seeds import box, glb, gltf, scene

Change = Callable[[dict[str, Any]], Any]

WRONG_VALUES: tuple[Any, ...] = (
    *(-1, 1, 2**31, 2**32, 2**53, 2**63, 2**64, 10**30, -(2**64), 0.5, 1e308, "0", "", None, True),
    *([], [0], {}, [[[]]]),
)
"""What may stand where a number should."""


def scene_cases() -> Iterator[Case]:
    yield from _members()
    yield from _structures()
    yield from _addresses()
    yield from _bombs()
    yield from _containers()
    yield from _documents()


def _changed(kind: str, name: str, change: Change, expected: str = EITHER,
             n: tuple[int, int] = (1, 10_000)) -> Case:  # fmt: skip
    def make() -> bytes:
        document, binary = scene(*box())
        document = copy.deepcopy(document)
        changed = change(document)
        return glb(document if changed is None else changed, binary)

    return Case(format="glb", suffix=".glb", kind=kind, name=name, make=make, expected=expected,
                elements=n)  # fmt: skip


def _put(document: Any, path: tuple[Any, ...], value: Any) -> None:
    for key in path[:-1]:
        document = document[key]
    document[path[-1]] = value


#: Members that hold a number or a list, and whether the sound file has them.
_MEMBERS: tuple[tuple[Any, ...], ...] = (
    ("accessors", 0, "count"), ("accessors", 1, "count"), ("accessors", 0, "byteOffset"),
    ("accessors", 0, "componentType"), ("accessors", 1, "componentType"), ("accessors", 0, "type"),
    ("accessors", 0, "bufferView"), ("accessors", 0, "normalized"), ("accessors", 0, "sparse"),
    ("bufferViews", 0, "byteLength"), ("bufferViews", 0, "byteOffset"),
    ("bufferViews", 0, "byteStride"), ("bufferViews", 0, "buffer"), ("bufferViews", 0,
      "extensions"),
    ("buffers", 0, "byteLength"), ("buffers", 0, "uri"), ("buffers",), ("bufferViews",),
    ("accessors",), ("meshes",), ("nodes",), ("scenes",), ("scene",), ("scenes", 0, "nodes"),
    ("nodes", 0, "mesh"), ("nodes", 0, "children"), ("nodes", 0, "skin"), ("nodes", 0, "matrix"),
    ("nodes", 0, "translation"), ("nodes", 0, "rotation"), ("nodes", 0, "scale"),
    ("nodes", 0, "extensions"), ("meshes", 0, "primitives"), ("meshes", 0, "primitives", 0, "mode"),
    ("meshes", 0, "primitives", 0, "indices"), ("meshes", 0, "primitives", 0, "attributes"),
    ("meshes", 0, "primitives", 0, "attributes", "POSITION"),
    ("meshes", 0, "primitives", 0, "attributes", "TEXCOORD_0"),
    ("meshes", 0, "primitives", 0, "material"), ("meshes", 0, "primitives", 0, "targets"),
    ("meshes", 0, "primitives", 0, "extensions"), ("asset",), ("asset", "version"),
    ("extensionsRequired",), ("extras",), ("materials",), ("skins",),
)  # fmt: skip


def _members() -> Iterator[Case]:
    """Every member with every wrong value."""
    for path in _MEMBERS:
        for value in WRONG_VALUES:
            where, shown = ".".join(map(str, path)), json.dumps(value)[:24]
            yield _changed(
                "structure",
                f"{where}: {shown}",
                lambda d, path=path, value=value: _put(d, path, value),
            )
    for path in (("accessors", 0, "count"), ("accessors", 1, "count")):
        for step in (-1, 1):
            yield _changed(
                "counts",
                f"{path[0]}[{path[1]}]: {step:+}",
                lambda d, path=path, step=step: _put(d, path, d[path[0]][path[1]]["count"] + step),
            )


def _all(*done: Any) -> None:
    """Nothing: what the arguments did is what counts."""


def _chain(depth: int, document: dict[str, Any]) -> None:
    nodes = [{"children": [k + 1]} for k in range(depth)]
    document["nodes"] = [*nodes, {"mesh": 0}]


def _diamonds(levels: int, document: dict[str, Any]) -> None:
    """Nodes each of which has the next twice: 2^levels ways to the mesh."""
    document["nodes"] = [{"children": [k + 1, k + 1]} for k in range(levels)] + [{"mesh": 0}]


def _structures() -> Iterator[Case]:
    references, numbers = "references", "numbers"
    nodes: list[tuple[str, Change, str]] = [
        ("a node that is its own child", lambda d: _put(d, ("nodes", 0, "children"), [0]), REFUSED),
        ("two nodes that are each other's child", lambda d: d.update(
            nodes=[{"children": [1], "mesh": 0}, {"children": [0]}]), REFUSED),
        ("a circle of 1,000 nodes", lambda d: d.update(
            nodes=[{"children": [(k + 1) % 1000], "mesh": 0} for k in range(1000)]), REFUSED),
        ("a circle that no root reaches", lambda d: d.update(
            nodes=[{"mesh": 0}, {"children": [2]}, {"children": [1]}]), EITHER),
        ("a root twice", lambda d: _put(d, ("scenes", 0, "nodes"), [0, 0]), EITHER),
        ("a child of two nodes", lambda d: d.update(
            nodes=[{"children": [2]}, {"children": [2]}, {"mesh": 0}],
            scenes=[{"nodes": [0, 1]}]), EITHER),
        ("30 diamonds", lambda d: _diamonds(30, d), REFUSED),
        ("nodes 900 deep", lambda d: _chain(900, d), EITHER),
        ("nodes 5,000 deep", lambda d: _chain(5000, d), EITHER),
        ("nodes 100,000 deep", lambda d: _chain(100_000, d), EITHER),
        ("a node that is not there", lambda d: _put(d, ("scenes", 0, "nodes"), [7]), REFUSED),
        ("a mesh that is not there", lambda d: _put(d, ("nodes", 0, "mesh"), 7), REFUSED),
        ("no node has a mesh", lambda d: d.update(nodes=[{}]), REFUSED),
        ("a texture that names the corners", lambda d: _put(
            d, ("meshes", 0, "primitives", 0, "attributes", "TEXCOORD_0"), 1), EITHER),
        ("corners that name the places", lambda d: _put(
            d, ("meshes", 0, "primitives", 0, "indices"), 0), REFUSED),
        ("places that name the corners", lambda d: _put(
            d, ("meshes", 0, "primitives", 0, "attributes", "POSITION"), 1), REFUSED),
        ("a scene that is not there", lambda d: d.update(scene=3), REFUSED),
    ]  # fmt: skip
    for name, change, expected in nodes:
        yield _changed(references, name, change, expected)
    for mode in (*range(8), 255):
        yield _changed("structure", f"mode {mode}", lambda d, mode=mode: _put(
            d, ("meshes", 0, "primitives", 0, "mode"), mode), EITHER, (1, 132))  # fmt: skip
    for name, value in (
        ("nan", "NaN"),
        ("inf", "Infinity"),
        ("1e999", "1e999"),
        ("1e300", "1e300"),
        ("-1e300", "-1e300"),
        ("1e-300", "1e-300"),
        ("0", "0"),
        ("1e38", "1e38"),
        ("-1", "-1"),
        ("1e20", "1e20"),
        ("1" + "0" * 400, "1" + "0" * 400),
    ):
        for member, length in (("scale", 3), ("translation", 3), ("rotation", 4), ("matrix", 16)):

            def text(
                d: dict[str, Any], member: str = member, n: int = length, value: str = value
            ) -> bytes:
                d["nodes"][0][member] = ["?"] * n
                return json.dumps(d).replace('"?"', value).encode()

            shown = name if len(name) < 20 else "a number of 400 digits"
            yield _changed(numbers, f"{member} of {shown}", text, EITHER, (44, 44))
    for name, value in (("nan", np.nan), ("inf", np.inf), ("3e38", 3e38), ("1e-45", 1e-45)):

        def places(value: float = value) -> bytes:
            document, binary = scene(*box())
            return glb(document, struct.pack("<f", value) + binary[4:])

        yield Case(
            format="glb",
            suffix=".glb",
            kind=numbers,
            name=f"a place at {name}",
            make=places,
            elements=(44, 44),
        )
    for name, word in (("escapes", "\x1b]0;owned\x07\x1b[2J"), ("marks of direction",
      "\u202egnp\u2066"),
                       ("10,000 characters", "x" * 10_000), ("lines", "a\nb\r\nc"), ("NUL", "a\0b"),
                       ("half of a pair", "\ud800"), ("markup", "[/x][red]<b>&")):  # fmt: skip
        for what, change in (
            ("a node", lambda d, w=word: _put(d, ("nodes", 0, "name"), w)),
            ("a material", lambda d, w=word: _all(
                d.update(materials=[{"name": w}]),
                _put(d, ("meshes", 0, "primitives", 0, "material"), 0))),
            ("a needed extension", lambda d, w=word: d.update(extensionsRequired=[w])),
            ("a version", lambda d, w=word: _put(d, ("asset", "version"), w)),
            ("a type", lambda d, w=word: _put(d, ("accessors", 0, "type"), w)),
            ("a buffer's address", lambda d, w=word: _put(d, ("buffers", 0, "uri"), w)),
            ("an unknown member", lambda d, w=word: d.update({w: w})),
        ):  # fmt: skip
            sound = what in ("a node", "an unknown member", "a material")
            yield _changed(
                "names",
                f"{name} as the name of {what}",
                change,
                EITHER if sound else REFUSED,
                (44, 44),
            )


def _addresses() -> Iterator[Case]:
    """Buffers at addresses that a file may not have."""
    for uri in (
        *("../box.bin", "../../../../../../etc/passwd", "/etc/passwd", "file:///etc/passwd"),
        *("http://127.0.0.1:9/box.bin", "https://localhost/box.bin", "ftp://x/y", "%2e%2e/box.bin"),
        *("..%2fbox.bin", "sub/../../box.bin", "a%00b", "C:\\box.bin", "\\\\server\\box.bin", ".."),
        *(".", "", "/", "~/box.bin", "/dev/zero", "/dev/random", "/proc/self/mem", "box.bin/"),
        *("missing.bin", "case.gltf", "x" * 5000, "%", "%zz", "data:", "data:,", "data:;base64,!!"),
        *("data:;base64,QQ", "data:text/plain,abc", "javascript:1", "//host/box.bin", "sub/"),
    ):

        def make(uri: str = uri) -> Made:
            document, binary = scene(*box())
            document["buffers"][0]["uri"] = uri
            text = json.dumps(document).encode()
            return {"": text, "sub/box.bin": binary, "inside.bin": binary}

        shown = uri if len(uri) < 40 else f"{len(uri)} characters"
        yield Case(
            format="gltf",
            suffix=".gltf",
            kind="references",
            name=f"data at '{shown}'",
            make=make,
            expected=REFUSED,
        )
    for uri in ("sub/box.bin", "./inside.bin", "sub%2Fbox.bin", "sub/../inside.bin"):

        def sound(uri: str = uri) -> Made:
            document, binary = scene(*box())
            document["buffers"][0]["uri"] = uri
            files = {"sub/box.bin": binary, "inside.bin": binary}
            return {"": json.dumps(document).encode(), **files}

        yield Case(
            format="gltf",
            suffix=".gltf",
            kind="references",
            name=f"data at '{uri}'",
            make=sound,
            expected=SOUND,
            elements=(44, 44),
        )


def _bombs() -> Iterator[Case]:
    """Small files that stand for very many triangles."""
    kind = "expansion"
    for n in (500, 20_000):
        yield _changed(
            kind,
            f"one mesh at {n} nodes in one place",
            lambda d, n=n: d.update(nodes=[{"mesh": 0}] * n, scenes=[{"nodes": list(range(n))}]),
            EITHER,
            (44 * n, 44 * n),
        )
        yield _changed(kind, f"one mesh at {n} nodes apart", lambda d, n=n: d.update(
            nodes=[{"mesh": 0, "translation": [4 * k, 0, 0]} for k in range(n)],
            scenes=[{"nodes": list(range(n))}]), EITHER, (44 * n, 44 * n))  # fmt: skip
    yield _changed(kind, "one primitive 100,000 times", lambda d: _put(
        d, ("meshes", 0, "primitives"), d["meshes"][0]["primitives"] * 100_000), EITHER,
        (4_400_000, 4_400_000))  # fmt: skip
    yield _changed(kind, "40,000 roots and no scene", lambda d: _all(
        d.update(nodes=[{"mesh": 0}] + [{}] * 40_000), d.pop("scenes"), d.pop("scene")),
        SOUND, (44, 44))  # fmt: skip
    yield _changed(kind, "40,000 children and no scene", lambda d: _all(
        d.update(nodes=[{"mesh": 0, "children": list(range(1, 40_001))}] + [{}] * 40_000),
        d.pop("scenes"), d.pop("scene")), SOUND, (44, 44))  # fmt: skip
    yield _changed(kind, "300,000 nodes without a mesh", lambda d: d.update(
        nodes=[{"mesh": 0}] + [{}] * 300_000), SOUND, (44, 44))  # fmt: skip
    yield _changed(
        kind,
        "50,000 accessors of all the bytes",
        lambda d: d.update(accessors=d["accessors"] + d["accessors"][:1] * 50_000),
        SOUND,
        (44, 44),
    )
    yield _changed(kind, "a stride of nothing", lambda d: _all(
        _put(d, ("accessors", 0, "count"), 10**9), _put(d, ("bufferViews", 0, "byteStride"), 0)
    ), REFUSED)  # fmt: skip
    yield _changed(kind, "a million corners that overlap", lambda d: _all(
        _put(d, ("accessors", 0, "count"), 10**6), _put(d, ("bufferViews", 0, "byteStride"), 1)
    ), REFUSED)  # fmt: skip


def _containers() -> Iterator[Case]:
    """The envelope of a GLB file."""
    document, binary = scene(*box())
    whole = glb(document, binary)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack("<I4s", len(data), kind) + data

    def envelope(*chunks: bytes, version: int = 2) -> bytes:
        body = b"".join(chunks)
        return struct.pack("<4sII", b"glTF", version, 12 + len(body)) + body

    known: list[tuple[str, bytes, str]] = [
        *((f"length {n:+}", whole[:8] + struct.pack("<I", len(whole) + n) + whole[12:], EITHER)
          for n in (-1, 1, -100, 100)),
        ("length 0", whole[:8] + bytes(4) + whole[12:], REFUSED),
        ("length 2^32 - 1", whole[:8] + b"\xff" * 4 + whole[12:], REFUSED),
        ("a chunk of 2^32 - 1", whole[:12] + b"\xff" * 4 + whole[16:], REFUSED),
        ("a chunk of 0", whole[:12] + bytes(4) + whole[16:], REFUSED),
        ("no chunks", envelope(), REFUSED),
        ("no binary", envelope(chunk(b"JSON", text)), REFUSED),
        ("no JSON", envelope(chunk(b"BIN\0", binary)), REFUSED),
        ("binary first", envelope(chunk(b"BIN\0", binary), chunk(b"JSON", text)), REFUSED),
        ("JSON twice", envelope(chunk(b"JSON", text), chunk(b"JSON", text)), REFUSED),
        ("binary twice", envelope(chunk(b"JSON", text), *[chunk(b"BIN\0", binary)] * 2), EITHER),
        ("an unknown chunk", envelope(chunk(b"JSON", text), chunk(b"BIN\0", binary),
                                      chunk(b"WHAT", b"1234")), EITHER),
        ("300,000 empty chunks", envelope(chunk(b"JSON", text), chunk(b"BIN\0", binary),
                                          *[chunk(b"WHAT", b"")] * 300_000), EITHER),
        ("version 1", envelope(chunk(b"JSON", text), version=1), REFUSED),
        ("version 2^32 - 1", envelope(chunk(b"JSON", text), version=2**32 - 1), REFUSED),
        ("a binary of one byte", glb(document, b"a"), REFUSED),
        ("50 bytes behind", whole + bytes(50), EITHER),
    ]  # fmt: skip
    for name, data, expected in known:
        yield Case(
            format="glb",
            suffix=".glb",
            kind="counts",
            name=name,
            make=lambda d=data: d,
            expected=expected,
            elements=(44, 44),
        )


def _documents() -> Iterator[Case]:
    """The JSON itself."""
    known: list[tuple[str, str, bytes]] = [
        *(("nesting", f"{n} lists in each other", b"[" * n + b"]" * n) for n in (500, 2000,
          100_000)),
        *(("nesting", f"{n} open lists", b"[" * n) for n in (500, 2000, 1_000_000)),
        *(("nesting", f"{n} objects in each other", b'{"a":' * n + b"1" + b"}" * n)
          for n in (500, 2000, 100_000)),
        ("structure", "no object", b"[]"), ("structure", "an empty object", b"{}"),
        ("structure", "nothing", b"   "), ("structure", "a number", b"12"),
        ("numbers", "an integer of 5,000 digits", b'{"asset":{"version":"2.0"},"scene":'
         + b"9" * 5000 + b"}"),
        ("numbers", "an integer of 3 million digits", b'{"asset":{"version":"2.0"},"scene":'
         + b"9" * 3_000_000 + b"}"),
        ("encoding", "half of a pair as a version", b'{"asset":{"version":"\\ud800"}}'),
        ("encoding", "a version that is not UTF-8", b'{"asset":{"version":"\xff\xfe"}}'),
        ("structure", "300,000 members",
          b"{" + b",".join(b'"%d":1' % k for k in range(300_000)) + b"}"),
    ]  # fmt: skip
    for kind, name, text in known:
        yield Case(
            format="glb",
            suffix=".glb",
            kind=kind,
            name=name,
            expected=REFUSED,
            make=lambda text=text: glb(text, b""),
        )
        yield Case(
            format="gltf",
            suffix=".gltf",
            kind=kind,
            name=name,
            expected=REFUSED,
            make=lambda text=text: text,
        )
    for n in (500, 2000, 50_000):

        def extras(n: int = n) -> bytes:
            document, binary = scene(*box())
            document["extras"] = "?"
            return glb(json.dumps(document).replace('"?"', "[" * n + "]" * n).encode(), binary)

        yield Case(
            format="glb",
            suffix=".glb",
            kind="nesting",
            name=f"extras {n} deep",
            make=extras,
            elements=(44, 44),
        )
    yield Case(
        format="gltf",
        suffix=".gltf",
        kind="structure",
        name="a member twice",
        make=lambda: gltf(*scene(*box())).replace(b'"scene": 0', b'"scene": 7, "scene": 0'),
        elements=(44, 44),
    )
