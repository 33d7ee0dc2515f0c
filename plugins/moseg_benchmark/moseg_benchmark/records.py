"""Cases on disk: what was asked, what came out, and the labels found.

A search takes minutes, so a later run takes over the results of an earlier one. A number means
something only beside all that it depends on: the model's files, what the recipe says, how names
were matched, and the versions of whatever had a part in it. All of that is written beside the
result (:func:`asked_of`), and a result is taken over only where all of it is the same.
"""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import json
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import Any

from moseg_benchmark.cases import BenchmarkCase, CaseResult
from moseg_benchmark.label_matching import IntArray
from moseg_benchmark.lessons import LearnedCase
from moseg_benchmark.psb import Model
from moseg_core import (
    MosegError,
    Recipe,
    __version__,
    load_recipe,
    read_labels,
    registry,
    save_labels,
    write_file,
)

#: What bundles compute with, where it is installed.
_LIBRARIES = ("numpy", "scipy", "numba", "libigl", "manifold3d")


def asked_of(case: BenchmarkCase) -> dict[str, Any]:
    """All that the result of a case depends on, but for what its key says.

    Parameters
    ----------
    case : BenchmarkCase

    Returns
    -------
    dict
        Plain data, equal for two cases exactly if they ask for the same: ``model``, a digest of
        its files; ``naming``; ``statement``, that of the recipe, or None without one;
        ``versions`` of moseg, of this bundle and of the numerical libraries, and the distribution
        in which each component that the recipe uses comes, and each measure that is installed. Of
        a learned recipe also ``learner`` and ``examples``, digests of their files, and the
        distribution of every component that is installed.

    Raises
    ------
    UsageError, PluginError
        The recipe uses something that is not installed.
    """
    asked: dict[str, Any] = {
        "model": _digest_of(case.model),
        "naming": {name: list(kinds) for name, kinds in case.naming.belongs_to.items()},
        "statement": None if case.recipe is None else case.recipe.statement.document(),
        "versions": _versions(case),
    }
    if isinstance(case, LearnedCase):
        asked["learner"] = case.learner
        asked["examples"] = [_digest_of(model) for model in case.examples]
    return asked


def _digest_of(model: Model) -> str:
    return _digest([model.mesh, *model.people, *([model.names] if model.names else [])])


def _versions(case: BenchmarkCase) -> dict[str, str]:
    """Of all code that may have a part in a result, by component or distribution."""
    versions = {"moseg": __version__, "moseg-benchmark": metadata.version("moseg-benchmark")}
    for library in _LIBRARIES:
        with contextlib.suppress(metadata.PackageNotFoundError):
            versions[library] = metadata.version(library)
    # Any objective or constraint may ask a part for a measure of any bundle, and none says which.
    versions |= {c.id: c.distribution for c in registry().components("measure")}
    if case.recipe is not None:
        for task in case.recipe.hierarchies():
            versions |= task.versions
    if isinstance(case, LearnedCase):  # nobody knows what a learner's recipe will use
        versions |= {f"{c.kind} {c.id}": c.distribution for c in registry().components()}
    return versions


def _digest(paths: Iterable[Path]) -> str:
    """Hexadecimal digest of what is in files."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


@dataclasses.dataclass(frozen=True)
class Records:
    """A folder with a ``.json`` file for each case, and a ``.seg`` file where there are labels.

    What was learned for a case is a ``.toml`` file.

    Parameters
    ----------
    folder : Path
    """

    folder: Path

    def write(self, case: BenchmarkCase, result: CaseResult, labels: IntArray | None) -> None:
        """Keep what a case came to.

        Raises
        ------
        MosegError
            The disk is full, or the folder not writable.
        """
        if labels is not None:
            save_labels(labels, self._labels_path(case))
        record = {
            "asked": asked_of(case),
            "labels": None if labels is None else _digest([self._labels_path(case)]),
            "row": dataclasses.asdict(result),
        }
        write_file(self._record_path(case), (json.dumps(record, indent=1) + "\n").encode())

    def result(self, case: BenchmarkCase) -> CaseResult | None:
        """What an equal case came to in an earlier run.

        Parameters
        ----------
        case : BenchmarkCase

        Returns
        -------
        CaseResult or None
            None where there is no result without a failure, the files are damaged, or anything
            that was asked was something else (:func:`asked_of`).
        """
        try:
            record = json.loads(self._record_path(case).read_bytes())
            asked, result = record["asked"], case.read_result(record["row"])
            # The labels are written first: a run that ended between the two leaves another's.
            whole = not case.searches or _digest([self._labels_path(case)]) == record["labels"]
        except (OSError, ValueError, KeyError, TypeError):  # none, cut short or changed by hand
            return None
        if not whole or (result.failure and result.cost is None):
            return None
        return result if asked == asked_of(case) else None

    def labels(self, case: BenchmarkCase) -> IntArray | None:
        """The labels that a case found; None where their file is missing or damaged."""
        try:
            path = self._labels_path(case)
            return read_labels(path, path.read_bytes().count(b"\n")).labels
        except (MosegError, OSError):
            return None

    def write_recipe(self, case: LearnedCase, recipe: Recipe) -> None:
        """Keep what was learned for a case.

        Raises
        ------
        MosegError
            The disk is full, or the folder not writable.
        """
        write_file(self._recipe_path(case), recipe.toml().encode())

    def recipe(self, case: BenchmarkCase) -> Recipe | None:
        """The recipe of a case, that was learned for it; None where there is none, or no more."""
        if not isinstance(case, LearnedCase):
            return case.recipe
        try:
            return load_recipe(str(self._recipe_path(case)))
        except MosegError:
            return None

    def _recipe_path(self, case: LearnedCase) -> Path:
        return self.folder / f"{case.lesson_key}.toml"

    def _record_path(self, case: BenchmarkCase) -> Path:
        return self.folder / f"{case.key}.json"

    def _labels_path(self, case: BenchmarkCase) -> Path:
        return self.folder / f"{case.key}.seg"
