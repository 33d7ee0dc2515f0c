"""What is in a 3MF file, read as XML."""

from __future__ import annotations

import io
import zipfile
from xml.etree import ElementTree

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def model_of(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        for name in archive.namelist():
            ElementTree.fromstring(archive.read(name))
        return ElementTree.fromstring(archive.read("3D/3dmodel.model"))


def objects_of(data):
    """Of each object that has a mesh its name, color, places and triangles."""
    model = model_of(data)
    bases = [base.attrib for base in model.iter(f"{CORE}base")]
    found = []
    for each in model.iter(f"{CORE}object"):
        if each.find(f"{CORE}mesh") is None:
            continue
        assert each.get("type") == "model"
        base = bases[int(each.get("pindex"))]
        assert base["name"] == each.get("name")
        places = [[float(v.get(k)) for k in "xyz"] for v in each.iter(f"{CORE}vertex")]
        triangles = [
            [int(t.get(k)) for k in ("v1", "v2", "v3")] for t in each.iter(f"{CORE}triangle")
        ]
        found.append((each.get("name"), base["displaycolor"], places, triangles))
    return found
