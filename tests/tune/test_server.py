"""A session that is served: what is answered, to whom, and what is written where."""

from __future__ import annotations

import json
import time
from contextlib import ExitStack
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest

import moseg_core as moseg
from moseg_core.errors import UsageError
from moseg_core.tune.server import Destinations, TuneServer
from tests.tune.conftest import serving


class Client:
    """What a browser would send, and what others might."""

    def __init__(self, server):
        parts = urlsplit(server.url)
        self.host, self.path = parts.netloc, parts.path

    def get(self, route="", *, path=None, host=None):
        return self._ask("GET", path or self.path + route, None, {"Host": host or self.host})

    def post(self, route, document, **headers):
        sent = {
            "Host": self.host,
            "Origin": f"http://{self.host}",
            "Content-Type": "application/json",
            **{name.replace("_", "-"): value for name, value in headers.items()},
        }
        body = document if isinstance(document, bytes) else json.dumps(document).encode()
        return self._ask("POST", self.path + route, body, sent)

    def _ask(self, method, path, body, headers):
        connection = HTTPConnection(self.host, timeout=30)
        connection.request(method, path, body, {k: v for k, v in headers.items() if v is not None})
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, content

    def idle(self):
        """Wait for the search to end; what it says then."""
        while (state := json.loads(self.get("state")[1]))["busy"]:
            time.sleep(0.01)
        return state


@pytest.fixture
def said():
    return []


@pytest.fixture
def serve(session, said):
    with ExitStack() as open_servers:

        def start(**destinations):
            server = TuneServer(session, Destinations(**destinations), say=said.append)
            open_servers.enter_context(serving(server))
            return Client(server)

        yield start


def test_the_page_has_the_result_and_a_slider_for_each_term(serve):
    status, page = serve().get()
    assert status == 200
    assert b"connect-src 'self'" in page
    data = page.partition(b'id="data">')[2].partition(b"</script>")[0]
    tune = json.loads(data)["tune"]
    assert [term["text"] for term in tune["terms"]] == [
        "narrow(stem)",
        "narrow(bar)",
        "convex_parts",
    ]
    assert [term["weight"] for term in tune["terms"]] == [1.0, 2.0, 1.0]
    assert (tune["earlier"], tune["recipe"], tune["example"]) == (0, None, None)


def test_a_search_changes_the_page(serve, session, said):
    client = serve()
    assert client.post("search", {"weights": [4, 2, 1]})[0] == 200
    assert client.idle()["problem"] == ""
    assert session.weights == (4.0, 2.0, 1.0)
    assert b'"earlier":1' in client.get()[1]
    assert said[-1].startswith("cost ")
    assert client.post("back", {})[0] == 200
    assert b'"earlier":0' in client.get()[1]


def test_what_goes_wrong_is_told(serve):
    client = serve()
    status, answer = client.post("search", {"weights": [0, 0, 0]})
    assert (status, b"every term has weight 0" in answer) == (400, True)
    client.post("search", {"weights": [1, 2, 1], "moved": {"bra": 0}})
    assert "did you mean 'bar'" in client.idle()["problem"]
    status, answer = client.post("recipe", {})
    assert (status, b"-o recipe.toml" in answer) == (400, True)
    assert client.post("back", {}) == (400, b'{"problem": "this is the first result"}')


def test_recipe_and_example_are_written_where_they_may_be(serve, session, tmp_path):
    recipe, example = tmp_path / "mine.toml", tmp_path / "tee.json"
    client = serve(recipe=recipe, example=example)
    client.post("search", {"weights": [4, 0, 1]})
    client.idle()
    assert json.loads(client.post("recipe", {})[1]) == {"wrote": str(recipe)}
    assert moseg.load_recipe(str(recipe)).statement.minimize == "4*narrow(stem) + convex_parts"
    assert json.loads(client.post("example", {})[1]) == {"wrote": str(example)}
    assert json.loads(example.read_text())["labels"] == session.result.labels.tolist()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml", "tee.json"]


def test_nobody_else_may_ask(serve, session):
    client = serve()
    before = session.result
    for path in ("/", "/x/", "/x/state", client.path[:-1], f"{client.path}../"):
        assert client.get(path=path)[0] == 404, path
    assert client.get(host="example.org")[0] == 404
    assert client.get(host=client.host.replace("127.0.0.1", "localhost"))[0] == 200
    wish = {"weights": [4, 2, 1]}
    for origin in (None, "null", "http://example.org", client.host):
        assert client.post("search", wish, Origin=origin)[0] == 404, origin
    assert client.post("search", wish, Host="example.org")[0] == 404
    assert client.post("search", wish, Content_Type="text/plain")[0] == 400
    assert client.post("nothing", wish)[0] == 404
    assert session.result is before


@pytest.mark.parametrize("sent", [b"", b"{", b"\xff", b"[" * 100_000, b"[]"])
def test_what_is_no_wish_is_refused(serve, sent):
    assert serve().post("search", sent)[0] == 400


def test_a_request_that_is_too_long_is_not_read(serve):
    assert serve().post("search", b"{}", Content_Length=str(10**9))[0] == 400


def test_a_port_that_is_taken_is_named(serve, session):
    port = urlsplit("http://" + serve().host).port
    with pytest.raises(UsageError, match=f"port {port} cannot be served"):
        TuneServer(session, Destinations(), port=port, say=print)
