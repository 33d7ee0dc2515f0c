"""Running checks: on all components of a bundle, one outcome for each check and component.

A case is a check on a component. Expected failures are strict: one that passes, and one of an
unknown id, is a failure itself, so that lists of them do not rot.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from moseg_core.components.discovery.registry import Registry, registry
from moseg_core.components.discovery.specs import Kind, Spec
from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.process_state import look, restore
from moseg_core.errors import PluginError, UsageError, unknown
from moseg_core.testing.check import CHECKS, Check, ContractFailure, Skip, Subject
from moseg_core.testing.fixtures.alone import as_bundle

Status = Literal["passed", "failed", "skipped", "expected", "warned"]

#: The modules whose checks are run, in this order.
_MODULES = (
    "general",
    "declarations",
    "repeats",
    "side_effects",
    "objectives",
    "vectorized",
    "invariances",
    "fields",
    "parameterizations",
    "seeders",
    "labelers",
    "optimizers",
    "refiners",
    "constraints",
    "embeddings",
    "learners",
    "formats",
)


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of a case.

    Parameters
    ----------
    component : str
        Id of the component.
    check : str
        Id of the check.
    status : str
        "passed", "failed", "skipped" where it does not apply, "expected" for a failure that was
        announced, "warned" for one of a check that is newer than the bundle.
    message : str
        Why, where it did not pass.
    fix : str
        How to mend it; empty where the check could not say.
    cause : BaseException, optional
        What the component raised, where that was it, with its traceback.
    """

    component: str
    check: str
    status: Status
    message: str = ""
    fix: str = ""
    cause: BaseException | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """A check on a component; call it to have it raise where it fails.

    Parameters
    ----------
    check : Check
    subject : Subject
    expected : str
        Why it is expected to fail; empty where it is not.
    contract : int
        The one that the bundle was written for.
    """

    check: Check
    subject: Subject
    expected: str = ""
    contract: int = 1

    @property
    def id(self) -> str:
        """``bundle:name check-id``."""
        return f"{self.subject.component.id} {self.check.id}"

    def outcome(self) -> Outcome:
        """Run the check."""
        ids: dict[str, Any] = {"component": self.subject.component.id, "check": self.check.id}
        if shut := _shut_gate(self.check, self.subject):
            reason = f"it fails '{shut}', without which this cannot be said"
            return Outcome(**ids, status="skipped", message=reason)
        try:
            failure, fix, cause = _failure(self.check, self.subject)
        except Skip as reason:
            return Outcome(**ids, status="skipped", message=str(reason))
        if failure and self.expected:
            return Outcome(**ids, status="expected", message=f"{self.expected}: {failure}")
        if failure and self.check.since > self.contract:
            return Outcome(**ids, status="warned", message=failure, fix=fix)
        if self.expected and not failure:
            failure = f"was expected to fail ({self.expected}) and passes; take it off the list"
        status: Status = "failed" if failure else "passed"
        return Outcome(**ids, status=status, message=failure, fix=fix, cause=cause)

    def __call__(self) -> None:
        """Run the check, for use in a test.

        Raises
        ------
        ContractFailure
            It fails.
        """
        outcome = self.outcome()
        if outcome.status == "failed":
            fix = f"\nhow to fix it: {outcome.fix}" if outcome.fix else ""
            raise AssertionError(
                f"{self.id}: {outcome.message}{fix}\nwhy it matters: {self.check.why}"
            ) from outcome.cause
        if outcome.status in ("skipped", "expected"):
            import unittest

            raise unittest.SkipTest(outcome.message)
        if outcome.status == "warned":
            fix = f"; {outcome.fix}" if outcome.fix else ""
            warnings.warn(f"{self.id}: {outcome.message}{fix}", FutureWarning, stacklevel=2)


def _failure(check: Check, subject: Subject) -> tuple[str, str, BaseException | None]:
    """What a check complains about, how to mend it, and what was raised; empty where it passes.

    Raises
    ------
    Skip
        It does not apply.
    """
    with warnings.catch_warnings():
        # Warnings are the business of one check; to the others they must not be errors.
        warnings.simplefilter("ignore")
        before = look()  # what one check's component changes must not hide another's
        try:
            check.run(subject)
        except Skip:
            raise
        except ContractFailure as error:
            # The kit's own frames would only stand between the author and the author's.
            said = f"{error.did}: got {error.got}, expected {error.expected}"
            return said, error.fix, error.__cause__
        except FAULTS as error:
            return f"it raised {describe(error)}", "", error
        finally:
            restore(before)
    return "", "", None


