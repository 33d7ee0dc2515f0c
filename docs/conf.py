"""The site: Sphinx reads ``docs/*.md``, runs ``examples/`` and asks the code for the API.

``make docs`` builds it into ``build/docs``; every warning is an error. Pages are plain Markdown
that also reads well without Sphinx, so what the site alone needs is added here: the order of the
pages (:data:`ORDER`), and where links lead that leave the folder (``_ext/outside.py``). Other
extensions in ``_ext`` make pages of the API from the public face, collect pictures and pages of the
examples for the gallery, and show files of code that prose names.
"""

from __future__ import annotations

import sys
from pathlib import Path

from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
sys.path[:0] = [str(DOCS / "_ext"), str(ROOT)]

from gallery_files import PAGES  # noqa: E402 - found by the path above

from moseg_core import __version__  # noqa: E402 - as above

project = "moseg"
author = "The moseg maintainers"
copyright = "the moseg maintainers, Apache-2.0"
version = release = __version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "api_pages",
    "code_pages",
    "outside",
]
exclude_patterns = ["authors/tutorial/*"]
templates_path = ["_templates"]
highlight_language = "none"  # most indented blocks are shell, formulas or files
smartquotes = False  # options begin with two hyphens

#: For each page that others stand under, those pages in their order. A page whose own title is too
#: long for a menu has another one there.
ORDER = {
    "index": [
        *("/start", "/gallery/index", "/how_to", "/reference"),
        *("For authors </authors/index>", "The paper </paper>"),
    ],
    "how_to": [
        *("/how_to/words", "/how_to/mend"),
        *("/how_to/modeller", "/how_to/biologist", "/how_to/roboticist", "/how_to/doctor"),
        *("/learning", "/steering", "/tuning", "/symmetry", "/embedding", "/surfaces"),
        *("/hierarchy", "/variants", "/clipping", "/batch", "/checkpoints"),
    ],
    "reference": [
        *("/language", "/objectives", "/components", "/cli", "/generated/index"),
        *("/promises", "/formats", "/metrics", "/benchmark", "/speed"),
        *("Learned recipes </generated/recipes_shapes>", "/generated/changes"),
    ],
    "authors/index": [
        *("/authors/tutorial", "/plugins"),
        *("/authors/objective", "/authors/field", "/authors/seeder", "/authors/labeler"),
        *("/authors/optimizer", "/authors/parameterization", "/authors/refiner"),
        *("/authors/constraint", "/authors/embedding", "/authors/files"),
        *("/authors/publishing", "/authors/contract", "/authors/checks"),
        *("/architecture", "/generated/contributing"),
    ],
}
_LISTED = {line.rpartition("</")[2].strip("/>") for lines in ORDER.values() for line in lines}
#: Pages that are not in the list stand at the end of the reference.
ORDER["reference"] += [
    f"/{page.stem}" for page in sorted(DOCS.glob("*.md")) if page.stem not in _LISTED | {"index"}
]

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]

autosummary_generate = True
autodoc_typehints = "none"  # numpydoc sections say the types in words
autodoc_member_order = "groupwise"
numpydoc_show_class_members = False  # autodoc lists them

sphinx_gallery_conf = {
    "examples_dirs": str(ROOT / "examples"),
    "gallery_dirs": "gallery",
    "filename_pattern": "",
    "image_scrapers": ("gallery_files",),
    "reset_modules": (),  # what it resets by default are plotting libraries
    "reset_argv": "gallery_files.folder_of_examples",
    "abort_on_example_error": True,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "show_signature": False,
    "download_all_examples": False,
    "remove_config_comments": True,
}

html_theme = "pydata_sphinx_theme"
html_title = "moseg"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = [str(PAGES)]
html_show_sourcelink = False
html_copy_source = False
html_sidebars = {"index": [], "start": [], "paper": []}
html_theme_options = {
    "logo": {"text": "moseg"},
    "show_toc_level": 2,
    "navbar_align": "left",
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": [],
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
}


def add_pages_below(app: Sphinx, page: str, source: list[str]) -> None:
    """Append the list of the pages that stand under a page, unseen, to its text."""
    if page in ORDER:
        pages = "\n".join(ORDER[page])
        source[0] += f"\n\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"


PAGES.mkdir(parents=True, exist_ok=True)  # as the setting names it


def setup(app: Sphinx) -> None:
    """Connect what is defined above."""
    app.connect("source-read", add_pages_below)
