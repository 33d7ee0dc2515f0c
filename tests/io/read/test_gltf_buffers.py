"""Buffers within the text of a glTF file and in files beside it; and what is not followed."""

from __future__ import annotations

import base64
import json
import os

import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.read.glb_scene import read_glb
from moseg_core.io.read.gltf_buffers import read_buffer
from tests.io.read.glb_files import TETRAHEDRON, glb


def written(folder, uri, binary=None):
    """A .gltf file of the tetrahedron whose buffer is at an address."""
    document, data = glb([[TETRAHEDRON]], [{"mesh": 0}])
    uri = uri(data) if callable(uri) else uri
    document["buffers"] = [{"byteLength": len(data), "uri": uri}]
    path = folder / "tetra.gltf"
    path.write_text(json.dumps(document))
    return path, data if binary is None else binary


@pytest.mark.parametrize(
    ("uri", "name"),
    [
        ("a.bin", "a.bin"),
        ("my%20data%231.bin", "my data#1.bin"),
        ("./parts/a.bin", "parts/a.bin"),
        ("parts/../a.bin", "a.bin"),
        ("%C3%A4.bin", "ä.bin"),
    ],
)
def test_a_file_beside_it(uri, name, tmp_path):
    path, data = written(tmp_path, uri)
    (tmp_path / "parts").mkdir()
    (tmp_path / name).write_bytes(data + b"\0\0")
    assert read_glb(path).n_elements == 4


@pytest.mark.parametrize(
    "uri",
    [
        lambda data: "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
        lambda data: "data:;base64," + base64.b64encode(data).decode().rstrip("="),
        lambda data: "data:application/gltf-buffer," + "".join(f"%{byte:02x}" for byte in data),
    ],
)
def test_bytes_within_the_text(uri, tmp_path):
    assert read_glb(written(tmp_path, uri)[0]).n_elements == 4


@pytest.mark.parametrize(
    ("uri", "says"),
    [
        ("../secret.bin", "out of its folder"),
        ("%2e%2e/secret.bin", "out of its folder"),
        ("..\\secret.bin", "out of its folder"),
        ("/etc/hostname", "out of its folder"),
        ("file:///etc/hostname", "out of its folder"),
        ("https://example.org/a.bin", "out of its folder"),
        ("a\0.bin", "out of its folder"),
        ("link.bin", "out of its folder"),
        ("round.bin", "t"),
        ("gone.bin", "'gone.bin', which is not there"),
        (".", "which is not there"),
        ("fifo", "which is not there"),
        ("short.bin", "in 'short.bin', where there are 3; it is cut off"),
        ("data:;base64,AAAA", "in its text, where there are 3; it is cut off"),
        ("data:;base64,%%%", "has damaged base64 data"),
        ("data:nothing", "a data URI without a comma"),
        (7, "the uri of a buffer must be text"),
    ],
)
def test_addresses_that_are_not_followed(uri, says, tmp_path):
    folder = tmp_path / "model"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(bytes(1000))
    (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
    (folder / "round.bin").symlink_to(folder / "round.bin")
    (folder / "short.bin").write_bytes(b"abc")
    os.mkfifo(folder / "fifo")
    with pytest.raises(ShapeError, match=r"^tetra\.gltf") as caught:
        read_glb(written(folder, uri)[0])
    assert says in str(caught.value)


def test_a_link_within_the_folder_is_followed(tmp_path):
    (tmp_path / "real.bin").write_bytes(b"abcd")
    (tmp_path / "link.bin").symlink_to("real.bin")
    assert read_buffer(tmp_path / "x.gltf", "link.bin", 3) == b"abc"
