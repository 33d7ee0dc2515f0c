"""What bundles offer, and how it is found: specs, hooks, the registry, the contract.

A bundle is a distribution with an entry point in the group ``moseg``. It answers the hooks of
:mod:`~moseg_core.components.discovery.hookspecs` with specs
(:mod:`~moseg_core.components.discovery.specs`): names and targets, nothing heavy.
:mod:`~moseg_core.components.discovery.registry` keeps them, and sets aside what is broken or was
written for another contract (:mod:`~moseg_core.components.discovery.contract`). The core's own
components come in by the same door.
"""
