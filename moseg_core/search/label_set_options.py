"""What the search for a label set is asked to do: in full, briefly, or for its seeds alone.

Options are those of the whole request, and what they and the recipe leave open is shared among the
label sets; :mod:`moseg_core.search.label_set_trial` decides which of them is searched for how.
"""

from __future__ import annotations

from dataclasses import replace

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.parameters import PROVIDED, declared_parameters
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.problem.variants import Variants, parameterization_of
from moseg_core.search.request import prepare_components

#: What a limit on an optimizer's evaluations is called.
_LIMIT = "max_evaluations"


def for_task(options: SearchOptions, task: Hierarchy, variants: Variants) -> SearchOptions:
    """The options for one label set: what they say of labels that it lacks is left out."""
    if not isinstance(options.parameterization, Choice):
        return options
    chosen = parameterization_of(
        options.parameterization,
        task.problem.labels,
        variants.statement.declared,
        task.registry,
    )
    return replace(options, parameterization=chosen)


def shared_starts(task: Hierarchy, options: SearchOptions, count: int) -> Method:
    """How a label set is searched: with its share of the starts, where nobody says how many."""
    if options.restarts is not None or task.search.restarts is not None:
        return task.search
    starts = options.settled(task.search).restarts
    return replace(task.search, restarts=max(1, starts // count))


def seeds_say_enough(task: Hierarchy, options: SearchOptions, count: int) -> bool:
    """Whether label sets can be compared by their seeds, and be searched for from there.

    The seeder is a search in itself, there is one start, and the optimizer can be told to go no
    further.

    Parameters
    ----------
    task : Hierarchy
        Any of the label sets: what they are asked for is the same.
    options : SearchOptions
    count : int
        How many label sets there are.
    """
    settled = options.settled(shared_starts(task, options, count))
    ready = prepare_components(task.problem, settled)
    searches = getattr(ready["seeder"].factory, "searches", False)
    factory, provided = ready["optimizer"].factory, PROVIDED["optimizer"]
    limited = {one.name for one in declared_parameters(factory, reserved=provided)}
    return bool(searches) and settled.restarts == 1 and _LIMIT in limited


def seeds_alone(options: SearchOptions, method: Method, *, coarse: bool) -> SearchOptions:
    """No search beyond seeds, of which the cost is found."""
    settled = options.settled(method)
    parameters = {**settled.optimizer.parameters, _LIMIT: 1}
    return replace(
        options,
        optimizer=replace(settled.optimizer, parameters=parameters),
        resolution="full" if coarse else settled.resolution,
    )


def brief_search(
    options: SearchOptions, method: Method, task: Hierarchy, *, coarse: bool
) -> SearchOptions:
    """A short search: the components that were chosen, with their own parameters, from one start.

    On super-elements there is nothing to polish. Parameters of the parameterization stay: they say
    what is searched for.
    """
    settled = options.over(method).settled()
    optimizer = replace(settled.optimizer, parameters={})
    if coarse:
        ready = prepare(optimizer, "optimizer", task.registry).tuned("default").tuned("coarse")
        optimizer = replace(optimizer, parameters=ready.parameters)
    return replace(
        options,
        parameterization=settled.parameterization,
        seeder=replace(settled.seeder, parameters={}),
        labeler=replace(settled.labeler, parameters={}),
        optimizer=optimizer,
        resolution="full" if coarse else settled.resolution,
        restarts=1,
        finalists=1,
    )
