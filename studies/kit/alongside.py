"""An asynchronous generator that runs in a thread of its own, seen as an ordinary one."""

import asyncio
import threading
from collections.abc import AsyncGenerator, Generator, Iterator
from contextlib import aclosing, contextmanager
from queue import SimpleQueue
from typing import TypeVar

T = TypeVar("T")


def alongside(answers: AsyncGenerator[T, None]) -> Generator[T, None, None]:
    """Yield what an asynchronous generator yields; it goes on while the caller is busy.

    It is closed when this generator is, and what it raises is raised here after its last answer.
    """
    handed: SimpleQueue[tuple[T] | None] = SimpleQueue()

    async def hand_over() -> None:
        try:
            async with aclosing(answers):
                async for answer in answers:
                    handed.put((answer,))
        finally:
            handed.put(None)

    with _event_loop() as loop:
        task = asyncio.run_coroutine_threadsafe(hand_over(), loop)
        while one := handed.get():
            yield one[0]
        task.result()


@contextmanager
def _event_loop() -> Iterator[asyncio.AbstractEventLoop]:
    """Run an event loop in a thread; what still runs there at the end is cancelled."""
    runner = asyncio.Runner()
    loop = runner.get_loop()

    def serve() -> None:
        with runner:
            loop.run_forever()

    thread = threading.Thread(target=serve, name="cluster", daemon=True)
    thread.start()
    try:
        yield loop
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
