"""A result shown where its user is: as a page in the browser, or in the output of a notebook.

A :class:`~moseg_core.search.result.Result` has its page made by whatever writes ``.html``; nothing
here knows how it looks.
"""

from __future__ import annotations

import html
import os
import tempfile
import webbrowser
from pathlib import Path

from moseg_core.errors import MosegError

#: Height of the page in a notebook, pixels.
_HEIGHT = 620


def framed(page: bytes) -> str:
    """A frame that holds a page, as HTML: what is in it cannot reach what is around it.

    Examples
    --------
    >>> framed(b'<p title="a">')[:60]
    '<iframe srcdoc="&lt;p title=&quot;a&quot;&gt;" sandbox="allo'
    """
    return (
        f'<iframe srcdoc="{html.escape(page.decode())}" sandbox="allow-scripts"'
        f' allow="clipboard-write" title="segmented shape"'
        f' style="width: 100%; height: {_HEIGHT}px; border: 1px solid #8884; border-radius: 8px">'
        "</iframe>"
    )


def open_page(page: bytes, *, browser: bool = True) -> tuple[Path, bool]:
    """Write a page to a file of its own in the system's folder for such, and open it.

    Parameters
    ----------
    page : bytes
    browser : bool
        Whether to open it.

    Returns
    -------
    path : Path
    opened : bool
        Whether a browser said that it would.

    Raises
    ------
    MosegError
        There is no place for the file.
    """
    try:
        descriptor, name = tempfile.mkstemp(prefix="moseg-", suffix=".html")
        with os.fdopen(descriptor, "wb") as file:
            file.write(page)
    except OSError as error:
        raise MosegError(f"cannot write the page: {error.strerror or error}") from error
    path = Path(name)
    return path, browser and webbrowser.open(path.as_uri())
