"""A Dask cluster of this process: a distributed engine whose messages stay on loopback."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from distributed import Client, LocalCluster

# By default Dask serves HTTP on all interfaces, at port 8787; where that is taken, it warns.
_HTTP = {"dashboard_address": "127.0.0.1:0"}


@contextmanager
def dask_executor(threads: int = 1) -> Iterator[Executor]:
    """Executor of a cluster with one worker of `threads` threads."""
    with (
        LocalCluster(
            n_workers=1,
            threads_per_worker=threads,
            processes=False,
            host="127.0.0.1",
            protocol="tcp",
            dashboard_address=None,
            scheduler_kwargs=_HTTP,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client.get_executor()