def _shut_gate(check: Check, subject: Subject) -> str:
    """Id of the first gate before a check that the component does not pass; empty for none."""

    def failure(gate: Check) -> str:
        try:
            return _failure(gate, subject)[0]
        except Skip:
            return ""

    # Checks are registered in the order of imports, which is anybody's; of gates only their own
    # order counts.
    for gate in (gate for gate in load_checks() if gate.gate):
        if gate is check:
            break
        applies = subject.component.kind in gate.kinds
        if applies and subject.keep(f"gate {gate.id}", lambda gate=gate: failure(gate)):  # type: ignore[misc]
            return gate.id
    return ""


def load_checks() -> tuple[Check, ...]:
    """All checks there are, in the order in which they are run; whatever was imported before.

    Examples
    --------
    >>> load_checks()[0].id
    'target-resolves'
    """
    modules = [importlib.import_module(f"moseg_core.testing.checks.{name}") for name in _MODULES]
    place = {module.__name__: k for k, module in enumerate(modules)}
    last = len(place)
    found = sorted(CHECKS.values(), key=lambda check: place.get(check.run.__module__, last))
    return tuple(found)


def cases_of(
    bundle: str | Spec | Callable[..., Any],
    *,
    kind: Kind | None = None,
    expected_failures: Mapping[str, str] | None = None,
    source: Registry | None = None,
) -> list[Case]:
    """All checks on all components of an installed bundle, or on one that is not installed.

    Parameters
    ----------
    bundle : str, Spec or callable
        The namespace of an installed bundle, the entry point's name. Or a component that no bundle
        brings yet: an objective, a class or function together with its `kind`, or the spec of one.
        Other processes import it too, so it stands at the top of a module that can be imported.
    kind : Kind, optional
        Of a class or function.
    expected_failures : mapping of str to str, optional
        For the id of a check, or ``name check-id`` for one component, why it fails.
    source : Registry, optional
        Where to look; everything installed by default.

    Raises
    ------
    UsageError
        No such bundle, or no such check; a class or function that cannot be imported, or of which
        is not said what kind it is.
    PluginError
        The bundle is set aside.

    Examples
    --------
    >>> from moseg_core.builtin.greedy import Greedy
    >>> cases_of(Greedy, kind="labeler")[-1].id
    'moseg_core.builtin.greedy:Greedy labeler-equivariant'
    """
    checks = load_checks()
    found = registry() if source is None else source
    if not isinstance(bundle, str):
        alone = as_bundle(bundle, kind)
        found, bundle = Registry([*found.bundles, alone]), alone.name
    elif kind is not None:
        raise UsageError(f"the kind '{kind}' is about a class or function, not about a bundle")
    chosen = [b for b in found.bundles if b.name == bundle]
    if not chosen:
        raise UsageError(unknown("bundle", bundle, [b.name for b in found.bundles]))
    if chosen[0].problem:
        raise PluginError(f"bundle '{bundle}' is set aside: {chosen[0].problem}")
    expected = dict(expected_failures or {})
    cases: list[Case] = []
    used: set[str] = set()
    for component in chosen[0].components:
        subject = Subject(component=component, registry=found)
        for check in checks:
            if component.kind not in check.kinds:
                continue
            keys = [f"{component.spec.name} {check.id}", check.id]
            key = next((key for key in keys if key in expected), None)
            used.update([] if key is None else [key])
            reason = "" if key is None else expected[key]
            cases.append(
                Case(check=check, subject=subject, expected=reason, contract=chosen[0].contract)
            )
    for key in set(expected) - used:
        raise UsageError(
            f"expected_failures: {unknown('check', key.split()[-1], CHECKS)} (or it does not apply"
            f" to what '{bundle}' brings)"
        )
    return cases


def run_cases(cases: Sequence[Case]) -> list[Outcome]:
    """The outcomes of cases, one after the other."""
    return [case.outcome() for case in cases]


def parametrize_contract(
    bundle: str | Spec | Callable[..., Any],
    *,
    kind: Kind | None = None,
    expected_failures: Mapping[str, str] | None = None,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """A decorator for a test function with the argument ``check``, run once for each case.

    Parameters
    ----------
    bundle, kind, expected_failures
        See :func:`cases_of`: an installed bundle, or a component that is not installed.

    Raises
    ------
    UsageError, PluginError
        See :func:`cases_of`.
    """
    import pytest

    cases = cases_of(bundle, kind=kind, expected_failures=expected_failures)
    return pytest.mark.parametrize("check", cases, ids=[case.id for case in cases])
