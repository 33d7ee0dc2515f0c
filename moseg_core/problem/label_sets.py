"""Labels with counts: which sets of labels the members of a kind of shape can have.

The members of a kind differ: an octopus has lost an arm, a chair has arms or none. Labels say so
with counts. ``leg{2..5}`` stands for ``leg1, leg2`` up to ``leg1, ..., leg5``, ``leg{4}`` for four
of them, ``tail{0..1}`` for a ``tail`` or none: a label of which there is one at most bears no
number. All combinations of the counts are *label sets*; where only some of them occur, these are
listed as *variants*, each with the labels of one set (or, with counts, of several).

Nothing is looked up here; :mod:`moseg_core.problem.variants` says what a problem means for a label
set, and :mod:`moseg_core.search.variants` which of them a shape has.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from moseg_core.errors import UsageError, unknown

MOST_SETS = 24
"""The greatest number of label sets that a statement may stand for: each is searched for."""

_MOST_OF_ONE = 999
"""The greatest count of a label."""

LabelSet = tuple[str, ...]
"""Names of labels that go together, in the order in which they are declared."""

_COUNTED = re.compile(r"(\w+)\{\s*(\d+)\s*(?:\.\.\s*(\d+)\s*)?\}\Z", re.ASCII)


@dataclass(frozen=True, kw_only=True)
class CountedLabel:
    """A label, and how many of it there are.

    Parameters
    ----------
    stem : str
        What stands before the count.
    least, most : int
        How many there may be, both included; `most` is 1 or more.

    Examples
    --------
    >>> str(CountedLabel(stem="leg", least=2, most=5)), str(CountedLabel(stem="a", least=1, most=1))
    ('leg{2..5}', 'a')
    """

    stem: str
    least: int
    most: int

    def __str__(self) -> str:
        if self.most == 1:
            return self.stem if self.least else f"{self.stem}{{0..1}}"
        span = str(self.most) if self.least == self.most else f"{self.least}..{self.most}"
        return f"{self.stem}{{{span}}}"

    @property
    def names(self) -> LabelSet:
        """All that it can stand for; the first `k` of them where there are `k`."""
        if self.most == 1:
            return (self.stem,)
        return tuple(f"{self.stem}{k + 1}" for k in range(self.most))


def is_counted(label: object) -> bool:
    """Whether a label has a count.

    Examples
    --------
    >>> [is_counted(label) for label in ("leg{2..5}", "leg{4}", "leg4", "leg*")]
    [True, True, False, False]
    """
    return isinstance(label, str) and _COUNTED.match(label) is not None


def read_label(text: str) -> CountedLabel:
    """A label with or without a count; one without is there once.

    Raises
    ------
    UsageError
        A count that makes no sense, or that runs into the number of the label.

    Examples
    --------
    >>> read_label("leg{2..5}").names
    ('leg1', 'leg2', 'leg3', 'leg4', 'leg5')
    >>> read_label("tail{0..1}").names
    ('tail',)
    """
    match = _COUNTED.match(text)
    if match is None:
        return CountedLabel(stem=text, least=1, most=1)
    # Thousands of digits are no number to Python.
    least, most = (
        int(digits[-4:]) if len(digits.lstrip("0")) < 4 else _MOST_OF_ONE + 1
        for digits in (match[2], match[3] or match[2])
    )
    if max(least, most) > _MOST_OF_ONE:
        raise UsageError(f"'{match[1]}': a label's count is at most {_MOST_OF_ONE}")
    if most < least or most == 0:
        raise UsageError(
            f"'{text}': a count goes from the least to the greatest number, which is 1 or more:"
            f" '{match[1]}{{2..5}}', '{match[1]}{{4}}', '{match[1]}{{0..1}}'"
        )
    if most > 1 and match[1][-1].isdigit():
        raise UsageError(
            f"'{text}': the numbers would run into each other; put a letter or '_' before the count"
        )
    return CountedLabel(stem=match[1], least=least, most=most)


def declared_labels(labels: Sequence[str]) -> LabelSet:
    """All names that labels with counts can stand for.

    Raises
    ------
    UsageError
        A malformed count, or two labels that can stand for the same name.

    Examples
    --------
    >>> declared_labels(["torso", "leg{0..2}", "tail{0..1}"])
    ('torso', 'leg1', 'leg2', 'tail')
    """
    origin: dict[str, str] = {}
    for text in labels:
        for name in read_label(text).names:
            if name in origin:
                by = "" if origin[name] == text == name else f" by '{origin[name]}' and '{text}'"
                raise UsageError(f"label '{name}' is given twice{by}; labels are distinct names")
            origin[name] = text
    return tuple(origin)


def labels_of_variants(variants: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Labels that allow all variants: each with its least and greatest count among them.

    Examples
    --------
    >>> labels_of_variants([["torso", "leg{2}"], ["torso", "leg{4}", "tail"]])
    ('torso', 'leg{2..4}', 'tail{0..1}')
    """
    found: dict[str, CountedLabel] = {}
    for k, variant in enumerate(variants):
        declared_labels(variant)
        read = {label.stem: label for label in map(read_label, variant)}
        for stem, label in read.items():
            before = found.get(stem, replace(label, least=0) if k else label)
            found[stem] = replace(
                label, least=min(before.least, label.least), most=max(before.most, label.most)
            )
        for stem in found.keys() - read.keys():
            found[stem] = replace(found[stem], least=0)
    return tuple(map(str, found.values()))


