"""Files of code that prose names are shown with the site.

Where a page says ``moseg_core/builtin/flood.py`` in a code span, and there is such a file, the
words become a link to a page that shows it. Only files that are named have one.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]


def file_named(words: str) -> str | None:
    """The file of the project that words name, from its root; None where they name none."""
    if not words.endswith((".py", ".toml")) or "/" not in words or words.startswith(("/", ".")):
        return None
    return words if (ROOT / words).is_file() else None


def link_files(app: Sphinx, tree: nodes.document) -> None:
    """Make links of the code spans of a page that name a file, and remember the files."""
    page = app.env.docname
    for span in list(tree.findall(nodes.literal)):
        file = file_named(span.astext())
        if file is None or isinstance(span.parent, nodes.reference):
            continue
        address = f"{'../' * page.count('/')}code/{file}.html"
        span.replace_self(nodes.reference("", "", span.deepcopy(), refuri=address))
        _files(app.env).setdefault(page, set()).add(file)


def _files(env: Any) -> dict[str, set[str]]:
    """For each page the files that it names; kept with what Sphinx remembers of the pages."""
    if not hasattr(env, "files_of_code"):
        env.files_of_code = {}
    return env.files_of_code  # type: ignore[no-any-return]


def forget(app: Sphinx, env: Any, page: str) -> None:
    """Forget what a page named, before it is read anew."""
    _files(env).pop(page, None)


def merge(app: Sphinx, env: Any, pages: list[str], other: Any) -> None:
    """Take over what another process has read."""
    _files(env).update(_files(other))


def pages_of_code(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """A page for each file that is named."""
    for file in sorted(set().union(*_files(app.env).values())):
        language = "python" if file.endswith(".py") else "toml"
        shown = app.builder.highlighter.highlight_block((ROOT / file).read_text(), language)
        body = f"<h1><code>{file}</code></h1>\n{shown}"
        yield f"code/{file}", {"title": file, "body": body}, "page.html"


def setup(app: Sphinx) -> dict[str, bool]:
    """Link when pages are read, write when all are."""
    app.connect("doctree-read", link_files)
    app.connect("env-purge-doc", forget)
    app.connect("env-merge-info", merge)
    app.connect("html-collect-pages", pages_of_code)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
