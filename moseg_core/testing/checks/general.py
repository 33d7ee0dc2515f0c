"""What every component promises before it does anything: it is found, it can be made, it answers.

The checks on that are gates. A component that cannot be loaded or made is reported once, and not
once more for everything that it therefore does not do. What components do when they run is
compared in :mod:`moseg_core.testing.checks.repeats`, their parameters in
:mod:`moseg_core.testing.checks.declarations`.
"""

from __future__ import annotations

import inspect
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, get_args

from moseg_core.components import protocols
from moseg_core.components.discovery.first_import import IN_TRIAL
from moseg_core.components.discovery.registry import NOT_INSTALLED
from moseg_core.components.discovery.specs import Invariance, Kind, Requirement
from moseg_core.components.faults import FAULTS, describe
from moseg_core.components.objectives import COST_ORDER, Arity, Traits
from moseg_core.components.parameters import Parameter
from moseg_core.components.process_state import AT_IMPORT, told
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import load_recipe
from moseg_core.problem.variants import closed_statements
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.observation import listening, observed
from moseg_core.testing.fixtures.problems import constraints_on, evaluator_on
from moseg_core.testing.fixtures.shapes import lump, twin
from moseg_core.testing.fixtures.toys import optimizer_on
from moseg_core.testing.fixtures.trial import FACTORIES, Trial, declared, has_example

ALL: tuple[Kind, ...] = get_args(Kind)

#: What each target is called with, by kind: positional arguments, then keyword ones.
_CALLED: dict[Kind, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "measure": (("part",), ()),
    "field": (("shape",), ()),
    "parameterization": (("shape", "n_parts"), ()),
    "seeder": ((), ()),
    "labeler": ((), ()),
    "optimizer": (("start", "lower", "upper", "scale"), ("rng",)),
    "refiner": ((), ()),
    "constraint": (("shape", "labels"), ()),
    "embedding": ((), ()),
    "learner": (("examples",), ()),
    "reader": (("path",), ()),
    "writer": (("result",), ()),
}


# -- Found and made ---------------------------------------------------------------------------


@check("target-resolves", kinds=ALL, gate=True)
def _target_resolves(subject: Subject) -> None:
    """A target that names nothing is only noticed by the user who asks for the component."""
    spec = subject.component.spec
    did = f"'{spec.target}' was imported"
    try:
        _first_load(subject)
        target = subject.load()
    except FAULTS as error:
        raise ContractFailure(
            did=did,
            got=describe(error.__cause__ or error),
            expected=f"the {spec.kind} '{spec.name}'",
            fix="correct the target in its spec, or what its module does when it is imported",
        ) from error
    if spec.kind != "recipe" and not callable(target):
        raise ContractFailure(
            did=did,
            got=f"a {type(target).__name__}, which cannot be called",
            expected=f"the function or class of the {spec.kind} '{spec.name}'",
            fix="let the target name the function or class itself",
        )


def _first_load(subject: Subject) -> tuple[str, str]:
    """What importing a component's module says, and what it changes; nothing the second time."""

    def load() -> tuple[str, str]:
        with listening() as heard:
            _, changes = observed(subject.load, AT_IMPORT, draws=False)
        return heard["standard output"] or heard["standard error"], told(changes)

    found: tuple[str, str] = subject.keep("first load", load)
    return found


def target_import(subject: Subject) -> tuple[str, str]:
    """What importing the component's module printed, and what it changed of the process.

    Nothing is known of a module that somebody had imported before the checks.
    """
    return _first_load(subject)


@check("signature-fits", kinds=ALL, gate=True)
def _signature_fits(subject: Subject) -> None:
    """The core calls all components of a kind alike, and reads parameters from the signature."""
    kind, target = subject.component.kind, subject.load()
    if kind == "objective":
        _traits_fit(target)
    elif kind == "recipe":
        stated = load_recipe(subject.component.id, source=subject.registry).statement
        # Of an open recipe two parts are numbered: words about several parts need as many.
        several = stated.with_parts(len(stated.labels) + 1) if stated.is_open else stated
        for closed in closed_statements(several, source=subject.registry):
            Problem.of(closed, registry=subject.registry)
    if kind in _CALLED:
        _binds(target, *_CALLED[kind], who=f"the target '{subject.component.spec.target}'")
    try:
        declared(subject)
    except TypeError as error:
        raise ContractFailure(
            did="its parameters were read from its signature",
            got=str(error),
            expected="keyword-only arguments annotated as float, int, bool, str, Target or Table",
            fix="annotate them, with moseg_core.Interval for bounds; put what is no parameter of"
            " the user's somewhere else",
        ) from error


