"""From the data of a page to its file: everything in one, nothing from elsewhere.

Browsers are told by a Content-Security-Policy that the page loads nothing, sends nothing and runs
no script but its own, which is named by its hash. The data are JSON in an element that is no
script; ``<`` is written as an escape in it, and so is all that is not ASCII, so that no text can
end the element or become markup.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from functools import cache
from importlib.resources import files
from string import Template
from typing import Any

from moseg_core.components.discovery.contract import VERSION

_LONGEST_TITLE = 120


def page_html(document: dict[str, Any], *, served: bool = False) -> bytes:
    r"""Write a page.

    Parameters
    ----------
    document : dict
        From :func:`moseg_core.view.page.document.page_document`.
    served : bool
        Whether the page is served, and may speak to its own server.

    Returns
    -------
    bytes
        HTML, UTF-8; equal for equal documents.

    Examples
    --------
    >>> page = page_html({"name": "</title><script>alert(1)</script>"})
    >>> page.count(b"<script"), b"alert(1)</script" in page
    (2, False)
    """
    style, script = _resource("page.css"), _resource("viewer.js")
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}';"
        f" img-src data:; base-uri 'none'; form-action 'none'"
    ) + ("; connect-src 'self'" if served else "")
    data = json.dumps(document, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    title = str(document["name"])[:_LONGEST_TITLE].encode(errors="replace").decode()
    return (
        Template(_resource("page.html"))
        .substitute(
            policy=policy,
            title=html.escape(title),
            style=style,
            data=data,
            script=script,
            footer=html.escape(f"Made by moseg {VERSION}; drawn by three.js (MIT licence)."),
        )
        .encode()
    )


@cache
def _resource(name: str) -> str:
    return files("moseg_core.view.page").joinpath(name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """A text as Content-Security-Policy names it."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")
