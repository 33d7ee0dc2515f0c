"""What is installed: the entry points of bundles, each distribution counted once.

The same distribution can be there twice: editable and as a wheel, in a virtual environment and
on ``PYTHONPATH``, or left over in part from an update. Python imports one of them. That one is
used, and the bundle says so; otherwise the version on the label would not be that of the code.
Which one it is follows from where the import system finds the package, without importing it.

:mod:`moseg_core.components.discovery.registry` loads what is claimed here.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

ENTRY_POINT_GROUP = "moseg"

_DISTRIBUTION = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
_EXTRA = re.compile(r"\bextra\b")


@dataclass(frozen=True)
class Claim:
    """A namespace that a distribution claims.

    Parameters
    ----------
    point : importlib.metadata.EntryPoint
        Its name is the namespace.
    distribution, version : str
    note : str
        What the user should know about how it is installed; empty where all is well.
    """

    point: metadata.EntryPoint
    distribution: str
    version: str
    note: str = ""

    @property
    def claimant(self) -> str:
        """The distribution's name in its normal form, by which two are told apart."""
        return normal_name(self.distribution)


def installed_points() -> list[metadata.EntryPoint]:
    """All entry points of bundles on ``sys.path``, also those of a distribution's second copy."""
    return [
        point
        for found in metadata.distributions()
        for point in found.entry_points
        if point.group == ENTRY_POINT_GROUP
    ]


def read_claims(points: Iterable[metadata.EntryPoint]) -> list[Claim]:
    """The namespaces that entry points claim, those of distributions that are not used left out.

    Parameters
    ----------
    points : iterable of importlib.metadata.EntryPoint

    Returns
    -------
    list of Claim
        The core's first, then by name.
    """
    copies: dict[str, dict[tuple[str, Path], list[Claim]]] = {}
    claims: list[Claim] = []
    for point in points:
        if point.dist is None:
            claims.append(Claim(point, "an unnamed distribution", "of unknown version"))
            continue
        named = point.dist.metadata  # read and parsed at each touch
        claim = Claim(point, named["Name"], named["Version"])
        place = claim.version, Path(str(point.dist.locate_file(""))).resolve()
        copies.setdefault(claim.claimant, {}).setdefault(place, []).append(claim)
    for found in copies.values():
        claims += next(iter(found.values())) if len(found) == 1 else _used(list(found.values()))
    unique = {(c.point.name, c.point.value, c.claimant): c for c in reversed(claims)}
    return sorted(unique.values(), key=lambda claim: (claim.point.name != "core", claim.point.name))


def _used(copies: Sequence[list[Claim]]) -> list[Claim]:
    """The claims of the copy of a distribution that Python imports, with a note of the others.

    Where that cannot be told, the first on ``sys.path`` is taken.
    """
    homes = [_home(claims[0].point.dist) for claims in copies]
    source = _source(copies[0][0].point)
    holding = [k for k, home in enumerate(homes) if source and source.is_relative_to(home)]
    chosen = max(holding, key=lambda k: len(homes[k].parts), default=0)
    places = " and ".join(
        f"{claims[0].version} in {home}" for claims, home in zip(copies, homes, strict=True)
    )
    name, version = copies[chosen][0].distribution, copies[chosen][0].version
    note = (
        f"{name} is installed {len(copies)} times, {places}; Python imports {version} in"
        f" {homes[chosen]}, so that one is used; uninstall the rest"
    )
    return [Claim(c.point, c.distribution, c.version, note) for c in copies[chosen]]


def _home(dist: metadata.Distribution | None) -> Path:
    """The folder with a distribution's code: of the project, where it is editable."""
    assert dist is not None  # copies are of named distributions
    text = dist.read_text("direct_url.json")
    if text:
        import json
        from urllib.parse import urlparse
        from urllib.request import url2pathname

        direct = json.loads(text)
        if direct.get("dir_info", {}).get("editable"):
            return Path(url2pathname(urlparse(direct["url"]).path)).resolve()
    return Path(str(dist.locate_file(""))).resolve()


def _source(point: metadata.EntryPoint) -> Path | None:
    """Where the top package of an entry point would be imported from, without doing so."""
    top = point.module.partition(".")[0]
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    places = list(spec.submodule_search_locations or [])
    place = spec.origin or (places[0] if places else None)
    return Path(place).resolve() if place else None


def normal_name(name: str) -> str:
    """A distribution's name in its normal form (PyPA: "Names and normalization").

    Examples
    --------
    >>> normal_name("Moseg_Core")
    'moseg-core'
    """
    return re.sub(r"[-_.]+", "-", name).lower()


def required_distributions(name: str) -> frozenset[str]:
    """What a distribution cannot do without, by its metadata, and what that needs in its turn.

    Parameters
    ----------
    name : str
        Of a distribution; one that is not installed needs nothing.

    Returns
    -------
    frozenset of str
        Names in normal form, installed or not. What only extras need is left out; other markers
        are not looked at.

    Examples
    --------
    >>> "pluggy" in required_distributions("moseg-core")
    True
    """
    found: set[str] = set()
    left = [normal_name(name)]
    while left:
        try:
            needed = metadata.requires(left.pop()) or []
        except metadata.PackageNotFoundError:
            continue
        for requirement in needed:
            wanted, _, marker = requirement.partition(";")
            match = _DISTRIBUTION.match(wanted)
            if match and not _EXTRA.search(marker) and normal_name(match.group()) not in found:
                found.add(normal_name(match.group()))
                left.append(normal_name(match.group()))
    return frozenset(found)
