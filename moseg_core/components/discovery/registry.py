"""Discovery: which bundles are installed, what they bring, and what is wrong with them.

Bundles are found through the entry-point group ``moseg`` and registered with pluggy one at a
time. A bundle that fails to import, misspells a hook or returns something odd is *set aside*:
the reason is kept, with the distribution that it came in, and everything else goes on. Only
somebody who asks for one of its components hears of it, and ``moseg plugin list``.

The core's own components come through the same door, as the bundle ``core``.

A bundle can do worse than raise, so one that is new or changed is first imported by a child process
(:mod:`moseg_core.components.discovery.first_import`).

Two distributions that claim one namespace are both set aside; so is a bundle that was written for a
contract that this core does not accept (:mod:`moseg_core.components.discovery.contract`). With
``MOSEG_STRICT=1`` whatever is set aside is an error, for tests that must not pass without it.
"""

from __future__ import annotations

import importlib
import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib import metadata
from types import ModuleType
from typing import Any

import pluggy

from moseg_core.components.discovery import contract, hookspecs
from moseg_core.components.discovery.distributions import (
    Claim,
    installed_points,
    normal_name,
    read_claims,
    required_distributions,
)
from moseg_core.components.discovery.first_import import verdicts
from moseg_core.components.discovery.hookspecs import HOOKS
from moseg_core.components.discovery.known_bundles import Verdict
from moseg_core.components.discovery.specs import NAME, Kind, Spec
from moseg_core.components.faults import describe, guarded, is_fault, safe_repr, summary
from moseg_core.components.side_effects import without_side_effects
from moseg_core.errors import MosegError, PluginError, UsageError, nearest, unknown

NOT_INSTALLED = "not installed"
"""In the place of the distribution that a component comes from, where no bundle brings it."""

_NO_PLUGINS = "MOSEG_NO_PLUGINS"


@dataclass(frozen=True)
class Component:
    """One component of one bundle.

    Parameters
    ----------
    bundle : str
    distribution : str
        Name and version of the distribution, ``"moseg-core 0.1.0"``.
    spec : Spec
    """

    bundle: str
    distribution: str
    spec: Spec

    @property
    def kind(self) -> Kind:
        """What kind of component it is."""
        return self.spec.kind

    @property
    def id(self) -> str:
        """``bundle:name``."""
        return f"{self.bundle}:{self.spec.name}"

    @property
    def who(self) -> str:
        """The component and where it comes from, for messages."""
        missing = self.distribution == NOT_INSTALLED
        origin = ", which is not installed," if missing else f" of {self.distribution}"
        return f"{self.kind} '{self.id}'{origin}"

    def guard(self, what: str = "failed") -> AbstractContextManager[None]:
        """Turn whatever the component raises into a PluginError that names it.

        moseg's own errors pass: they say what is wrong with the request or with another
        component. So do errors of the operating system about the file that a reader reads.
        """
        return guarded(
            self.who,
            what,
            name=f"{self.kind} {self.id}",
            source=self.distribution,
            passes=(MosegError, OSError) if self.kind == "reader" else (MosegError,),
        )

    def load(self) -> Any:
        """Import the component's module and return the object that its target names.

        Raises
        ------
        PluginError
            The import fails, or the module has no such name.
        """
        module_name, _, attribute = self.spec.target.partition(":")
        try:
            with without_side_effects(self.who):
                return getattr(importlib.import_module(module_name), attribute)
        except PluginError:
            raise
        except BaseException as error:
            if not is_fault(error):
                raise
            raise PluginError(
                f"{self.who} cannot be loaded from '{self.spec.target}': {describe(error)}; update"
                " or reinstall it"
            ) from error


@dataclass(frozen=True)
class Bundle:
    """An installed bundle: its components, or why it is set aside.

    Parameters
    ----------
    name : str
        The namespace, that is the entry point's name.
    distribution, version : str
    module : str
    components : tuple of Component
    problem : str or None
        Why the bundle is set aside, and what to do; None where all is well.
    contract : int
        The one that it was written for (:mod:`moseg_core.components.discovery.contract`).
    note : str
        What is worth knowing of how it is installed, though it can be used; usually empty.
    """

    name: str
    distribution: str
    version: str
    module: str
    components: tuple[Component, ...] = ()
    problem: str | None = None
    contract: int = contract.UNSTATED
    note: str = ""


