"""What a bundle says of the components it brings: one small typed record each.

A spec names a component and says where it is, as a string ``"package.module:Name"`` that is
resolved on first use. So listing what is installed imports no component, and a broken one is
noticed when somebody asks for it, not before.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

NAME = re.compile(r"[a-z][a-z0-9_]*\Z")
_SUFFIX = re.compile(r"\.[^A-Z\s/]+\Z")
TARGET = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*\Z")

Kind = Literal[
    "objective",
    "measure",
    "field",
    "parameterization",
    "seeder",
    "labeler",
    "optimizer",
    "refiner",
    "constraint",
    "embedding",
    "learner",
    "recipe",
    "reader",
    "writer",
    "command",
]

Requirement = Literal["volume", "adjacency", "surface"]
"""What a component can ask of a shape; see :class:`moseg_core.Traits`."""

Invariance = Literal["rigid", "scale", "reflection", "order", "tessellation", "labels"]
"""What can leave the values of a component unchanged; see :class:`moseg_core.Traits`."""


#: What can leave the value of an element unchanged; which part it is in plays no role.
_OF_ELEMENTS = tuple(word for word in get_args(Invariance) if word != "labels")


@dataclass(frozen=True, kw_only=True)
class Spec:
    """A component of any kind.

    Parameters
    ----------
    name : str
        Lower-case letters, digits and ``_``; the user says ``name`` or ``bundle:name``.
    target : str
        ``"package.module:Name"``, the function or class that implements it.
    summary : str
        One line for ``moseg plugin list``.

    Raises
    ------
    ValueError
        A malformed name or target. The core sets the bundle aside with this message.

    Examples
    --------
    >>> ObjectiveSpec(name="narrow", target="moseg_objectives_basic.proportions:narrow").kind
    'objective'
    """

    kind: ClassVar[Kind]

    name: str
    target: str
    summary: str = ""

    def __post_init__(self) -> None:
        if not NAME.match(self.name):
            raise ValueError(
                f"{self.kind} name {self.name!r} is not made of lower-case letters, digits and _"
            )
        if not TARGET.match(self.target):
            raise ValueError(
                f"target {self.target!r} of {self.kind} '{self.name}' is not of the form"
                f" 'package.module:Name'"
            )


class ObjectiveSpec(Spec):
    """An objective: target is a :class:`~moseg_core.components.protocols.Objective`."""

    kind = "objective"


@dataclass(frozen=True, kw_only=True)
class MeasureSpec(Spec):
    """A measure of a part: target is a function of a part and its own parameters.

    Parameters
    ----------
    keep : bool
        Whether values outlive the part, in the run's bounded memo. False for large objects,
        such as a search tree, that only help to compute other measures of the same part.
    requires : tuple of {"volume", "adjacency", "surface"}
        What the shape must have. Others are refused by name before the search, where the
        objective says which measures it takes (:class:`moseg_core.Traits`), else when it does.

    Raises
    ------
    ValueError
        Another requirement.
    """

    kind = "measure"

    keep: bool = True
    requires: tuple[Requirement, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_words(self, "requires", self.requires, get_args(Requirement))


@dataclass(frozen=True, kw_only=True)
class FieldSpec(Spec):
    """A number for each element: target is a function of a shape and the field's own parameters.

    Parameters
    ----------
    requires : tuple of {"volume", "adjacency", "surface"}
        What the shape must have; others are refused by name before the search.
    invariant_to : tuple of str
        What leaves the value of an element unchanged: "rigid" motions, uniform "scale",
        "reflection", the "order" of the elements, their "tessellation" within a tolerance.

    Raises
    ------
    ValueError
        Another requirement or invariance.

    Examples
    --------
    >>> FieldSpec(name="height", target="my_package.fields:height", requires=("volumes",))
    Traceback (most recent call last):
        ...
    ValueError: field 'height' requires 'volumes'; known are volume, adjacency, surface
    """

    kind = "field"

    requires: tuple[Requirement, ...] = ()
    invariant_to: tuple[Invariance, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_words(self, "requires", self.requires, get_args(Requirement))
        _check_words(self, "is invariant to", self.invariant_to, _OF_ELEMENTS)


@dataclass(frozen=True, kw_only=True)
class ParameterizationSpec(Spec):
    """A family of segmentations: target makes a ``Parameterization``.

    Parameters
    ----------
    label_parameters : tuple of str
        Those of its parameters, texts, that speak of labels by name. Where parts are segmented in
        their turn, they are about the first level only, as other levels have other labels.
    requires : tuple of {"volume", "adjacency", "surface"}
        What the shape must have; others are refused by name before the search.

    Raises
    ------
    ValueError
        Another requirement.
    """

    kind = "parameterization"

    label_parameters: tuple[str, ...] = ()
    requires: tuple[Requirement, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_words(self, "requires", self.requires, get_args(Requirement))


@dataclass(frozen=True, kw_only=True)
class SeederSpec(Spec):
    """An initial placement of centres: target makes a ``Seeder``.

    Parameters
    ----------
    takes_centers : bool
        Whether it places them where the user says, in a parameter ``centers``, a text such as
        ``--centers`` takes. They are places on one shape, so that such a seeder is about the first
        level only where parts are segmented in their turn.
    """

    kind = "seeder"

    takes_centers: bool = False


class LabelerSpec(Spec):
    """An assignment of labels: target makes a :class:`~moseg_core.components.protocols.Labeler`."""

    kind = "labeler"


class OptimizerSpec(Spec):
    """A search: target makes a :class:`~moseg_core.components.protocols.Optimizer`."""

    kind = "optimizer"


class RefinerSpec(Spec):
    """A mover of boundaries: target makes a :class:`~moseg_core.components.protocols.Refiner`."""

    kind = "refiner"


class ConstraintSpec(Spec):
    """A rule for centres: target makes a :class:`~moseg_core.components.protocols.Constraint`."""

    kind = "constraint"


class EmbeddingSpec(Spec):
    """A deformation of shapes: target makes an ``Embedding``."""

    kind = "embedding"


class LearnerSpec(Spec):
    """A way to learn recipes: target is a function of examples that returns a Recipe.

    Examples are a sequence of :class:`moseg_core.Example`; keyword-only arguments are parameters.
    """

    kind = "learner"


class CommandSpec(Spec):
    """A command of ``moseg``: target is a function whose signature says what options it takes.

    Its docstring is the help, in the form of the core's own commands (:mod:`moseg_core.cli.app`).
    It prints, and raises the errors of :mod:`moseg_core.errors` to end with their exit codes.

    A command that has commands of its own, ``moseg NAME DEED``, is a :class:`cyclopts.App` instead,
    with a function of this kind for each deed.
    """

    kind = "command"


class RecipeSpec(Spec):
    """A named problem: target is ``"package.module:NAME"``, the text of a TOML recipe."""

    kind = "recipe"


@dataclass(frozen=True, kw_only=True)
class ReaderSpec(Spec):
    """A file format for shapes: target is a function of a path that returns a Shape.

    Parameters
    ----------
    suffixes : tuple of str
        Lower case, with the dot: ``(".off",)``.
    example : str, optional
        ``"package.module:name"`` of a function of one of the suffixes that returns the contents
        of a small file, as bytes, or None: what the contract kit tries the reader on.
    labels : str, optional
        ``"package.module:name"`` of a function of a path and a shape that returns what the file
        says of the shape's labels, a :class:`moseg_core.Labelling`: of formats that bear labels.
    """

    kind = "reader"

    suffixes: tuple[str, ...]
    example: str = ""
    labels: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_suffixes(self.suffixes, self)
        for what, target in (("example", self.example), ("labels", self.labels)):
            if target and not TARGET.match(target):
                raise ValueError(
                    f"{what} {target!r} of reader '{self.name}' is not of the form"
                    f" 'package.module:name'"
                )


@dataclass(frozen=True, kw_only=True)
class WriterSpec(Spec):
    """A file format for results: target is a function of a Result that returns bytes.

    A format of several files returns a mapping of names to bytes instead. The names are those of
    files beside, or in folders below, the one that was asked for; that one is among them. A
    writer that takes ``name`` by keyword is told what it is called: ``"horse.obj"``. One that takes
    ``hull_vertices`` by keyword is told how many vertices a hull may have, where a user says so.

    Parameters
    ----------
    suffixes : tuple of str
        Lower case, with the dot: ``(".glb",)``.
    """

    kind = "writer"

    suffixes: tuple[str, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_suffixes(self.suffixes, self)


def _check_words(spec: Spec, verb: str, given: tuple[str, ...], known: tuple[str, ...]) -> None:
    """Refuse words that are not known, and a text where a tuple of them is meant."""
    for word in (given,) if isinstance(given, str) else given:
        if word not in known or isinstance(given, str):
            raise ValueError(
                f"{spec.kind} '{spec.name}' {verb} {word!r}; known are {', '.join(known)}"
                + (", in a tuple" if isinstance(given, str) else "")
            )


def _check_suffixes(suffixes: tuple[str, ...], spec: Spec) -> None:
    if isinstance(suffixes, str) or not suffixes or not all(map(_SUFFIX.match, suffixes)):
        raise ValueError(
            f"suffixes {suffixes!r} of {spec.kind} '{spec.name}' are not a tuple of lower-case"
            f" suffixes such as '.off'"
        )
