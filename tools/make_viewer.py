"""Bundle the page's script from ``tools/viewer``: ``python tools/make_viewer.py``.

Needs npm, which installs three.js and esbuild in the versions that ``tools/viewer/package.json``
names, in that folder. The bundle, ``moseg_core/view/page/viewer.js``, is committed with the
licence of three.js beside it; its first line has a hash of the sources, by which a test knows that
it was made from these.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
from pathlib import Path

SOURCES = Path(__file__).parent / "viewer"
PAGE = Path(__file__).parents[1] / "moseg_core" / "view" / "page"


def first_line(folder: Path = SOURCES) -> str:
    """What a bundle of these sources begins with."""
    digest = hashlib.sha256()
    for path in sorted([*folder.glob("*.js"), folder / "package.json"]):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    three = json.loads((folder / "package.json").read_text())["dependencies"]["three"]
    return (
        f"/*! From tools/viewer (sha256 {digest.hexdigest()}), Apache-2.0, with three.js {three},"
        " MIT licence, three-license.txt */"
    )


def main() -> None:
    install = ["npm", "install", "--no-audit", "--no-fund", "--no-package-lock"]
    subprocess.run(install, cwd=SOURCES, check=True)
    modules = SOURCES / "node_modules"
    bundled = subprocess.run(
        [
            modules / ".bin" / "esbuild",
            "viewer.js",
            "--bundle",
            "--minify",
            "--format=iife",
            "--global-name=moseg",
            "--target=es2022",
            "--charset=ascii",
            "--legal-comments=none",
        ],
        cwd=SOURCES,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    for ends in ("</script", "<!--"):
        if ends in bundled.lower():
            raise SystemExit(f"the bundle contains {ends}, which would end the page's script")
    text = f"{first_line()}\n{bundled}"
    (PAGE / "viewer.js").write_text(text, encoding="ascii")
    (PAGE / "three-license.txt").write_bytes((modules / "three" / "LICENSE").read_bytes())
    print(f"viewer.js: {len(text) / 1000:.0f} kB")


if __name__ == "__main__":
    main()