class Registry:
    """All bundles that were found; look-up of components by kind and name.

    Parameters
    ----------
    bundles : sequence of Bundle

    Examples
    --------
    >>> registry().find("seeder", "kmeans").id
    'core:kmeans'
    >>> registry().find("seeder", "kmean")
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: unknown seeder 'kmean'; did you mean 'kmeans'?
    """

    def __init__(self, bundles: Sequence[Bundle]) -> None:
        self.bundles = tuple(bundles)
        self._components = [c for bundle in self.bundles for c in bundle.components]
        self._of_kind: dict[Kind, list[Component]] = {}
        for component in self._components:
            self._of_kind.setdefault(component.kind, []).append(component)

    def components(self, kind: Kind | None = None) -> list[Component]:
        """Components of one kind, or all, in the order of their bundles."""
        return list(self._components if kind is None else self._of_kind.get(kind, ()))

    def names(self, kind: Kind) -> list[str]:
        """What a user can call the components of a kind, shortest form, sorted."""
        components = self.components(kind)
        bare = [component.spec.name for component in components]
        return sorted(
            component.spec.name if bare.count(component.spec.name) == 1 else component.id
            for component in components
        )

    def find(self, kind: Kind, name: str, *, scope: str | None = None) -> Component:
        """The component called `name`, as ``bundle:name`` or bare where that is unique.

        Parameters
        ----------
        kind : Kind
        name : str
        scope : str, optional
            The bundle that says so. Where several have the name it means its own component, or
            else that of a bundle whose distribution its own one requires; the core is required
            by all.

        Raises
        ------
        UsageError
            Unknown, with the nearest name; or ambiguous, with the full ids.
        PluginError
            The bundle that the id names is set aside; with the reason.
        """
        components = self.components(kind)
        matches = [c for c in components if name in (c.id, c.spec.name)]
        if len(matches) > 1 and scope is not None:
            matches = self._known_to(scope, matches) or matches
        if len(matches) == 1:
            return matches[0]
        if matches:
            ids = ", ".join(sorted(component.id for component in matches))
            raise UsageError(f"{kind} '{name}' is ambiguous; say which: {ids}")
        namespace = name.partition(":")[0] if ":" in name else None
        for bundle in self.bundles:
            if bundle.problem and bundle.name == namespace:
                raise PluginError(
                    f"{kind} '{name}' is not available: bundle '{bundle.name}' is set aside:"
                    f" {bundle.problem}"
                )
        known = [c.id for c in components] if namespace else self.names(kind)
        message = unknown(kind, name, known)
        raise UsageError(message + self._mention_aside() + _mention_no_plugins())

    def _known_to(self, scope: str, components: Sequence[Component]) -> list[Component]:
        """Those that a bundle was written with: its own, or else those that it requires."""
        own = [component for component in components if component.bundle == scope]
        if own:
            return own
        homes = {bundle.name: bundle.distribution for bundle in self.bundles}
        if scope not in homes:
            return []
        required = required_distributions(homes[scope]) | {"moseg-core"}
        return [c for c in components if normal_name(homes[c.bundle]) in required]

    def in_full(self, kind: Kind, name: str, scope: str) -> str:
        """A name that a bundle uses, as anybody may use it: the id where it is ambiguous.

        Raises
        ------
        UsageError
            It is ambiguous even among the components that the bundle was written with.
        """
        offered = [component.spec.name for component in self.components(kind)]
        return name if offered.count(name) < 2 else self.find(kind, name, scope=scope).id

    def _mention_aside(self) -> str:
        aside = [bundle.name for bundle in self.bundles if bundle.problem]
        return f" (set aside, see 'moseg plugin list': {', '.join(aside)})" if aside else ""

    def suffixes(self, kind: Kind) -> dict[str, Component]:
        """The suffixes that readers or writers have, each with the first component that has it."""
        found: dict[str, Component] = {}
        for component in self.components(kind):
            for suffix in getattr(component.spec, "suffixes", ()):
                found.setdefault(suffix, component)
        return found

    def by_suffix(self, kind: Kind, suffix: str) -> Component:
        """The reader or writer for a file suffix such as ``".off"``.

        Parameters
        ----------
        kind : Kind
        suffix : str
            All that may be the suffix: of ``".v2.nii.gz"`` the longest end that is known counts,
            ``".nii.gz"``.

        Raises
        ------
        UsageError
            No component handles the suffix.
        """
        suffixes = self.suffixes(kind)
        words = suffix.split(".")[1:]
        for k in range(len(words)):
            if component := suffixes.get("." + ".".join(words[k:]).lower()):
                return component
        allowed = ", ".join(sorted(suffixes))
        verb = "read" if kind == "reader" else "write"
        asked = f"'.{words[-1]}'" if words else "without a suffix"
        message = f"cannot {verb} files {asked}; formats: {allowed}"
        raise UsageError(message + self._mention_aside() + _mention_no_plugins())


