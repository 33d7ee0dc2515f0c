"""Which bundles have been imported before, and what came of it: a record in the cache folder.

A bundle is known by its entry point, distribution and version, and by the Python and core that
imported it (:func:`identity`); together with time and size of each file that its import read. What
was set aside hangs on more: on all files of its package, since any may be mended, and on the
folders of ``sys.path``, which change when something is installed or removed.

The record, ``moseg-bundles.json``, is kept where compiled kernels are kept
(:mod:`moseg_core.shape.compiled`): in ``NUMBA_CACHE_DIR``, else in ``__pycache__`` beside this
file, else in the user's cache folder. It is written to the first of these that can be written to,
and read from all. Where none can, nothing is remembered.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from importlib.util import find_spec
from typing import Any

from moseg_core.components.discovery.contract import VERSION
from moseg_core.components.discovery.distributions import Claim

_FILE = "moseg-bundles.json"
_FORM = 1
#: Entries that are kept; the oldest go.
_MOST = 500

Stamp = tuple[int, int]
"""Time of the last change in ns, and size in bytes; (0, 0) of what is not there."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What the first import of a bundle came to.

    Parameters
    ----------
    problem : str
        Why the bundle must not be imported: "importing 'a.plugin' died of SIGSEGV"; empty where it
        may be.
    printed : str
        What it printed on standard output.
    files : mapping of str to Stamp
        What the verdict hangs on.
    """

    problem: str = ""
    printed: str = ""
    files: Mapping[str, Stamp] = field(default_factory=dict)

    def holds(self) -> bool:
        """Whether nothing that it hangs on has changed since."""
        return all(stamp(path) == tuple(known) for path, known in self.files.items())


def identity(claim: Claim) -> str:
    """What tells one installed bundle from another, for one Python and core."""
    dist = claim.point.dist
    place = "" if dist is None else os.path.abspath(str(dist.locate_file("")))
    return (
        f"{claim.point.name} = {claim.point.value} of {claim.distribution} {claim.version}"
        f" in {place} by moseg-core {VERSION}, Python {sys.version.partition(' ')[0]}"
    )


def stamp(path: str) -> Stamp:
    """When a file was last changed, and its size; of one in an archive those of the archive."""
    while path:
        try:
            found = os.stat(path)
        except NotADirectoryError:
            path = os.path.dirname(path)
        except (OSError, ValueError):
            break
        else:
            return found.st_mtime_ns, found.st_size
    return 0, 0


def stamps(files: Iterable[str]) -> dict[str, Stamp]:
    """The stamps of files."""
    return {path: stamp(path) for path in sorted(set(files))}


def files_of_package(claim: Claim) -> Iterator[str]:
    """The files of the package that an entry point names, which is not imported."""
    try:
        spec = find_spec(claim.point.module.partition(".")[0])
    except (ImportError, ValueError):
        return
    if spec is None:
        return
    if spec.origin and not spec.submodule_search_locations:
        yield os.path.abspath(spec.origin)
    for place in spec.submodule_search_locations or ():
        for folder, folders, files in os.walk(place):
            folders[:] = [name for name in folders if name != "__pycache__"]
            yield from (os.path.join(folder, file) for file in files)


def folders_of_packages() -> set[str]:
    """The folders that packages are installed in; not the working directory, which is busy."""
    return {os.path.abspath(path) for path in sys.path if path} - {os.getcwd()}


# -- The record -----------------------------------------------------------------------------------


def record_folders() -> Iterator[str]:
    """Where the record may be kept, the best place first."""
    if named := os.environ.get("NUMBA_CACHE_DIR"):
        yield named
    yield os.path.join(os.path.dirname(os.path.abspath(__file__)), "__pycache__")
    home = os.path.expanduser("~")
    if sys.platform == "darwin":
        yield os.path.join(home, "Library", "Caches", "moseg")
    else:
        cache = os.environ.get("XDG_CACHE_HOME", "")
        yield os.path.join(cache if os.path.isabs(cache) else f"{home}/.cache", "moseg")


def read_known(names: Collection[str]) -> dict[str, Verdict]:
    """What is remembered of bundles and still holds, by their identity.

    A record that is not there, or not as it should be, remembers nothing.
    """
    known: dict[str, Verdict] = {}
    for record in _records():
        left = [name for name in names if name in record and name not in known]
        known |= {name: record[name] for name in left if record[name].holds()}
    return known


def _records() -> Iterator[dict[str, Verdict]]:
    """The records that there are."""
    for folder in record_folders():
        try:
            with open(os.path.join(folder, _FILE), encoding="utf-8") as file:
                yield dict(_verdicts_of(json.load(file)))
        except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
            continue


def _verdicts_of(document: Any) -> Iterator[tuple[str, Verdict]]:
    """The verdicts in a record of this form; what is of none raises."""
    if document["form"] != _FORM:
        return
    for name, kept in document["bundles"].items():
        files = {str(path): (int(when), int(size)) for path, (when, size) in kept["files"].items()}
        yield name, Verdict(problem=str(kept["problem"]), printed=str(kept["printed"]), files=files)


def remember(verdicts: Mapping[str, Verdict]) -> None:
    """Keep verdicts, beside others that still hold, in the first folder that can be written to.

    Where none can, nothing is kept.
    """
    others = [(name, kept) for record in _records() for name, kept in record.items()]
    kept = {name: verdict for name, verdict in others[-_MOST:] if verdict.holds()} | {**verdicts}
    document = {"form": _FORM, "bundles": {name: asdict(kept[name]) for name in kept}}
    for folder in record_folders():
        passing = os.path.join(folder, f"{_FILE}.{os.getpid()}")
        try:
            os.makedirs(folder, exist_ok=True)
            with open(passing, "w", encoding="utf-8") as file:
                json.dump(document, file)
            os.replace(passing, os.path.join(folder, _FILE))
        except OSError:
            _remove(passing)
        else:
            return


def _remove(path: str) -> None:
    try:
        os.unlink(path)
    except OSError:
        return
