"""What a problem with counted labels means for each of its label sets.

A statement whose labels have counts (:mod:`moseg_core.problem.label_sets`) is about the members of
a kind of shape that differ: a cow with horns or without. For one label set it becomes a *closed*
statement, like any that was written for that member alone (:func:`closed_statements`):

- a call loses the labels that the statement declares and this set lacks; a glob stands for what is
  there. A term whose call is left with fewer labels than its objective takes is left out:
  ``similar(horn*)`` where there is one horn, ``touching(head, tail)`` where there is no tail;
- a constraint on such a label is left out, one that is meant for each of several labels loses it;
- so are problems for parts that are not there, and what a parameter of the parameterization says of
  their labels (``voronoi(centers="tail=2")``).

A label that is declared nowhere is the mistake that it always is. All of them together, with names
looked up, are :class:`Variants`; :mod:`moseg_core.search.variants` finds out which a shape has.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import cast

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import Registry, registry
from moseg_core.components.discovery.specs import ParameterizationSpec
from moseg_core.errors import ExpressionError, UsageError, unknown
from moseg_core.language import Argument, Term, parse, parse_call
from moseg_core.problem.binding import check_count, chosen_labels, find_objective, matched_labels
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.label_sets import LabelSet, read_label, set_text
from moseg_core.problem.statement import Statement


@dataclass(frozen=True, eq=False, kw_only=True)
class Variants:
    """The problems that a statement stands for, one for each label set.

    Parameters
    ----------
    statement : Statement
        As it was asked for.
    tasks : tuple of Hierarchy
        One where no label has a count.
    """

    statement: Statement
    tasks: tuple[Hierarchy, ...]

    @classmethod
    def of(
        cls,
        statement: Statement,
        sets: Sequence[Sequence[str]] | None = None,
        *,
        source: Registry | None = None,
    ) -> Variants:
        """Those of a statement, or of some label sets that it declares; all names looked up.

        Raises
        ------
        UsageError, PluginError
            As for :func:`closed_statements` and :class:`moseg_core.Problem`.

        Examples
        --------
        >>> stated = Statement(labels=("top", "leg{3..4}"), minimize="flat(top) + narrow(leg*)")
        >>> [len(task.labels) for task in Variants.of(stated).tasks]
        [4, 5]
        """
        closed = closed_statements(statement, sets, source=source)
        return cls(
            statement=statement,
            tasks=tuple(Hierarchy.of(each, registry=source) for each in closed),
        )

    @property
    def texts(self) -> tuple[str, ...]:
        """The label set of each, in counts: ``torso, leg{4}``."""
        labels = self.statement.labels
        return tuple(set_text(task.problem.labels, labels) for task in self.tasks)

    @property
    def short_texts(self) -> tuple[str, ...]:
        """What tells each from the others: ``leg{4}, no tail``.

        Examples
        --------
        >>> stated = Statement(labels=("top", "leg{3..4}"), minimize="flat(top) + narrow(leg*)")
        >>> Variants.of(stated).short_texts
        ('leg{3}', 'leg{4}')
        """
        if len(self.tasks) == 1:
            return self.texts
        found: list[list[str]] = [[] for _ in self.tasks]
        for label in self.statement.labels:
            words = [set_text(task.problem.labels, [label]) for task in self.tasks]
            if len(set(words)) > 1:
                for own, word in zip(found, words, strict=True):
                    own.append(word or f"no {read_label(label).stem}")
        return tuple(map(", ".join, found))

    def having(self, names: Iterable[str], why: str, *, exactly: bool = False) -> Variants:
        """Those whose label sets have certain labels.

        Parameters
        ----------
        names : iterable of str
        why : str
            What names them, for the message: "--pin".
        exactly : bool
            Whether they may have no others.

        Raises
        ------
        UsageError
            An unknown label, or no label set has all of these.
        """
        wanted = set(names)
        known = [name for task in self.tasks for name in task.problem.labels]
        for name in sorted(wanted):
            if name not in known:
                raise UsageError(f"{why}: {unknown('label', name, list(dict.fromkeys(known)))}")
        left = tuple(
            task
            for task in self.tasks
            if (wanted == set(task.problem.labels) if exactly else wanted <= {*task.problem.labels})
        )
        if not left:
            only = "just " if exactly else ""
            raise UsageError(
                f"{why}: no label set has {only}the labels {', '.join(sorted(wanted))}; there are"
                f" {'; '.join(self.texts)}"
            )
        return replace(self, tasks=left)

    def fitting(self, names: Iterable[str]) -> Hierarchy:
        """The problem for a labelling that has certain names.

        Parameters
        ----------
        names : iterable of str
            Labels of the whole.

        Returns
        -------
        Hierarchy
            Of the label set that has just these; else of the smallest that has them and others;
            where there is none, that of these labels alone.

        Raises
        ------
        UsageError
            A label that the statement does not declare, with the nearest.
        """
        wanted = set(names)
        declared = self.statement.declared
        for name in sorted(wanted):
            if name not in declared:
                raise UsageError(unknown("label", name, declared))
        able = [task for task in self.tasks if wanted <= set(task.problem.labels)]
        if able:
            return min(able, key=lambda task: len(task.problem.labels))
        own = [tuple(name for name in declared if name in wanted)]
        return Variants.of(self.statement, own, source=self.tasks[0].registry).tasks[0]


def closed_statements(
    statement: Statement,
    sets: Sequence[Sequence[str]] | None = None,
    *,
    source: Registry | None = None,
) -> tuple[Statement, ...]:
    """The closed statements that a statement with counted labels stands for.

    Parameters
    ----------
    statement : Statement
    sets : sequence of sequence of str, optional
        Other label sets than the statement's own, of labels that it declares.
    source : Registry, optional
        Where to look for objectives and constraints; everything installed by default.

    Returns
    -------
    tuple of Statement
        One for each label set, in the order of :meth:`Statement.label_sets`; the statement itself
        where no label has a count.

    Raises
    ------
    ExpressionError
        An unknown name, with the nearest, or a call with too few labels in every set.
    UsageError
        Malformed labels, or a label set for which nothing is left to minimise.

    Examples
    --------
    >>> stated = Statement(
    ...     labels=("body", "leg{1..2}", "tail{0..1}"),
    ...     minimize="narrow(leg*) + similar(leg*) + perpendicular(body, tail)",
    ... )
    >>> [closed.minimize for closed in closed_statements(stated)][1:3]
    ['narrow(leg*) + perpendicular(body, tail)', 'narrow(leg*) + similar(leg*)']
    """
    if not statement.has_counts and sets is None:
        return (statement,)
    own = registry() if source is None else source
    chosen = statement.label_sets() if sets is None else [tuple(names) for names in sets]
    return tuple(_closed(statement, names, own) for names in chosen)


def parameterization_of(
    choice: Choice, names: Sequence[str], declared: Sequence[str], source: Registry
) -> Choice | None:
    """A parameterization without what it says of labels that are not there.

    Parameters
    ----------
    choice : Choice
    names : sequence of str
        The labels that are there.
    declared : sequence of str
        All labels that there may be.
    source : Registry

    Returns
    -------
    Choice or None
        None where nothing else was said than parameters about such labels.

    Examples
    --------
    >>> chosen = Choice("voronoi", {"centers": "body=2,tail=2"})
    >>> str(parameterization_of(chosen, ["body"], ["body", "tail"], registry()))
    'voronoi(centers="body=2")'
    """
    spec = cast(ParameterizationSpec, choice.component("parameterization", source).spec)
    parameters = dict(choice.parameters)
    for key in spec.label_parameters:
        text = parameters.get(key)
        if not isinstance(text, str):
            continue
        items = text.split(",")
        kept = [
            item
            for item in items
            if _stands_for(pattern := item.partition("=")[0].strip(), names)
            or not _stands_for(pattern, declared)
        ]
        if len(kept) < len(items):
            del parameters[key]
            parameters |= {key: ",".join(kept)} if kept else {}
    if parameters == choice.parameters:
        return choice
    return replace(choice, parameters=parameters) if parameters else None


def _stands_for(pattern: str, names: Sequence[str]) -> bool:
    """Whether a label or glob is one of some names, or matches one."""
    return any(fnmatch.fnmatchcase(name, pattern) for name in names)


def _closed(statement: Statement, names: LabelSet, source: Registry) -> Statement:
    """The statement for one label set."""
    declared = statement.declared
    minimize = _minimize(statement.minimize, names, declared, source)
    constraints = (_constraint(c, names, declared, source) for c in statement.constraints)
    search = statement.search
    if isinstance(search.parameterization, Choice):
        own = parameterization_of(search.parameterization, names, declared, source)
        search = replace(search, parameterization=own)
    return replace(
        statement,
        labels=names,
        variants=(),
        minimize=minimize,
        constraints=tuple(text for text in constraints if text is not None),
        search=search,
        parts=tuple(
            (key, part)
            for key, part in statement.parts
            if _stands_for(key, names) or not _stands_for(key, declared)
        ),
    )


def _minimize(text: str, names: LabelSet, declared: LabelSet, source: Registry) -> str:
    """An expression without what it says of labels that are not there."""
    expression = parse(text)
    found = [_term(term, text, names, declared, source) for term in expression.terms]
    terms = tuple(term for term in found if term is not None)
    if not terms:
        raise UsageError(
            f"of '{text}' nothing is left to minimise for the labels {', '.join(names)}; add a"
            f" term about them, or leave this label set out"
        )
    return text if terms == expression.terms else str(replace(expression, terms=terms))


def _term(
    term: Term, text: str, names: LabelSet, declared: LabelSet, source: Registry
) -> Term | None:
    """A term about the labels that are there; None where these are too few."""
    _, _, target = find_objective(term, text, declared, {}, source)
    chosen = [declared[k] for k in chosen_labels(term, text, declared)]
    arity = target.traits.arity
    fewest = {"global": 0, "unary": 1}.get(arity, target.traits.least)
    if arity == "global" or len(chosen) < fewest:
        check_count(term, text, target, len(chosen))
    if sum(label in names for label in chosen) < fewest:
        return None
    return _with(term, _present(term, text, names, declared))


def _constraint(text: str, names: LabelSet, declared: LabelSet, source: Registry) -> str | None:
    """A constraint about the labels that are there; None where it needs one that is not."""
    call = parse_call(text, labels=True)
    chosen_labels(call, text, declared)
    kept = _present(call, text, names, declared)
    if kept == call.arguments:
        return text
    try:
        factory = source.find("constraint", call.name).load()
    except UsageError as error:
        raise ExpressionError(str(error), text, *call.span) from error
    # What is meant for each of several labels goes on for those that are there.
    missing = [argument for argument in call.arguments if argument not in kept]
    each = getattr(factory, "each", False)
    if not kept or (not each and not all(argument.is_glob for argument in missing)):
        return None
    return str(_with(call, kept))


def _present(call: Term, text: str, names: LabelSet, declared: LabelSet) -> tuple[Argument, ...]:
    """The arguments that stand for labels which are there."""
    return tuple(
        argument
        for argument in call.arguments
        if any(declared[k] in names for k in matched_labels(argument, text, declared))
    )


def _with(call: Term, arguments: tuple[Argument, ...]) -> Term:
    return call if arguments == call.arguments else replace(call, arguments=arguments)
