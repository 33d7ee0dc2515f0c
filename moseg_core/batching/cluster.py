"""Many machines: the jobs of a batch done by the workers of a Dask cluster.

Dask's executor (``distributed.Client.get_executor``) is given the same jobs as a thread pool, and
:func:`~moseg_core.batching.running.run_job` guards a child process over there as it does here. So
no shape can take a worker of the cluster along; where one is lost all the same, because its machine
is switched off, Dask gives its jobs to the others.

Jobs carry paths: all machines see the files under the same paths, as on a network drive. All have
the same versions installed, which each worker says before the first job is handed out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from moseg_core.batching.running import end_children
from moseg_core.batching.versions import difference, own_versions
from moseg_core.errors import UsageError

#: Seconds within which a scheduler has to answer.
_TO_CONNECT = 20.0


@contextmanager
def cluster_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """The workers of a Dask cluster as an executor; their child processes are ended at the end.

    Parameters
    ----------
    address : str
        Of the scheduler, such as ``"tcp://10.0.0.5:8786"``.

    Yields
    ------
    executor : concurrent.futures.Executor
    count : int
        How many jobs its workers do at a time.

    Raises
    ------
    UsageError
        Dask is not installed; nobody answers; there are no workers; or some have other versions
        than this computer.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> with moseg.cluster_executor("tcp://10.0.0.5:8786") as (executor, count):  # doctest: +SKIP
    ...     moseg.batch(["*.off"], "fourleg", "out", executor=executor, workers=count)
    """
    distributed = _distributed()
    try:
        client = distributed.Client(address, timeout=_TO_CONNECT, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise UsageError(
            f"no Dask scheduler answers at '{address}' ({said:.200}); give the address that"
            f" 'dask scheduler' prints, such as tcp://10.0.0.5:8786"
        ) from error
    with client:
        threads: Mapping[str, int] = client.nthreads()
        if not threads:
            raise UsageError(
                f"the cluster at '{address}' has no workers; start some: dask worker {address}"
            )
        _check_versions(client.run(own_versions, on_error="return"))
        executor = client.get_executor(pure=False)
        try:
            yield executor, sum(threads.values())
        finally:
            executor.shutdown(wait=False)  # or what waits there would start children anew
            client.run(end_children, on_error="ignore")


def _check_versions(said: Mapping[str, Any]) -> None:
    """Refuse workers that have other versions than this computer, by their addresses."""
    here = own_versions()
    wrong = []
    for worker, versions in sorted(said.items()):
        if not isinstance(versions, Mapping):  # the error over there: moseg is not installed
            wrong.append(f"worker {worker} cannot say which versions it has ({versions})")
        elif differs := difference(here, versions):
            wrong.append(f"on worker {worker} {differs}")
    if wrong:
        more = f"; and {len(wrong) - 1} more workers likewise" if len(wrong) > 1 else ""
        raise UsageError(
            f"all machines of a batch must have the same versions installed, but {wrong[0]}{more}"
        )


def _distributed() -> ModuleType:
    """Dask's package for clusters, where it is installed."""
    try:
        import distributed
    except ImportError as error:
        raise UsageError(
            "a batch on a cluster needs Dask: pip install 'moseg-core[cluster]'"
        ) from error
    found: ModuleType = distributed
    return found
