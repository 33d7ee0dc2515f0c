"""A session served to a browser on the same machine.

The page is that of the result with sliders beside it (``tools/viewer/tune.js``); it asks for
searches, and loads itself anew when one is done. Requests are answered by threads. Searches are
done by the thread that :meth:`TuneServer.serve` runs in, one at a time and in one process: a copy
of a process with threads may find locks that nobody lets go of.

Who may ask: the server listens on the loopback address alone; a path begins with a random token,
which other programs' users do not know; the ``Host`` header must name the loopback address, so that
a foreign site whose name leads here learns nothing; what changes anything must be JSON and come
from the page itself, so that a foreign site cannot send it. Files are written where the command
line said, nowhere else.
"""

from __future__ import annotations

import json
import queue
import secrets
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from moseg_core.components.protocols import Progress
from moseg_core.errors import MosegError, UsageError
from moseg_core.io import save, write_file
from moseg_core.search.result import Result
from moseg_core.tune.session import Session, Wish
from moseg_core.view.page.content import PageContent
from moseg_core.view.page.document import page_document
from moseg_core.view.page.html import page_html

ADDRESS = "127.0.0.1"

#: Bytes of a request that are read; a wish has a number for each term and label.
_MOST_BYTES = 1_000_000
#: Seconds that a silent client is waited for.
_PATIENCE = 20
#: Seconds between looks at whether to end.
_ENDED_WITHIN = 0.05


@dataclass(frozen=True, kw_only=True)
class Destinations:
    """Where files go that the page asks for; what has no place cannot be asked for.

    Parameters
    ----------
    recipe : Path or None
        The recipe with the weights of the present result, as TOML.
    example : Path or None
        The present result, as JSON, to learn from.
    """

    recipe: Path | None = None
    example: Path | None = None


class TuneServer:
    """Serves a session until told to stop.

    Parameters
    ----------
    session : Session
    destinations : Destinations
    port : int
        0 for any that is free.
    say : callable
        Receives a line about what was done.

    Attributes
    ----------
    url : str
        What to open in a browser.
    """

    def __init__(
        self,
        session: Session,
        destinations: Destinations,
        *,
        port: int = 0,
        say: Callable[[str], object],
    ) -> None:
        self._session, self._destinations, self._say = session, destinations, say
        self._folder = Path.cwd()  # components, which a search calls, may go elsewhere
        self._token = secrets.token_urlsafe(16)
        self._wishes: queue.Queue[Wish | None] = queue.Queue()
        # What requests read while a search goes on.
        self._lock = threading.Lock()
        self._busy = self._stopping = False
        self._text = self._problem = ""
        self._page: tuple[Result, bytes] | None = None
        try:
            self._http = ThreadingHTTPServer((ADDRESS, port), partial(_Handler, self))
        except OSError as error:
            raise UsageError(
                f"port {port} cannot be served: {error.strerror}; name another, or none for any"
            ) from error
        self._http.daemon_threads = True
        self.url = f"http://{ADDRESS}:{self._http.server_port}/{self._token}/"

    def serve(self) -> None:
        """Answer requests and search, until :meth:`close` or an interrupt."""
        listening = threading.Thread(
            target=self._http.serve_forever, args=(_ENDED_WITHIN,), daemon=True
        )
        listening.start()
        try:
            while (wish := self._wishes.get()) is not None:
                self._search(wish)
        finally:
            self._http.shutdown()
            self._http.server_close()
            listening.join()
            with self._lock:  # a file that is being written is finished
                pass

    def close(self) -> None:
        """Stop serving, from another thread; a search under way is asked to end."""
        self._stopping = True
        self._wishes.put(None)

    def _search(self, wish: Wish) -> None:
        """Do what was wished; the page shows what goes wrong, and the present result stays."""
        try:
            result = self._session.search(wish, self._listen)
        except MosegError as error:
            problem = str(error)
        else:
            problem = ""
            self._say(f"cost {result.cost:.6g}, {result.reason}")
        with self._lock:
            self._busy, self._problem = False, problem

    def _listen(self, progress: Progress) -> bool:
        best = "" if progress.best is None else f", cost {progress.best.value:.6g}"
        self._text = f"{progress.stage} {progress.done}{best}"
        return self._stopping

    # -- what requests ask for --------------------------------------------------------------------

    def page(self) -> bytes:
        """The present result with sliders beside it."""
        with self._lock:
            result, weights = self._session.result, self._session.weights
            if self._page is None or self._page[0] is not result:
                document = page_document(PageContent.of_result(result))
                document["tune"] = {
                    "terms": [
                        {"text": term.call, "weight": weight, "given": term.weight}
                        for term, weight in zip(self._session.terms, weights, strict=True)
                    ],
                    "earlier": self._session.earlier,
                    "recipe": _named(self._destinations.recipe),
                    "example": _named(self._destinations.example),
                }
                self._page = result, page_html(document, served=True)
            return self._page[1]

    def state(self, document: object) -> dict[str, Any]:
        """How far the search is."""
        with self._lock:
            return {
                "busy": self._busy,
                "text": self._text if self._busy else "",
                "problem": self._problem,
            }

    def search(self, document: object) -> dict[str, Any]:
        """Begin a search."""
        wish = Wish.read(document)
        self._session.recipe(wish.weights)  # refuses before it is waited for
        with self._lock:
            self._check_idle()
            self._busy, self._stopping, self._text, self._problem = True, False, "begins", ""
        self._wishes.put(wish)
        return {}

    def stop(self, document: object) -> dict[str, Any]:
        """End a search with the best that it has found."""
        self._stopping = True
        return {}

    def back(self, document: object) -> dict[str, Any]:
        """Take the last search back."""
        with self._lock:
            self._check_idle()
            self._session.back()
            self._problem = ""
        return {}

    def save_recipe(self, document: object) -> dict[str, Any]:
        """Write the recipe."""
        with self._lock:
            self._check_idle()
            path = _required(self._destinations.recipe, "-o recipe.toml")
            write_file(self._folder / path, self._session.recipe().toml().encode())
        self._say(f"wrote {path}")
        return {"wrote": str(path)}

    def save_example(self, document: object) -> dict[str, Any]:
        """Write the result."""
        with self._lock:
            self._check_idle()
            path = _required(self._destinations.example, "--example result.json")
            save(self._session.result, self._folder / path)
        self._say(f"wrote {path}")
        return {"wrote": str(path)}

    def _check_idle(self) -> None:
        if self._busy:
            raise UsageError("a search is under way; stop it first")

    # -- who may ask ------------------------------------------------------------------------------

    def route(self, path: str, host: str) -> str | None:
        """What a path asks for, "" for the page; None where it is nobody's who may ask."""
        ours = {f"{name}:{self._http.server_port}" for name in (ADDRESS, "localhost")}
        token, slash, route = urlsplit(path).path.removeprefix("/").partition("/")
        known = secrets.compare_digest(token.encode(), self._token.encode())
        return route if known and slash and host in ours else None

    def is_own(self, origin: str | None) -> bool:
        """Whether a request that changes something comes from the page itself."""
        port = self._http.server_port
        return origin in {f"http://{name}:{port}" for name in (ADDRESS, "localhost")}


