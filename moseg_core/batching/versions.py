"""Versions of what computes: the same on all machines of a batch, or the batch is refused.

Two machines with different versions of a bundle, or of NumPy, find different parts for the same
shape, and nobody would see which came from where. So each child process says first what it is made
of, and a difference is refused by name before any shape is done.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from importlib import metadata

from moseg_core.components.discovery.registry import registry

#: Beside the bundles: what numbers may depend on.
_LIBRARIES = ("numpy", "scipy", "numba", "trimesh")


def own_versions() -> dict[str, str]:
    """Versions of this process: Python, the libraries that compute, and every bundle.

    Returns
    -------
    dict of str to str
        A bundle that is set aside says so behind its version.

    Examples
    --------
    >>> {"moseg-core", "numpy", "python"} <= set(own_versions())
    True
    """
    found = {"python": platform.python_version()}
    found |= {name: metadata.version(name) for name in _LIBRARIES}
    for bundle in registry().bundles:
        aside = " (set aside)" if bundle.problem else ""
        found[bundle.distribution] = f"{bundle.version}{aside}"
    return dict(sorted(found.items()))


def difference(here: Mapping[str, str], there: Mapping[str, str]) -> str:
    """What differs between two, in words; empty for nothing.

    Parameters
    ----------
    here, there : mapping of str to str
        Versions by the names of distributions.

    Examples
    --------
    >>> difference({"numpy": "2.1", "moseg-mds": "0.1"}, {"numpy": "2.0"})
    'moseg-mds is 0.1 here and missing there, numpy is 2.1 here and 2.0 there'
    """
    return ", ".join(
        f"{name} is {here.get(name, 'missing')} here and {there.get(name, 'missing')} there"
        for name in sorted({*here, *there})
        if here.get(name) != there.get(name)
    )
