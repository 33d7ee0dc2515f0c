"""The contract between the core and bundles: one integer, and which ones the core accepts.

What a bundle may rely on is counted, apart from the version of any distribution: the hooks, the
specs, the protocols of each kind and the public names of :mod:`moseg_core`. The authors' guide,
``docs/authors/contract.md``, says what is covered and how it may change. A bundle states the
contract that it was written for in the module that its entry point names::

    moseg_contract = 1

One that says nothing was written for the first, which is when the statement came to be. The
checks of :mod:`moseg_core.testing` count in the same numbers: one that is newer than a bundle's
contract warns its authors instead of failing them.
"""

from __future__ import annotations

from typing import Any

VERSION = "0.1.0"
"""The version of moseg-core."""

CONTRACT = 1
"""The contract that this version of moseg-core keeps."""

ACCEPTED = frozenset({1})
"""All contracts for which bundles can be written to be used with it."""

ATTRIBUTE = "moseg_contract"
"""The name under which a bundle's module states its contract."""

UNSTATED = 1
"""The contract of a bundle that states none."""


def stated(module: Any) -> int:
    """The contract that a bundle was written for.

    Parameters
    ----------
    module : object
        What the bundle's entry point names, usually a module.

    Raises
    ------
    ValueError
        It states something that is not a whole number from 1 on.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> stated(SimpleNamespace(moseg_contract=2)), stated(SimpleNamespace())
    (2, 1)
    """
    contract = getattr(module, ATTRIBUTE, UNSTATED)
    if isinstance(contract, bool) or not isinstance(contract, int) or contract < 1:
        raise ValueError(f"{ATTRIBUTE} must be a whole number from 1 on, not {contract!r:.40}")
    return contract


def refusal(contract: int, distribution: str, core: str) -> tuple[str, str] | None:
    r"""Why a bundle of some contract cannot be used, and what to install; None where it can.

    Parameters
    ----------
    contract : int
    distribution : str
        The bundle's, by its name.
    core : str
        Version of moseg-core.

    Examples
    --------
    >>> refusal(1, "moseg-vessels", "0.1.0") is None
    True
    >>> print("\n".join(refusal(9, "moseg-vessels", "0.1.0")))
    it was written for contract 9, and moseg-core 0.1.0 accepts 1
    install a newer moseg-core, or a moseg-vessels for contract 1
    """
    if contract in ACCEPTED:
        return None
    accepted = ", ".join(str(number) for number in sorted(ACCEPTED))
    reason = f"it was written for contract {contract}, and moseg-core {core} accepts {accepted}"
    if contract > CONTRACT:
        return reason, f"install a newer moseg-core, or a {distribution} for contract {accepted}"
    return reason, f"install a newer {distribution}, or an older moseg-core"
