"""One result chosen among several tries: what it tells of the others.

Where something is not known of a shape beforehand, such as how many parts it has
(:mod:`moseg_core.search.number_of_parts`) or which labels
(:mod:`moseg_core.search.variants`), several problems are solved and one result is taken. It is a
result like any other, which remembers what was tried, and why the tries as a whole ended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from moseg_core.search.levels import joint_reason
from moseg_core.search.result import Result, end_warnings


def chosen_among(
    best: Result,
    found: Sequence[Result],
    *,
    failed: bool,
    tried: Mapping[str, tuple[dict[str, float], ...]],
) -> Result:
    """The best of several results, with what was tried and why all of it ended.

    Parameters
    ----------
    best : Result
    found : sequence of Result
        All that were tried, the best among them.
    failed : bool
        Whether an error kept others from being tried.
    tried : mapping of str to tuple of dict
        Further stages for the history.
    """
    reason = "failed" if failed else joint_reason([result.reason for result in found])
    others = (text for text in best.warnings if text not in end_warnings(best.reason))
    return replace(
        best,
        reason=reason,
        warnings=(*end_warnings(reason), *others),
        history={**best.history, **tried},
    )
