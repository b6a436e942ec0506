"""Request bodies: in memory while they are small, otherwise in a temporary file that vanishes with the request."""

from __future__ import annotations

import io
import os
from collections.abc import AsyncIterator, Iterator
from tempfile import SpooledTemporaryFile
from typing import IO, Any

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

    def reader(self) -> IO[bytes]:
        """A file with a position of its own, from the start: a request that took too long may still read another."""
        if isinstance(self._file, io.BytesIO):
            return io.BytesIO(self._file.getvalue())
        self.flush()
        return io.BufferedReader(_OnDisk(os.dup(self.fileno())), PIECE)

    def pieces(self) -> Iterator[bytes]:
        """All of it, from the start."""
        with self.reader() as file:
            while piece := file.read(PIECE):
                yield piece


class _OnDisk(io.RawIOBase):
    """A file read by position, with a descriptor of its own."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor, self._position = descriptor, 0

    def readable(self) -> bool:
        """Yes."""
        return True

    def seekable(self) -> bool:
        """Yes."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move this reader; others of the file stay."""
        self._position = offset + (0, self._position, os.fstat(self._descriptor).st_size)[whence]
        return self._position

    def readinto(self, buffer: Any) -> int:
        """Read at this reader's place."""
        count = os.preadv(self._descriptor, [buffer], self._position)
        self._position += count
        return count

    def close(self) -> None:
        """Give this reader's descriptor up."""
        if not self.closed:
            os.close(self._descriptor)
        super().close()
