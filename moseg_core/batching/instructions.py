"""What is to be done with each shape of a batch, as plain data.

Instructions are made once, checked once, before any shape is looked at, and sent to wherever shapes
are segmented: so they are written as JSON, and read again over there. Whatever would be wrong with
every shape (a misspelled name, a malformed expression, an impossible option) is found by
:meth:`Instructions.check`, and refused at once.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from functools import lru_cache
from pathlib import Path
from typing import Any

from moseg_core.components.chosen import Choice
from moseg_core.errors import UsageError
from moseg_core.io.part_files import PartForm
from moseg_core.io.reading import Reading
from moseg_core.io.result_loading import load_template
from moseg_core.problem.call_limit import check_limit
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.label_sets import LabelSet
from moseg_core.problem.settings import CHOSEN_KINDS, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.alignment import Template
from moseg_core.search.clipped_result import check_clipping
from moseg_core.search.levels import check_hierarchy
from moseg_core.search.number_of_parts import numbers_to_try
from moseg_core.search.variants import check_variants
from moseg_core.untrusted.regular_file import read_regular_file

#: What JSON says as it is, as far as parameters are made of it.
_JSON = (str, int, float, list)


@dataclass(frozen=True, kw_only=True)
class EarlierResult:
    """A saved result of another shape, from which all searches of a batch start.

    Parameters
    ----------
    path : str
        An absolute path.
    digest : str
        Hexadecimal, of the file: with another result the batch is another one.

    Examples
    --------
    >>> EarlierResult.at(Path("none.json"))
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: 'none.json' cannot be read: No such file or directory
    """

    path: str
    digest: str

    @classmethod
    def at(cls, path: Path) -> EarlierResult:
        """The one at a path."""
        try:
            data = read_regular_file(path)
        except OSError as error:
            raise UsageError(f"'{path}' cannot be read: {error.strerror or error}") from error
        return cls(path=os.path.abspath(path), digest=hashlib.sha256(data).hexdigest())

    def template(self) -> Template:
        """What it says of other shapes.

        Raises
        ------
        UsageError
            The file is no result, or another one than it was.
        ShapeError
            Its shape is not found.
        """
        return _template(self)


@lru_cache(maxsize=1)
def _template(earlier: EarlierResult) -> Template:
    """What a result says of other shapes; remembered for the next shape of the batch."""
    if EarlierResult.at(Path(earlier.path)) != earlier:
        raise UsageError(f"'{earlier.path}' has changed since the batch began; begin another one")
    return load_template(Path(earlier.path))


@dataclass(frozen=True, kw_only=True)
class Instructions:
    """What is to be done with each shape.

    Parameters
    ----------
    statement : Statement
        What to look for.
    sets : tuple of tuple of str, optional
        Label sets to choose among, where they are not all that the statement's labels stand for.
    n_parts : int, str or None
        How many parts there are, or "auto", for a statement that leaves their number open.
    options : SearchOptions
        How to search. The number of processes is always one: a batch has its own.
    reading : Reading
        How to read a shape.
    clip : bool
        Whether boundaries are clipped.
    form : PartForm
        What is written of single parts.
    start_from : EarlierResult or None
        Where all searches start: what another shape came to, laid onto each.
    term_timeout : float or None
        Seconds that a call of an objective may take.

    Examples
    --------
    >>> stated = Statement(labels=("a", "b"), minimize="narrow(a)")
    >>> given = Instructions(statement=stated, options=SearchOptions(seed=3, seeder="kmeans"))
    >>> Instructions.read(given.document()) == given
    True
    """

    statement: Statement
    sets: tuple[LabelSet, ...] | None = None
    n_parts: int | str | None = None
    options: SearchOptions = field(default_factory=SearchOptions)
    reading: Reading = field(default_factory=Reading)
    clip: bool = False
    form: PartForm = field(default_factory=PartForm)
    start_from: EarlierResult | None = None
    term_timeout: float | None = None

    def document(self) -> dict[str, Any]:
        """The same as plain data, for JSON.

        Raises
        ------
        UsageError
            A component that is not installed, which no other process could find.
        """
        default = SearchOptions()
        options: dict[str, Any] = {}
        for option in fields(self.options):
            value = getattr(self.options, option.name)
            if option.name == "workers" or value == getattr(default, option.name):
                continue
            if isinstance(value, Choice):
                if value.target is not None:
                    raise UsageError(
                        f"{option.name} '{value.name}' is not installed, and the processes of a"
                        f" batch could not find it; make a bundle of it, see 'moseg plugin new'"
                    )
                value = _plain(value)
            options[option.name] = value
        return {
            "statement": _exact(self.statement),
            "sets": None if self.sets is None else [list(names) for names in self.sets],
            "n_parts": self.n_parts,
            "options": options,
            "reading": self.reading.document(),
            "clip": self.clip,
            "form": {f.name: getattr(self.form, f.name) for f in fields(self.form)},
            "start_from": None if self.start_from is None else asdict(self.start_from),
            "term_timeout": self.term_timeout,
        }

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> Instructions:
        """Inverse of :meth:`document`."""
        sets = document["sets"]
        return cls(
            statement=Statement.read(document["statement"]),
            sets=None if sets is None else tuple(map(tuple, sets)),
            n_parts=document["n_parts"],
            options=SearchOptions(**document["options"]),
            reading=Reading.of(document["reading"]),
            clip=document["clip"],
            form=PartForm(**document["form"]),
            start_from=EarlierResult(**earlier) if (earlier := document["start_from"]) else None,
            term_timeout=document["term_timeout"],
        )

    def text(self) -> str:
        """The same as one line of JSON."""
        return json.dumps(self.document(), allow_nan=False)

    def problems(self) -> tuple[Hierarchy, ...]:
        """All problems that may be solved for a shape, one for each label set or number of parts.

        Raises
        ------
        UsageError, PluginError
            As for :class:`moseg_core.Problem`.
        """
        if self.n_parts is None:
            return self.variants().tasks
        numbers = numbers_to_try(self.statement, self.n_parts)
        return tuple(Hierarchy.of(self.statement.with_parts(number)) for number in numbers)

    def variants(self) -> Variants:
        """The label sets, with names looked up; only where the number of parts is not open."""
        found = Variants.of(self.statement, self.sets)
        if self.start_from is None:
            return found
        return found.having(self.start_from.template().labels, "--start-from", exactly=True)

    def check(self) -> None:
        """Refuse what would be wrong with every shape.

        Raises
        ------
        UsageError, PluginError
            As for :func:`moseg_core.segment`, shapes apart.
        """
        self.document()
        check_limit(self.term_timeout)
        if self.start_from is not None and self.n_parts is not None:
            raise UsageError(
                "--start-from speaks of single labels, but with --parts these get their numbers at"
                " the end, by size; give --labels and --minimize, or a recipe with fixed labels"
            )
        tasks = self.problems()
        if self.n_parts is None:
            check_variants(self.variants(), self.options)
        else:
            for task in tasks:
                check_hierarchy(task, self.options)
        if self.clip:
            check_clipping(tasks, self.options)

    def components(self) -> dict[str, str]:
        """Ids of the components that take part, each with the distribution that it is of."""
        found: dict[str, str] = {}
        for task in self.problems():
            for _, level in task.levels():
                problem = level.problem
                settled = self.options.settled(level.search)
                found |= problem.versions
                for kind in CHOSEN_KINDS:
                    choice = getattr(settled, kind)
                    if choice is not None:
                        component = choice.component(kind, problem.registry)
                        found[component.id] = component.distribution
        return dict(sorted(found.items()))


def _exact(statement: Statement) -> dict[str, Any]:
    """A statement as plain data, parameters of its components in the order that they are given in.

    :meth:`Statement.document` has them sorted; a result tells them as they are.
    """
    document = statement.document()
    chosen = {key: getattr(statement.search, key) for key in CHOSEN_KINDS}
    for key, choice in {**chosen, "embedding": statement.embedding}.items():
        if isinstance(choice, Choice):
            document[key] = _plain(choice)
    if statement.parts:
        document["parts"] = {label: _exact(part) for label, part in statement.parts}
    return document


def _plain(choice: Choice) -> str | dict[str, Any]:
    """A component as plain data: a table, which knows lists; or text, which knows targets."""
    values = choice.parameters.values()
    if "name" in choice.parameters or not all(isinstance(value, _JSON) for value in values):
        return str(choice)
    return {"name": choice.name, **choice.parameters}