def _traits_fit(target: Any) -> None:
    if not isinstance(target, protocols.Objective) or not isinstance(target.traits, Traits):
        raise ContractFailure(
            did="its traits and parameters were asked for",
            got=f"a {type(target).__name__} without them",
            expected="an objective",
            fix="decorate the function with @moseg_core.objective(range=...)",
        )
    traits = target.traits
    sound = {
        f"the arity {traits.arity!r}": traits.arity in get_args(Arity),
        f"the range {traits.range}": traits.range[0] < traits.range[1],
        f"the cost {traits.cost!r}": traits.cost in COST_ORDER,
        f"the requirements {set(traits.requires)}": traits.requires <= {*get_args(Requirement)},
        f"the invariances {set(traits.invariant_to)}": traits.invariant_to
        <= {*get_args(Invariance)},
        f"the share {traits.share!r}": traits.share is None or callable(traits.share),
        "parameters of another class": all(isinstance(p, Parameter) for p in target.parameters),
    }
    if wrong := [name for name, holds in sound.items() if not holds]:
        raise ContractFailure(
            did="its traits were read",
            got=wrong[0],
            expected="what moseg_core.components.objectives.Traits describes",
            fix="decorate the function with @moseg_core.objective, which checks them",
        )


def _binds(target: Any, positional: Sequence[str], keywords: Sequence[str], who: str) -> None:
    """Complain unless something can be called with these arguments."""
    try:
        signature = inspect.signature(target)
    except (TypeError, ValueError):
        return  # written in another language; calling it will tell
    given = ", ".join([*positional, *(f"{name}=..." for name in keywords)])
    required = {
        name: None
        for name, p in signature.parameters.items()
        if p.kind is p.KEYWORD_ONLY and p.default is p.empty and name not in keywords
    }
    try:
        signature.bind(*positional, **dict.fromkeys(keywords), **required)
    except TypeError as error:
        raise ContractFailure(
            did=f"{who} was called as ({given})",
            got=f"{describe(error)} (its signature is {signature})",
            expected="a signature that takes these arguments",
            fix="change the signature; parameters of the user come after '*'",
        ) from error


@check("default-construction", kinds=FACTORIES, gate=True)
def _default_construction(subject: Subject) -> None:
    """A user who writes the name alone gets the component with its defaults."""
    texts = [p.name for p in declared(subject) if p.required and p.type is str]
    if texts and not has_example(subject):
        raise ContractFailure(
            did="its parameters were looked at",
            got=f"a text that must be given, '{texts[0]}', and nobody can guess what it should say",
            expected="a default, or an example",
            fix="give it a default, or write a static method example() that returns a dict of"
            " parameters to try it with (moseg_core.components.protocols)",
        )
    try:
        _made(subject)
    except (Skip, ContractFailure):
        raise
    except FAULTS as error:
        raise ContractFailure(
            did=f"{subject.component.spec.target} was made from its defaults",
            got=describe(error),
            expected=f"the {subject.component.kind}",
            fix="give every parameter a default that works; leave work that needs more than the"
            " kind is given to the first call",
        ) from error


