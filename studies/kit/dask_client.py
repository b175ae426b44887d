"""A client of a Dask scheduler, with a time limit on every question that it asks.

Dask is imported only here and on a worker, and only when a cluster is named. Whether the
connection is encrypted, and whom it trusts, is Dask's own configuration
(`distributed.comm.tls`), as on the scheduler and the workers.
"""

import asyncio
import logging
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Any, TypeAlias

from studies.kit.arguments import BadInputError
from studies.kit.refusing import one_line
from studies.kit.worker import START, fitness, unfit

if TYPE_CHECKING:
    from distributed import Security

AsyncClient: TypeAlias = Any
"""A Dask client whose methods are coroutines; Dask's annotations are those of the other kind."""

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


@asynccontextmanager
async def client_of(address: str) -> AsyncGenerator[AsyncClient, None]:
    """Connect to a cluster whose workers run this very version.

    Raises
    ------
    ClusterError
        If Dask is not installed, no scheduler answers in time, there is no worker, or one is unfit.
    """
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise ClusterError(address, "it needs Dask: pip install 'rocking[cluster]'") from None
    _silence()
    try:
        async with asyncio.timeout(CONNECT_S):
            client = await _connected(address)
    except ClusterError:
        raise
    except Exception as error:
        # whoever listens there may have said anything
        problem = f"it must be the address of a running Dask scheduler ({_reason(error)})"
        raise ClusterError(address, problem) from None
    try:
        await _refuse_unfit(client, address)
        yield client
    finally:
        await _close(client)


async def workers_of(client: AsyncClient, address: str) -> list[str]:
    """Return the addresses of the present workers.

    Raises
    ------
    ClusterError
        If the scheduler has gone or does not answer.
    """
    if client.status != "running":
        raise gone(address)
    try:
        async with asyncio.timeout(ANSWER_S):
            return list(await client.nthreads())
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


async def _connected(address: str) -> AsyncClient:
    from distributed import Client, Security

    security = Security()
    await _knock(address, security)
    client = Client(
        address, security=security, asynchronous=True, timeout=CONNECT_S, set_as_default=False
    )
    try:
        await client
    except BaseException:
        await _close(client)
        raise
    return client


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


async def _close(client: AsyncClient) -> None:
    with suppress(OSError):
        await client.close(timeout=CLOSE_S)


def _reason(error: Exception) -> str:
    if isinstance(error, TimeoutError):
        return f"no answer within {CONNECT_S:g} s"
    if isinstance(error, MemoryError):
        return "what answers there does not speak Dask's protocol"
    return one_line(error)


async def _refuse_unfit(client: AsyncClient, address: str) -> None:
    try:
        async with asyncio.timeout(CONNECT_S):
            await client.wait_for_workers(1)
    except TimeoutError:
        raise ClusterError(address, f"it has no workers; start one with {START}") from None
    except OSError:
        raise gone(address) from None
    workers = await workers_of(client, address)
    problems = await asyncio.gather(*(_problem_of(client, worker) for worker in workers))
    for worker, problem in zip(workers, problems, strict=True):
        if problem:
            raise ClusterError(address, f"its worker {worker} cannot be used: {problem}")


async def _problem_of(client: AsyncClient, worker: str) -> str:
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
