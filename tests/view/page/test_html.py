"""The file of a page: whole, closed to the network, and safe whatever the names are."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from moseg_core.view.page.content import PageContent
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html

HOSTILE = [
    "</script><script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    "<!--",
    "$title ${script}",
    "line\nbreak\u2028\u2029",
    "\u202eright to left",
    "x" * 10_000,
    "lone \ud800 surrogate",
]


class Elements(HTMLParser):
    """The elements of a page, with what scripts and styles hold."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.held, self.links = [], {}, []
        self._open = None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.links += [value for name, value in attributes if name in ("src", "href")]
        if tag in ("script", "style", "title"):
            self._open = f"{tag}{self.tags.count(tag)}"
            self.held[self._open] = ""

    def handle_endtag(self, tag):
        self._open = None

    def handle_data(self, data):
        if self._open:
            self.held[self._open] += data


def page_of(box, names, **more):
    labels = np.arange(box.n_elements) % len(names)
    content = PageContent(shape=box, labels=labels, names=tuple(names), **more)
    return page_html(page_document(content))


def test_nothing_comes_from_elsewhere(box):
    page = Elements(page_of(box, ["a", "b"]).decode())
    assert page.links == ["data:,"]
    assert not {"img", "iframe", "object", "embed", "base", "form"} & set(page.tags)
    assert re.findall(r"url\(|@import", page.held["style1"]) == []
    # An address in the script names a namespace of XML, and is never loaded.
    assert set(re.findall(r"https?://[^\"'`]+", page.held["script2"])) == {
        "http://www.w3.org/1999/xhtml"
    }


def test_the_policy_allows_this_script_and_this_style_and_nothing_else(box):
    text = page_of(box, ["a", "b"]).decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text).group(1)
    held = Elements(text).held
    hashes = {
        kind: base64.b64encode(hashlib.sha256(held[key].encode()).digest()).decode()
        for kind, key in (("script", "script2"), ("style", "style1"))
    }
    assert policy == (
        f"default-src 'none'; script-src 'sha256-{hashes['script']}';"
        f" style-src 'sha256-{hashes['style']}'; img-src data:; base-uri 'none'; form-action 'none'"
    )


@pytest.mark.parametrize("name", HOSTILE, ids=range(len(HOSTILE)))
def test_a_hostile_name_stays_text(box, name):
    plain = Elements(page_of(box, ["a", "b"]).decode())
    page = Elements(page_of(box, [name, "b"], warnings=(name,)).decode())
    assert page.tags == plain.tags
    assert page.held["script2"] == plain.held["script2"]
    document = json.loads(page.held["script1"])
    assert document["parts"][0]["name"] == name


def test_a_hostile_name_of_a_shape_stays_text(box):
    document = page_document(
        PageContent(shape=box, labels=np.zeros(22, np.int64), names=("a",))
    ) | {"name": HOSTILE[0]}
    page = Elements(page_html(document).decode())
    assert page.tags.count("script") == 2
    assert page.held["title1"] == HOSTILE[0]


def test_equal_content_gives_equal_bytes(box):
    assert page_of(box, ["a", "b"]) == page_of(box, ["a", "b"])