@check("protocol-answered", kinds=FACTORIES, gate=True)
def _protocol_answered(subject: Subject) -> None:
    """The search asks for these attributes and methods without looking first."""
    kind = subject.component.kind
    made, protocol = _made(subject), getattr(protocols, kind.capitalize())
    if not isinstance(made, protocol):
        names = sorted(name for name in dir(protocol) if not name.startswith("_"))
        missing = [name for name in names if not hasattr(made, name)]
        raise ContractFailure(
            did=f"the {kind} was made",
            got=f"a {type(made).__name__} without {', '.join(missing) or 'a way to call it'}",
            expected=f"all that moseg_core.components.protocols.{protocol.__name__} lists",
            fix="add what is missing",
        )
    methods = dict(vars(protocol))
    if isinstance(made, protocols.ClippableParameterization):
        methods |= vars(protocols.ClippableParameterization)
    for name, method in methods.items():
        if inspect.isfunction(method) and (name == "__call__" or not name.startswith("_")):
            _, *arguments = inspect.signature(method).parameters.values()
            named = [p.name for p in arguments if p.kind is p.KEYWORD_ONLY]
            plain = [p.name for p in arguments if p.name not in named]
            _binds(getattr(made, name), plain, named, who=f"{type(made).__name__}.{name}")


def _made(subject: Subject) -> Any:
    """The component as the core makes it, on a small shape where it needs one."""
    trial, kind = Trial(subject=subject), subject.component.kind
    if kind == "parameterization":
        return trial.make(lump(), 3)
    if kind == "optimizer":
        return optimizer_on(trial)
    if kind == "constraint":
        return next(constraints_on(trial, twin()))[1]
    evaluates = kind in ("seeder", "labeler", "refiner")
    return trial.make(meets=(evaluator_on(lump(), 3) if evaluates else lump(),))


# -- The bundle -------------------------------------------------------------------------------

HEAVY = frozenset(
    (
        *("numpy", "scipy", "numba", "sympy", "pandas", "polars", "h5py", "networkx"),
        *("torch", "tensorflow", "jax", "sklearn", "PIL", "skimage", "cv2", "matplotlib"),
        *("trimesh", "igl", "open3d", "vtk", "pyvista", "pymeshlab"),
    )
)
"""Packages that take long to import."""


@check("bundle-imports-light", kinds=ALL)
def _bundle_imports_light(subject: Subject) -> None:
    """Every command imports the modules of all bundles, only to say what is installed."""
    if subject.component.distribution == NOT_INSTALLED:
        raise Skip("no bundle brings it yet")
    name = subject.component.bundle
    module = next(b.module for b in subject.registry.bundles if b.name == name)
    heavy, failure, _ = _imports(module, tuple(path or os.getcwd() for path in sys.path))
    if failure or heavy:
        raise ContractFailure(
            did=f"'{module}' was imported by itself, and its hooks were called",
            got=failure or f"imports of {', '.join(heavy)}",
            expected="no error, and no import that takes long",
            fix="name components as texts, 'package.module:Name'; let this module and its"
            " package's __init__ import nothing but moseg_core and what is light",
        )


def bundle_import(module: str) -> tuple[str, str]:
    """What importing a bundle's module printed, and what it changed of the process."""
    return _imports(module, tuple(path or os.getcwd() for path in sys.path))[2]


_IMPORT = """
import importlib, json, sys
sys.path[:] = json.loads(sys.argv[2])
from moseg_core.components.process_state import AT_IMPORT, changed, look, told
before, state = set(sys.modules), look(AT_IMPORT)
module = importlib.import_module(sys.argv[1])
for name in dir(module):
    if isinstance(getattr(getattr(module, name), "moseg_impl", None), dict):
        getattr(module, name)()
new = sorted({name.partition(".")[0] for name in set(sys.modules) - before})
print("\\n" + json.dumps([new, told(changed(state))]), file=sys.__stdout__)
"""


@lru_cache(maxsize=64)
def _imports(module: str, path: tuple[str, ...]) -> tuple[list[str], str, tuple[str, str]]:
    """Heavy packages that importing a bundle's module imports, what went wrong, and on the side.

    The last is what it printed, and what it changed of the process.
    """
    done = subprocess.run(
        [sys.executable, "-c", _IMPORT, module, json.dumps(path)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, IN_TRIAL: "1"},
    )
    *printed, last = done.stdout.strip().splitlines() or [""]
    if done.returncode or not last:
        said = (done.stderr.strip().splitlines() or ["it ended"])[-1]
        return [], said, ("", "")
    loaded, changes = json.loads(last)
    said = " ".join(" ".join([*printed, done.stderr]).split())
    return sorted(set(loaded) & HEAVY), "", (said, changes)