@lru_cache(maxsize=1)
def registry() -> Registry:
    """The registry of this process: everything installed, as MOSEG_PLUGINS restricts it.

    The environment variable ``MOSEG_PLUGINS`` holds the names of the bundles to load, separated
    by commas; the bundle ``core`` is always loaded. ``MOSEG_NO_PLUGINS=1`` loads that alone.
    ``MOSEG_STRICT=1`` asks that each of them can be used.

    Raises
    ------
    UsageError
        One of the variables names no bundle, or is not understood.
    PluginError
        A bundle is set aside, and ``MOSEG_STRICT`` is 1.
    """
    wanted = "" if _is_on(_NO_PLUGINS) else os.environ.get("MOSEG_PLUGINS")
    names = None if wanted is None else {name.strip() for name in wanted.split(",")} | {"core"}
    points = installed_points()
    for name in sorted((names or set()) - {point.name for point in points} - {""}):
        raise UsageError(f"MOSEG_PLUGINS: {unknown('bundle', name, {p.name for p in points})}")
    strict = _is_on("MOSEG_STRICT")
    found = discover(points, restrict_to=names, judge=verdicts)
    aside = [f"'{bundle.name}': {bundle.problem}" for bundle in found.bundles if bundle.problem]
    if aside and strict:
        count = "a bundle is" if len(aside) == 1 else f"{len(aside)} bundles are"
        raise PluginError(f"{count} set aside, and MOSEG_STRICT is 1: {' | '.join(aside)}")
    return found


def _mention_no_plugins() -> str:
    """That bundles are left out, after a name that one of them may have; else nothing."""
    if os.environ.get(_NO_PLUGINS) != "1":
        return ""
    return f" (bundles are left out by --no-plugins, or {_NO_PLUGINS}=1)"


def _is_on(variable: str) -> bool:
    """Whether an environment variable is 1."""
    value = os.environ.get(variable, "")
    if value not in ("", "0", "1"):
        raise UsageError(f"{variable} must be 1 or 0, not '{value}'")
    return value == "1"


def discover(
    entry_points: Iterable[metadata.EntryPoint],
    *,
    restrict_to: set[str] | None = None,
    judge: Callable[[Sequence[Claim]], Sequence[Verdict]] | None = None,
) -> Registry:
    """Load bundles from entry points; what fails is set aside, never raised.

    Parameters
    ----------
    entry_points : iterable of importlib.metadata.EntryPoint
    restrict_to : set of str, optional
        Names of the bundles to load; the others are not even imported.
    judge : callable, optional
        Says of claims which must not be imported here; see
        :func:`moseg_core.components.discovery.first_import.verdicts`. Nobody is asked by default.
    """
    manager = _hooked_manager()
    claims = read_claims(entry_points)
    wanted = [c for c in claims if restrict_to is None or c.point.name in restrict_to]
    rivals: dict[str, dict[str, str]] = {claim.point.name: {} for claim in claims}
    for claim in claims:
        rivals[claim.point.name][claim.claimant] = f"{claim.distribution} {claim.version}"
    # Nobody can set the core aside: it is the program itself.
    claimants = [() if _is_the_core(c) else tuple(rivals[c.point.name].values()) for c in wanted]
    judged = [c for c, others in zip(wanted, claimants, strict=True) if len(others) == 1]
    found = iter(judge(judged) if judge is not None else [Verdict()] * len(judged))
    bundles = [
        _load_bundle(manager, c, others, next(found) if len(others) == 1 else Verdict())
        for c, others in zip(wanted, claimants, strict=True)
    ]
    return Registry(bundles)


def load_alone(claim: Claim) -> Bundle:
    """Load one bundle and no other; see :func:`discover`."""
    return _load_bundle(_hooked_manager(), claim, (), Verdict())


def _hooked_manager() -> pluggy.PluginManager:
    manager = pluggy.PluginManager("moseg")
    manager.add_hookspecs(hookspecs)
    return manager


def _is_the_core(claim: Claim) -> bool:
    return claim.point.name == "core" and claim.claimant == "moseg-core"


