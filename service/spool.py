"""Request bodies: in memory while they are small, otherwise in a temporary file that vanishes with the request."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from tempfile import SpooledTemporaryFile

from anyio.to_thread import run_sync

MEMORY = 16 * 2**20  # bytes of one body in memory
PIECE = 2**20  # bytes written and read at a time


class Spool:
    """The bytes of a body, to be read any number of times."""

    def __init__(self) -> None:
        # closed by whoever made the spool, when the answer has been sent
        self.file = SpooledTemporaryFile(max_size=MEMORY)  # noqa: SIM115
        self.size = 0

    async def fill(self, chunks: AsyncIterator[bytes]) -> None:
        """Append what arrives; the event loop never waits for the disk."""
        waiting = bytearray()
        async for chunk in chunks:
            waiting += chunk
            if len(waiting) >= PIECE:
                await self._append(bytes(waiting))
                waiting.clear()
        await self._append(bytes(waiting))

    async def _append(self, data: bytes) -> None:
        self.size += len(data)
        if self.size > MEMORY:
            await run_sync(self.file.write, data)
        else:
            self.file.write(data)

    def pieces(self) -> Iterator[bytes]:
        """All of it, from the start."""
        self.file.seek(0)
        while piece := self.file.read(PIECE):
            yield piece

    def read(self) -> bytes:
        """All of it at once."""
        self.file.seek(0)
        return self.file.read()

    def close(self) -> None:
        """Forget the bytes."""
        self.file.close()
