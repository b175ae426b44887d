"""A client of a Dask scheduler, with a time limit on every question that it asks.

Dask is imported only here and on a worker, and only when a cluster is named. Whether the
connection is encrypted, and whom it trusts, is Dask's own configuration
(`distributed.comm.tls`), as on the scheduler and the workers.
"""

import asyncio
import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from studies.kit.arguments import BadInputError
from studies.kit.refusing import one_line
from studies.kit.worker import START, fitness, unfit

if TYPE_CHECKING:
    from distributed import Client, Security

CONNECT_S = 10.0
"""How long to wait for the scheduler, and for a first worker [s]."""
ANSWER_S = 60.0
"""How long to wait for any other answer [s]; a worker may have to import this project first."""
CLOSE_S = 1.0
"""How long to wait for the scheduler to see a client off [s]."""
ENCRYPTED = ("tls", "wss")
"""Schemes of addresses that need certificates."""
CERTIFICATES = (
    "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, ..._TLS__CLIENT__CERT and ..._TLS__CLIENT__KEY, "
    "or distributed.comm.tls in Dask's configuration"
)


class ClusterError(BadInputError):
    """A cluster that cannot be used; the message is one line that says why."""

    def __init__(self, address: str, problem: str) -> None:
        super().__init__(f"--cluster is {address!r}; {problem}")


@contextmanager
def client_of(address: str) -> Iterator["Client"]:
    """Connect to a cluster whose workers run this very version.

    Raises
    ------
    ClusterError
        If Dask is not installed, no scheduler answers in time, there is no worker, or one is unfit.
    """
    try:
        from distributed import utils
    except ImportError:
        raise ClusterError(address, "it needs Dask: pip install 'rocking[cluster]'") from None
    _silence()
    runner = utils.LoopRunner()
    runner.start()
    try:
        try:
            client = utils.sync(runner.loop, _connected, address, callback_timeout=CONNECT_S)
        except ClusterError:
            raise
        except Exception as error:
            # whoever listens there may have said anything
            problem = f"it must be the address of a running Dask scheduler ({_reason(error)})"
            raise ClusterError(address, problem) from None
        try:
            _refuse_unfit(client, address)
            yield client
        finally:
            utils.sync(runner.loop, _close, client)
    finally:
        runner.stop()


def workers_of(client: "Client", address: str) -> list[str]:
    """Return the addresses of the present workers.

    Raises
    ------
    ClusterError
        If the scheduler has gone or does not answer.
    """
    if client.status != "running":
        raise gone(address)
    try:
        return list(client.sync(client.nthreads, callback_timeout=ANSWER_S))
    except TimeoutError:
        raise ClusterError(address, f"its scheduler was silent for {ANSWER_S:g} s") from None
    except OSError:
        raise gone(address) from None


def gone(address: str) -> ClusterError:
    """Return the error of a scheduler that ended."""
    return ClusterError(address, "its scheduler has gone")


def _silence() -> None:
    """Let nobody but this project tell the user what happens to the cluster."""
    for name in logging.root.manager.loggerDict:
        if name.partition(".")[0] in ("distributed", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


async def _connected(address: str) -> "Client":
    from distributed import Client, Security

    security = Security()
    await _knock(address, security)
    client = Client(
        address, security=security, asynchronous=True, timeout=CONNECT_S, set_as_default=False
    )
    try:
        await client
        return client
    except BaseException:
        await _close(client)
        raise


async def _knock(address: str, security: "Security") -> None:
    """Raise ClusterError unless a scheduler answers, or whatever Dask raises."""
    from distributed.comm.addressing import get_address_host_port
    from distributed.comm.core import connect
    from distributed.core import send_recv

    # Dask itself would try again and again where nobody listens
    _, writer = await asyncio.open_connection(*get_address_host_port(address, strict=True))
    writer.close()
    arguments = security.get_connection_args("client")
    if address.partition("://")[0] in ENCRYPTED and arguments["ssl_context"] is None:
        raise ClusterError(address, f"it needs certificates; set {CERTIFICATES}")
    comm = await connect(address, timeout=CONNECT_S, **arguments)
    try:
        kind = (await send_recv(comm, op="identity"))["type"]
    finally:
        comm.abort()
    if kind != "Scheduler":
        raise ClusterError(address, f"it must be the address of a scheduler, not of a {kind}")


async def _close(client: "Client") -> None:
    with suppress(OSError):
        await client.close(timeout=CLOSE_S)


def _reason(error: Exception) -> str:
    if isinstance(error, TimeoutError):
        return f"no answer within {CONNECT_S:g} s"
    if isinstance(error, MemoryError):
        return "what answers there does not speak Dask's protocol"
    return one_line(error)


def _refuse_unfit(client: "Client", address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=CONNECT_S)
    except TimeoutError:
        raise ClusterError(address, f"it has no workers; start one with {START}") from None
    except OSError:
        raise gone(address) from None
    workers = workers_of(client, address)
    for worker, problem in zip(workers, client.sync(_problems_of, client, workers), strict=True):
        if problem:
            raise ClusterError(address, f"its worker {worker} cannot be used: {problem}")


async def _problems_of(client: "Client", workers: Sequence[str]) -> list[str]:
    """Ask all workers at once why they must not run jobs, on the client's own event loop."""
    return await asyncio.gather(*(_problem_of(client, worker) for worker in workers))


async def _problem_of(client: "Client", worker: str) -> str:
    """Ask a worker why it must not run jobs; an empty string if it may."""
    try:
        async with asyncio.timeout(ANSWER_S):
            found = await client.run(unfit, fitness(), workers=[worker], on_error="return")
    except TimeoutError:
        return f"no answer within {ANSWER_S:g} s"
    except OSError as error:
        return one_line(error)
    problem = found[worker]
    if isinstance(problem, ModuleNotFoundError):
        return f"{problem.name} is not installed there"
    return one_line(problem) if isinstance(problem, Exception) else str(problem)