def label_sets(
    labels: Sequence[str], variants: Sequence[Sequence[str]] = ()
) -> tuple[LabelSet, ...]:
    """The label sets that a problem's labels stand for.

    Parameters
    ----------
    labels : sequence of str
        With or without counts.
    variants : sequence of sequence of str
        The sets that occur, as labels with or without counts; all combinations without any.

    Returns
    -------
    tuple of tuple of str
        Different sets, none of them empty, the names of each in the order of `labels`.

    Raises
    ------
    UsageError
        A malformed count, a variant that `labels` do not allow, or too many sets.

    Examples
    --------
    >>> label_sets(["torso", "leg{1..2}", "tail{0..1}"])[:2]
    (('torso', 'leg1'), ('torso', 'leg1', 'tail'))
    >>> label_sets(["torso", "leg{1..2}"], [["torso", "leg{2}"]])
    (('torso', 'leg1', 'leg2'),)
    """
    declared = [read_label(label) for label in labels]
    names = declared_labels(labels)
    lines = [_line(variant, declared, names) for variant in variants] or [declared]
    count = sum(math.prod(label.most - label.least + 1 for label in line) for line in lines)
    if count > MOST_SETS:
        raise UsageError(
            f"the labels {', '.join(labels)} stand for {count} label sets, more than the"
            f" {MOST_SETS} that can be tried; narrow the counts, or list the sets that occur:"
            f' variants = [["torso", "leg{{4}}"], ["torso", "leg{{4}}", "tail"]]'
        )
    found = [one_set for line in lines for one_set in _combinations(line, declared, names)]
    for one_set in found if variants else ():
        _check_allowed(one_set, declared, labels)
    return tuple(dict.fromkeys(found))


def named_sets(given: Sequence[str], labels: Sequence[str]) -> tuple[LabelSet, ...] | None:
    """The label sets that labels with counts stand for among those that others declare.

    Parameters
    ----------
    given : sequence of str
        With or without counts, which need not be among those of `labels`.
    labels : sequence of str
        What is declared.

    Returns
    -------
    tuple of tuple of str, or None
        None where something is not declared.

    Examples
    --------
    >>> named_sets(["torso", "leg{1}"], ["torso", "leg{2..4}", "tail"])
    (('torso', 'leg1'),)
    >>> named_sets(["torso", "wing"], ["torso", "leg{2..4}"]) is None
    True
    """
    declared, names = [read_label(label) for label in labels], declared_labels(labels)
    try:
        line = _line(given, declared, names)
    except UsageError:
        return None
    return tuple(dict.fromkeys(_combinations(line, declared, names)))


def _combinations(
    line: Sequence[CountedLabel], declared: Sequence[CountedLabel], names: LabelSet
) -> Iterator[LabelSet]:
    """The sets that labels with counts stand for, numbered as the declared ones; none is empty."""
    numbered = {label.stem: label.names for label in declared}
    for counts in itertools.product(*(range(one.least, one.most + 1) for one in line)):
        members: set[str] = set()
        for label, k in zip(line, counts, strict=True):
            members.update(numbered.get(label.stem, label.names)[:k])
        if members:
            yield tuple(name for name in names if name in members)


def set_text(names: Iterable[str], labels: Sequence[str]) -> str:
    """A label set as a user would write it, in the counts of the labels.

    Examples
    --------
    >>> set_text(["torso", "leg1", "leg2"], ["torso", "leg{0..4}", "tail{0..1}"])
    'torso, leg{2}'
    """
    present = set(names)
    words = []
    for label in map(read_label, labels):
        k = len(present.intersection(label.names))
        if k:
            words.append(label.stem if label.most == 1 else f"{label.stem}{{{k}}}")
    return ", ".join(words)


def _line(
    variant: Sequence[str], declared: Sequence[CountedLabel], names: LabelSet
) -> list[CountedLabel]:
    """A variant's labels, each of which must be declared."""
    declared_labels(variant)  # distinct names
    stems = {label.stem: label for label in declared}
    read = [read_label(text) for text in variant]
    for text, label in zip(variant, read, strict=True):
        known = stems.get(label.stem)
        if known is None and not set(label.names) <= set(names):
            raise UsageError(f"variants: {unknown('label', label.stem, [*stems, *names])}")
        if known is not None and label.most > known.most:
            raise UsageError(f"variants: '{text}' is more than the labels allow, '{known}'")
    return read


def _check_allowed(
    members: LabelSet, declared: Sequence[CountedLabel], labels: Sequence[str]
) -> None:
    """Refuse a label set that the counts of the labels do not allow."""
    for label in declared:
        here = tuple(name for name in label.names if name in members)
        if len(here) < label.least or here != label.names[: len(here)]:
            raise UsageError(
                f"variants: '{set_text(members, labels)}' is not allowed by the labels"
                f" {', '.join(labels)}: of '{label}' it has {', '.join(here) or 'none'}; change"
                f" the count, or leave labels out: they follow from the variants"
            )