def _named(path: Path | None) -> str | None:
    return None if path is None else str(path)


def _required(path: Path | None, option: str) -> Path:
    if path is None:
        raise UsageError(f"'moseg tune' was given no place for it; start it with {option}")
    return path


class _Handler(BaseHTTPRequestHandler):
    """One request."""

    timeout = _PATIENCE
    server_version, sys_version = "moseg", ""

    def __init__(self, tune: TuneServer, *rest: Any) -> None:
        self._tune = tune
        super().__init__(*rest)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing: the command line says what was done."""

    def do_GET(self) -> None:
        route = self._tune.route(self.path, self.headers.get("Host", ""))
        if route == "":
            self._send(HTTPStatus.OK, self._tune.page(), "text/html; charset=utf-8")
        elif route == "state":
            self._send_json(HTTPStatus.OK, self._tune.state(None))
        else:
            self._send_json(HTTPStatus.NOT_FOUND, {"problem": "there is nothing here"})

    def do_POST(self) -> None:
        route = self._tune.route(self.path, self.headers.get("Host", ""))
        answers: dict[str, Callable[[object], dict[str, Any]]] = {
            "search": self._tune.search,
            "stop": self._tune.stop,
            "back": self._tune.back,
            "recipe": self._tune.save_recipe,
            "example": self._tune.save_example,
        }
        if route not in answers or not self._tune.is_own(self.headers.get("Origin")):
            self._send_json(HTTPStatus.NOT_FOUND, {"problem": "there is nothing here"})
            return
        try:
            document = self._document()
            answer = answers[route](document)
        except MosegError as error:
            self._send_json(HTTPStatus.BAD_REQUEST, {"problem": str(error)})
        else:
            self._send_json(HTTPStatus.OK, answer)

    def _document(self) -> object:
        """The JSON that was sent."""
        if self.headers.get_content_type() != "application/json":
            raise UsageError("what is sent must be JSON")
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit() and int(length) <= _MOST_BYTES):
            raise UsageError(f"at most {_MOST_BYTES} bytes are read, and their number is needed")
        try:
            return json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError) as error:
            raise UsageError("what was sent is no JSON") from error

    def _send_json(self, status: HTTPStatus, document: dict[str, Any]) -> None:
        self._send(status, json.dumps(document).encode(), "application/json")

    def _send(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(len(content))),
            ("Cache-Control", "no-store"),
            ("X-Content-Type-Options", "nosniff"),
            ("X-Frame-Options", "DENY"),
            ("Referrer-Policy", "no-referrer"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)
