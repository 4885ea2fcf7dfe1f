"""Who computes the cases: workers on this machine, or those of Dask on any number of machines. Both are Executors."""

from __future__ import annotations

import os
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any, Callable, Iterator, Mapping

from talus_lab.errors import ResultError, nearest
from talus_lab.sweep.config import QUEUES
from talus_lab.sweep.pool import LocalPool

ENGINES = ("local", "dask")


@dataclass(frozen=True)
class Engine:
    executor: Executor
    workers: Callable[[], int]  # how many there are now


def cores() -> int:
    """That this process may use."""
    return len(os.sched_getaffinity(0))


def engine_of(name: str, workers: int, scheduler: str = "", cluster: Mapping[str, Any] = {}) -> AbstractContextManager[Engine]:
    """Left by an exception, it ends what runs."""
    if name not in ENGINES:
        raise ResultError(f"engine: {name}{nearest(name, ENGINES)}")
    return _dask(workers, scheduler, cluster) if name == "dask" or scheduler else _local(workers)


@contextmanager
def _local(workers: int) -> Iterator[Engine]:
    pool = LocalPool(workers)
    try:
        yield Engine(pool, lambda: workers)
    except BaseException:
        pool.shutdown(cancel_futures=True)
        raise
    pool.shutdown()


@contextmanager
def _dask(workers: int, scheduler: str, cluster: Mapping[str, Any]) -> Iterator[Engine]:
    try:
        import distributed
    except ImportError:
        raise ResultError("the engine dask needs the package distributed: pip install 'talus-lab[dask]'") from None
    if scheduler:
        try:
            client = distributed.Client(scheduler, timeout=10)
        except (OSError, ValueError) as error:
            raise ResultError(f"--scheduler {scheduler}: cannot be reached: {error}") from None
        owned = None
    else:
        owned = _queue(cluster) if cluster else distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        client = distributed.Client(owned)
    try:
        yield Engine(client.get_executor(pure=False), lambda: sum(client.nthreads().values()))
    finally:
        client.close()  # what is left of its calls is not made
        if owned:
            owned.close()


def _queue(cluster: Mapping[str, Any]) -> Any:
    """Jobs of a queueing system that are Dask workers. As many as there is work for: a fixed number would not be made up when some are
    cancelled."""
    options = dict(cluster)
    kind, jobs = options.pop("kind", ""), options.pop("jobs", 1)
    if kind not in QUEUES:
        raise ResultError(f"cluster.kind: is not {kind}{nearest(kind, QUEUES)}")
    try:
        import dask_jobqueue
    except ImportError:
        raise ResultError("the engine dask with a cluster needs the package dask-jobqueue: pip install 'talus-lab[dask]'") from None
    try:
        made = getattr(dask_jobqueue, QUEUES[kind])(**{"cores": 1, "processes": 1, "memory": "2 GB"} | options)
    except (TypeError, ValueError) as error:
        raise ResultError(f"cluster: {str(error).partition('. ')[0]}") from None
    made.adapt(minimum_jobs=0, maximum_jobs=jobs)
    return made