def _load_bundle(
    manager: pluggy.PluginManager, claim: Claim, claimants: Sequence[str], verdict: Verdict
) -> Bundle:
    """Load one bundle; `claimants` are all that claim its namespace."""
    point, distribution, version = claim.point, claim.distribution, claim.version
    bundle = Bundle(point.name, distribution, version, point.value, note=claim.note)

    if len(claimants) > 1:
        return _aside(
            bundle,
            f"the namespace '{point.name}' is claimed by {' and '.join(sorted(claimants))}",
            "uninstall one of them",
        )
    if not NAME.match(point.name):
        return _aside(bundle, f"'{point.name}' is not a valid namespace", _report(bundle))
    if verdict.problem:
        return _aside(bundle, verdict.problem, _renew(bundle))
    if verdict.printed:
        said = f"printed when it was imported, and left out: {safe_repr(verdict.printed, most=60)}"
        bundle = replace(bundle, note=f"{bundle.note}; {said}" if bundle.note else said)
    with _unheard() if verdict.printed else nullcontext():
        return _offered(manager, claim.point, bundle)


def _aside(bundle: Bundle, reason: str, advice: str) -> Bundle:
    problem = f"{bundle.distribution} {bundle.version}: {reason}; {advice}"
    return replace(bundle, problem=problem)


def _report(bundle: Bundle) -> str:
    return f"report it to the authors of {bundle.distribution}, or uninstall it"


def _renew(bundle: Bundle) -> str:
    return f"update or reinstall {bundle.distribution}, or uninstall it"


@contextmanager
def _unheard() -> Iterator[None]:
    """While this lasts, what is printed on standard output, also below Python, goes nowhere."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        stream, sys.stdout = sys.stdout, nowhere
        if stream is not None and not stream.closed:
            stream.flush()
        kept = os.dup(1)
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            sys.stdout = stream
            os.dup2(kept, 1)
            os.close(kept)


def _offered(manager: pluggy.PluginManager, point: metadata.EntryPoint, bundle: Bundle) -> Bundle:
    """The bundle with what it offers, or set aside: imported, and asked."""
    report = _report(bundle)
    try:
        module = point.load()
    except BaseException as error:
        if not is_fault(error):
            raise
        advice = _renew(bundle)
        if isinstance(error, ImportError) and (error.name or "").startswith("moseg_core"):
            advice += f"; it may need another moseg-core than {contract.VERSION}"
        return _aside(bundle, f"importing '{point.value}' failed with {summary(error)}", advice)
    try:
        bundle = replace(bundle, contract=contract.stated(module))
        if refused := contract.refusal(bundle.contract, bundle.distribution, contract.VERSION):
            return _aside(bundle, *refused)
        if misspelled := _unknown_hooks(module):
            return _aside(bundle, misspelled, report)
        manager.register(module, name=point.name)
    except BaseException as error:
        if not is_fault(error):
            raise
        return _aside(bundle, f"registering it failed with {summary(error)}", report)

    components: list[Component] = []
    for hook, (kind, spec_type) in HOOKS.items():
        caller = getattr(manager.hook, hook)
        for implementation in caller.get_hookimpls():
            if implementation.plugin_name != point.name:
                continue
            try:
                specs = list(implementation.function())
            except BaseException as error:
                if not is_fault(error):
                    raise
                return _aside(bundle, f"hook '{hook}' failed with {summary(error)}", report)
            for spec in specs:
                if not isinstance(spec, spec_type):
                    return _aside(
                        bundle,
                        f"hook '{hook}' returned {safe_repr(spec)}, not a {spec_type.__name__}",
                        report,
                    )
                component = Component(point.name, f"{bundle.distribution} {bundle.version}", spec)
                if any(c.id == component.id and c.kind == kind for c in components):
                    return _aside(bundle, f"it offers the {kind} '{component.id}' twice", report)
                components.append(component)
    if not components:
        return _aside(bundle, "it offers no components", "see the authors' guide on hooks")
    return replace(bundle, components=tuple(components))


def _unknown_hooks(module: ModuleType) -> str:
    """A complaint about functions marked as hooks that are none; empty where all are known."""
    for name, marked in _marked(module):
        hook = marked.get("specname") or name
        if hook not in HOOKS:
            guess = nearest(hook, HOOKS)
            hint = f"did you mean '{guess}'?" if guess else f"known: {', '.join(HOOKS)}"
            return f"'{name}' is marked as a hook, but there is no such hook ({hint})"
    return ""


def _marked(module: ModuleType) -> Iterator[tuple[str, dict[str, Any]]]:
    """Names and marks of the functions that ``hookimpl`` has marked."""
    for name in dir(module):
        value = getattr(module, name)
        # Only functions: proxies and mocks answer to any attribute, or raise at a touch.
        marks = getattr(value, "moseg_impl", None) if inspect.isroutine(value) else None
        if isinstance(marks, dict):
            yield name, marks
