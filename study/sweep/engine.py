"""Engines of a sweep: this process, a pool of processes on this machine, or a dask cluster.

Every engine takes the next batch only when the one before was taken over, so that a batch for each worker is all that
is ever computed and not yet kept.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import multiprocessing
import os
import time
import warnings
from collections.abc import Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from importlib.metadata import version
from typing import Any

import numpy as np

from ...core.errors import InputError, MissingPackageError, how_to_install, time_in_words
from ...core.process_settings import (
    THREAD_VARIABLES,
    child_environment,
    children_without_interrupts,
    end_with_parent,
    keep_freed_memory,
)
from .batch_analysis import Batch, Block, analyze_batch
from .sweep_file import PointStatus

#: Times that a batch is begun whose process ends, before its points count as failed.
ATTEMPT_COUNT = 3
CONNECTION_TIME_LIMIT = 20.0  # [s]
#: Packages of which the workers of a cluster must have the same versions as this process.
SAME_VERSIONS = ("easeoff", "dask", "distributed")
#: Between two looks at batches that run, and at the workers of a cluster [s].
POLL_INTERVAL, LOOK_INTERVAL = 0.02, 1.0
#: Time for which a cluster may be without workers [s].
WORKERS_TIME_LIMIT = 600.0
#: What ends a message on a cluster that ends while it computes.
RESUMES = "start it again, and the same sweep with its store goes on"
#: Batches at a time for every thread of a cluster: one that runs and none that waits.
BATCHES_PER_THREAD = 1


def in_this_process(batches: Iterator[Batch]) -> Generator[tuple[int, Block]]:
    """Analyse batches one after the other."""
    for batch in batches:
        yield batch.number, analyze_batch(batch)


def in_processes(batches: Iterator[Batch], workers: int) -> Generator[tuple[int, Block]]:
    """Analyse batches in processes of one BLAS thread each; one that is killed is replaced, its batch begun anew."""
    attempts: dict[int, int] = {}
    again: list[Batch] = []
    while True:
        before = set(multiprocessing.active_children())
        # A fork would inherit threads and half-imported libraries.
        pool = ProcessPoolExecutor(
            workers, mp_context=multiprocessing.get_context("spawn"), initializer=_prepare_worker
        )
        running: dict[Future[Block], Batch] = {}
        try:
            while True:
                while len(running) < workers and (batch := again.pop() if again else next(batches, None)) is not None:
                    again.append(batch)  # until it runs: a pool that is broken takes none
                    with child_environment(dict.fromkeys(THREAD_VARIABLES, "1")), children_without_interrupts():
                        running[pool.submit(analyze_batch, batch)] = again.pop()
                if not running:
                    pool.shutdown()
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    block = future.result()
                    yield running.pop(future).number, block
        except BrokenProcessPool:
            for batch in running.values():
                attempts[batch.number] = attempts.get(batch.number, 0) + 1
            again += [batch for batch in running.values() if attempts[batch.number] < ATTEMPT_COUNT]
            lost = [batch for batch in running.values() if attempts[batch.number] >= ATTEMPT_COUNT]
        finally:
            for process in set(multiprocessing.active_children()) - before:
                process.terminate()
            pool.shutdown(wait=False, cancel_futures=True)
        for batch in lost:
            yield batch.number, _lost(batch)


@contextlib.contextmanager
def cluster_client(address: str) -> Iterator[Any]:
    """Client of the dask cluster with a scheduler such as ``tcp://127.0.0.1:8786``, closed on leaving.

    InputError if there is no scheduler at the address, it has no workers, or these have other versions.
    """
    distributed = distributed_package()
    try:
        with ThreadPoolExecutor(1) as thread:  # a notebook runs a loop of its own in this one
            thread.submit(asyncio.run, _reached(distributed, address)).result()
        client = distributed.Client(address, timeout=CONNECTION_TIME_LIMIT, set_as_default=False)
    except Exception as error:  # of a transport that is not there, too
        raise InputError(
            f"scheduler = {address!r}: must be the address of a dask scheduler that runs ({error})"
        ) from error
    log = logging.getLogger("distributed.client")  # shows a traceback for what is told here in a sentence
    log_level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        try:
            client.wait_for_workers(1, timeout=CONNECTION_TIME_LIMIT)
        except TimeoutError as error:
            raise InputError(
                f"scheduler = {address!r}: has no workers; start some with 'dask worker {address}'"
            ) from error
        _check_versions(client, address)
        yield client
    finally:
        client.close()
        log.setLevel(log_level)


async def _reached(distributed: Any, address: str) -> None:
    """Connect to a scheduler once: a client that cannot, such as for want of a transport, waits for itself."""
    comm = await distributed.comm.connect(address, timeout=CONNECTION_TIME_LIMIT)
    comm.abort()


def _check_versions(client: Any, address: str) -> None:
    """Refuse workers without this package, or with another version of it or of dask."""
    for package in SAME_VERSIONS:
        local_version = version(package)
        for worker, answer in client.run(version, package, on_error="return").items():
            if answer != local_version:
                said = answer if isinstance(answer, str) else f"unknown ({type(answer).__name__}: {answer})"
                raise InputError(
                    f"scheduler = {address!r}: must have workers with {package} {local_version}, as here; that of "
                    f"its worker {worker} is {said}"
                )


def on_cluster(batches: Iterator[Batch], client: Any) -> Generator[tuple[int, Block]]:
    """Analyse batches on a dask cluster.

    InputError if the scheduler is gone, has no workers for `WORKERS_TIME_LIMIT`, or a worker cannot run a batch.
    """
    distributed, address = distributed_package(), client.scheduler.address
    running: dict[Any, Batch] = {}
    results = distributed.as_completed(loop=client.loop, raise_errors=False)
    while True:
        slots = max(BATCHES_PER_THREAD * (_threads(client) or 0), 1)
        while len(running) < slots and (batch := next(batches, None)) is not None:
            future = client.submit(
                analyze_batch, batch, key=f"easeoff-sweep-{os.getpid()}-{id(results)}-{batch.number}"
            )
            running[future.key] = batch
            results.add(future)
        if not running:
            return
        _wait_for_one(results, client, address)
        future = next(results)
        batch = running.pop(future.key)
        if future.status == "finished":
            yield batch.number, future.result()
        elif future.status != "error":  # cancelled or lost, without a reason
            raise InputError(f"scheduler = {address!r}: is gone; {RESUMES}")
        elif isinstance(future.exception(), distributed.KilledWorker):
            yield batch.number, _lost(batch)
        else:
            fault = future.exception()
            raise InputError(
                f"scheduler: a worker of the cluster could not run a batch ({type(fault).__name__}: {fault}); it needs "
                "easeoff of this version"
            )


def _threads(client: Any) -> int | None:
    """Threads of a cluster; None where its scheduler does not answer, which cancels what was asked of it."""
    try:
        return sum(client.nthreads().values()) if client.status == "running" else None
    except (OSError, RuntimeError):
        return None


def _wait_for_one(results: Any, client: Any, address: str) -> None:
    """Wait for the end of a batch, and say what is waited for where there is nobody to compute it."""
    waited = 0.0  # without workers [s]
    looked = time.monotonic()
    while not results.has_ready():
        time.sleep(POLL_INTERVAL)
        passed = time.monotonic() - looked
        if passed < LOOK_INTERVAL:
            continue
        looked = time.monotonic()
        if _threads(client) != 0:
            waited = 0.0
            continue
        if not waited:
            limit = time_in_words(WORKERS_TIME_LIMIT)
            warnings.warn(
                f"scheduler = {address!r}: has no workers any more; waiting {limit} for some, as by 'dask worker "
                f"{address}'; after an interruption the same command goes on",
                stacklevel=2,
            )
        waited += passed
        if waited > WORKERS_TIME_LIMIT:
            raise InputError(f"scheduler = {address!r}: has no workers any more; {RESUMES}")


def distributed_package() -> Any:
    """The package dask.distributed; MissingPackageError if it is not installed."""
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        message = f"dask.distributed is not installed: {how_to_install('easeoff[dask]')}; or run without a scheduler"
        raise MissingPackageError(message) from error


def _lost(batch: Batch) -> Block:
    """Rows of a batch whose process ends whenever it is begun, as for want of memory."""
    shape = (batch.rows.size, *batch.setup.loads)
    reason = f"the process that computed it ended {ATTEMPT_COUNT} times, as for want of memory"
    return Block(batch.rows, np.full(shape, PointStatus.FAILED, np.int8), np.full(shape, reason), {}, "")


def _prepare_worker() -> None:
    """Let this process end with the one that started it, and keep freed memory."""
    keep_freed_memory()
    end_with_parent()
