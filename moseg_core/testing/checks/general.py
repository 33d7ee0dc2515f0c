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
from functools import lru_cache
from typing import Any, get_args

from moseg_core.components.discovery.registry import describe
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.objectives import COST_ORDER, Arity, Invariance, Requirement, Traits
from moseg_core.components.parameters import Parameter
from moseg_core.components.protocols import (
    Constraint,
    Embedding,
    Labeler,
    Objective,
    Optimizer,
    Parameterization,
    Seeder,
)
from moseg_core.problem.recipe import load_recipe
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.drivers import TOYS, constraint_on, evaluator_on, optimizer_on
from moseg_core.testing.fixtures.shapes import specimen
from moseg_core.testing.fixtures.trial import DRIVEN, Trial, declared, has_example

ALL: tuple[Kind, ...] = get_args(Kind)
FACTORIES: tuple[Kind, ...] = tuple(kind for kind in DRIVEN if kind not in ("objective", "measure"))
"""The kinds that are made before they are used."""

#: What each target is called with, by kind: positional arguments, then keyword ones.
_CALLED: dict[Kind, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "measure": (("part",), ()),
    "parameterization": (("shape", "n_parts"), ()),
    "seeder": ((), ()),
    "labeler": ((), ()),
    "optimizer": (("start", "lower", "upper", "scale"), ("rng",)),
    "constraint": (("shape", "labels"), ()),
    "embedding": ((), ()),
    "reader": (("path",), ()),
    "writer": (("result",), ()),
}

_METHODS: dict[Kind, tuple[type, dict[str, tuple[tuple[str, ...], tuple[str, ...]]]]] = {
    "parameterization": (
        Parameterization,
        {
            "labels": (("vectors",), ()),
            "encode": (("centers",), ()),
            "decode": (("vector",), ()),
            "distances": (("vector", "points"), ()),
            "coordinates": (("part",), ()),
            "permute": (("vector", "order"), ()),
        },
    ),
    "seeder": (Seeder, {"__call__": (("evaluator",), ("rng", "report"))}),
    "labeler": (Labeler, {"__call__": (("evaluator", "vector"), ())}),
    "optimizer": (Optimizer, {"ask": ((), ()), "tell": (("costs",), ())}),
    "constraint": (
        Constraint,
        {"expand": (("free", "centers"), ()), "reduce": (("centers",), ())},
    ),
    "embedding": (Embedding, {"__call__": (("shape",), ())}),
}


# -- Found and made ---------------------------------------------------------------------------


@check(
    "target-resolves",
    kinds=ALL,
    gate=True,
    why="a target that names nothing is only noticed by the user who asks for the component",
)
def target_resolves(subject: Subject) -> None:
    """The module imports and has the name."""
    spec = subject.component.spec
    did = f"'{spec.target}' was imported"
    try:
        target = subject.load()
    except Exception as error:  # a stranger's module may raise anything
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


@check(
    "signature-fits",
    kinds=ALL,
    gate=True,
    why="the core calls all components of a kind alike, and reads parameters from the signature",
)
def signature_fits(subject: Subject) -> None:
    """The target takes what its kind is given; an objective declares what it is."""
    kind, target = subject.component.kind, subject.load()
    if kind == "objective":
        _traits_fit(target)
    elif kind == "recipe":
        load_recipe(subject.component.id, source=subject.registry).problem(source=subject.registry)
    if kind in _CALLED:
        _binds(target, *_CALLED[kind], who=f"the target '{subject.component.spec.target}'")
    try:
        declared(subject)
    except TypeError as error:
        raise ContractFailure(
            did="its parameters were read from its signature",
            got=str(error),
            expected="keyword-only arguments annotated as float, int, bool or str",
            fix="annotate them, with moseg_core.Interval for bounds; put what is no parameter of"
            " the user's somewhere else",
        ) from error


def _traits_fit(target: Any) -> None:
    if not isinstance(target, Objective) or not isinstance(target.traits, Traits):
        raise ContractFailure(
            did="its traits and parameters were asked for",
            got=f"a {type(target).__name__} without them",
            expected="an objective",
            fix="decorate the function with @moseg_core.objective(range=...)",
        )
    traits = target.traits
    wrong = ""
    low, high = traits.range
    if traits.arity not in get_args(Arity):
        wrong = f"the arity {traits.arity!r}"
    elif not low < high:
        wrong = f"the range {traits.range}"
    elif traits.cost not in COST_ORDER:
        wrong = f"the cost {traits.cost!r}"
    elif not set(traits.requires) <= set(get_args(Requirement)):
        wrong = f"the requirements {sorted(traits.requires)}"
    elif not set(traits.invariant_to) <= set(get_args(Invariance)):
        wrong = f"the invariances {sorted(traits.invariant_to)}"
    elif not all(isinstance(parameter, Parameter) for parameter in target.parameters):
        wrong = "parameters that are no moseg_core Parameters"
    if wrong:
        raise ContractFailure(
            did="its traits were read",
            got=wrong,
            expected="what moseg_core.components.objectives.Traits describes",
            fix="decorate the function with @moseg_core.objective, which checks them",
        )


