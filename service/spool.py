"""Request bodies: in memory while they are small, otherwise in a temporary file that vanishes with the request."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from tempfile import SpooledTemporaryFile

from anyio.to_thread import run_sync

MEMORY = 16 * 2**20  # bytes of one body in memory
PIECE = 2**20  # bytes written and read at a time


class Spool(SpooledTemporaryFile[bytes]):
    """The bytes of a body, to be read any number of times."""

    def __init__(self) -> None:
        super().__init__(max_size=MEMORY)

    async def fill(self, chunks: AsyncIterator[bytes]) -> None:
        """Append what arrives; the event loop never waits for the disk."""
        waiting, size = bytearray(), 0
        async for chunk in chunks:
            size += len(chunk)
            if size <= MEMORY:
                self.write(chunk)
            else:
                waiting += chunk
            if len(waiting) >= PIECE:
                await run_sync(self.write, bytes(waiting))
                waiting.clear()
        if waiting:
            await run_sync(self.write, bytes(waiting))

    def pieces(self) -> Iterator[bytes]:
        """All of it, from the start."""
        self.seek(0)
        while piece := self.read(PIECE):
            yield piece