def _binds(target: Any, positional: tuple[str, ...], keywords: tuple[str, ...], who: str) -> None:
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


@check(
    "default-construction",
    kinds=FACTORIES,
    gate=True,
    why="a user who writes the name alone gets the component with its defaults",
)
def default_construction(subject: Subject) -> None:
    """It can be made without parameters."""
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
    except Skip:
        raise
    except Exception as error:  # a stranger's component may raise anything
        raise ContractFailure(
            did=f"{subject.component.spec.target} was made from its defaults",
            got=describe(error),
            expected=f"the {subject.component.kind}",
            fix="give every parameter a default that works; leave work that needs more than the"
            " kind is given to the first call",
        ) from error


@check(
    "protocol-answered",
    kinds=FACTORIES,
    gate=True,
    why="the search asks for these attributes and methods without looking first",
)
def protocol_answered(subject: Subject) -> None:
    """What is made has all attributes of its protocol, and methods that take their arguments."""
    kind = subject.component.kind
    protocol, methods = _METHODS[kind]
    made = _made(subject)
    if not isinstance(made, protocol):
        names = sorted(name for name in dir(protocol) if not name.startswith("_"))
        missing = [name for name in names if not hasattr(made, name)]
        raise ContractFailure(
            did=f"the {kind} was made",
            got=f"a {type(made).__name__} without {', '.join(missing) or 'a way to call it'}",
            expected=f"all that moseg_core.components.protocols.{protocol.__name__} lists",
            fix="add what is missing",
        )
    for name, (positional, keywords) in methods.items():
        _binds(getattr(made, name), positional, keywords, who=f"{type(made).__name__}.{name}")


def _made(subject: Subject) -> Any:
    """The component as the core makes it, on a small shape where it needs one."""
    trial = Trial(subject=subject)
    kind = subject.component.kind
    if kind == "parameterization":
        return trial.make(specimen("lump"), 3)
    if kind == "optimizer":
        return optimizer_on(trial, TOYS[0])
    if kind == "constraint":
        return constraint_on(trial, specimen("twin"))[0]
    shape = specimen("lump")
    if kind in ("seeder", "labeler"):
        return trial.make(meets=(evaluator_on(subject, shape),))
    return trial.make(meets=(shape,))


# -- The bundle -------------------------------------------------------------------------------

HEAVY = frozenset(
    (
        "numpy",
        "scipy",
        "numba",
        "trimesh",
        "PIL",
        "igl",
        "pandas",
        "torch",
        "tensorflow",
        "jax",
        "sklearn",
        "skimage",
        "matplotlib",
        "networkx",
        "sympy",
        "open3d",
        "vtk",
        "pyvista",
        "pymeshlab",
        "h5py",
        "cv2",
        "polars",
    )
)
"""Packages that take long to import."""


@check(
    "bundle-imports-light",
    kinds=ALL,
    why="every command imports the modules of all bundles, only to say what is installed",
)
def bundle_imports_light(subject: Subject) -> None:
    """Importing the bundle's module and calling its hooks imports no numerical library."""
    name = subject.component.bundle
    module = next(b.module for b in subject.registry.bundles if b.name == name)
    heavy, failure = _imports(module, tuple(path or os.getcwd() for path in sys.path))
    did = f"'{module}' was imported by itself, and its hooks were called"
    if failure:
        raise ContractFailure(
            did=did,
            got=failure,
            expected="no error",
            fix="let it import nothing but moseg_core and what it can rely on",
        )
    if heavy:
        raise ContractFailure(
            did=did,
            got=f"imports of {', '.join(heavy)}",
            expected="none of them",
            fix="name components as texts, 'package.module:Name', and import nothing heavy in"
            " this module or in its package's __init__",
        )


_IMPORT = """
import json, sys
sys.path[:] = json.loads(sys.argv[2])
before = set(sys.modules)
import importlib
module = importlib.import_module(sys.argv[1])
for name in dir(module):
    if isinstance(getattr(getattr(module, name), "moseg_impl", None), dict):
        getattr(module, name)()
print("\\n" + json.dumps(sorted({name.partition(".")[0] for name in set(sys.modules) - before})))
"""


@lru_cache(maxsize=64)
def _imports(module: str, path: tuple[str, ...]) -> tuple[list[str], str]:
    """Heavy packages that importing a bundle's module imports, and what went wrong."""
    done = subprocess.run(
        [sys.executable, "-c", _IMPORT, module, json.dumps(path)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        return [], (done.stderr.strip().splitlines() or ["it ended"])[-1]
    loaded = set(json.loads(done.stdout.strip().splitlines()[-1]))
    return sorted(loaded & HEAVY), ""
