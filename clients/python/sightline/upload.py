"""Carrying a scene to a daemon that does not have it: offer, send what is missing, wait until it is ready.

An upload belongs to the scene's digest and not to the connection, so after a reconnect the offer is made again and
the answer says which chunks need not be sent.
"""

import struct

import numpy as np

from . import roaring
from .checks import CHUNK_BYTES
from .errors import ProtocolError
from .messages import SceneChunk, SceneState
from .wire import encode, field_places

_OFFER_AGAIN_S = 2.0  # of quiet, in case a status got lost


class Upload:
    """One scene to one daemon. Nothing here waits."""

    def __init__(self, data):
        self.data = data
        self.chunk_count = len(data.offer.chunk_digests) // 16
        self.chunks_sent = 0  # over all offers, for reports
        self.failures = 0  # of uploads that had begun
        self._frames = _ChunkFrames(data)
        self.begin()

    def begin(self):
        """Nothing is known of what the daemon has."""
        self.state, self.text = None, ""
        self.chunks_held = 0
        self._missing = []  # taken from the end
        self._offered = False  # and not yet answered
        self._quiet_since_s = 0.0

    @property
    def progress(self):
        """Share of the scene that the daemon says it has."""
        return 1.0 if self.state in (SceneState.BUILDING, SceneState.READY) else self.chunks_held / self.chunk_count

    @property
    def sending(self):
        return bool(self._missing)

    def offer(self, link, now_s):
        self._offered = True
        self._quiet_since_s = now_s
        return link.send(encode(self.data.offer))

    def take_status(self, message, now_s):
        """Whether it is worth going on, or beginning anew."""
        had_begun = self.state is not None
        self.state, self.text, self._quiet_since_s = message.state, message.text, now_s
        if message.state == SceneState.UPLOADING:
            self.chunks_held = message.chunks_held
            if message.held or self._offered:
                self._missing = self._not_in(message.held)
            self._offered = False
            return True
        self._missing, self._offered = [], False
        if message.state == SceneState.FULL:
            return True  # step offers again
        if message.state == SceneState.READY:
            self.failures = 0
        if message.state != SceneState.FAILED:
            return True
        # Once more, where it had begun: the daemon may have been started anew amid the chunks.
        self.failures += 1
        return had_begun and self.failures == 1

    def _not_in(self, held):
        held = roaring.read(held) if held else np.zeros(0, np.uint32)
        if len(held) and held[-1] >= self.chunk_count:
            raise ProtocolError("held: a chunk that the scene does not have")
        return np.setdiff1d(np.arange(self.chunk_count), held, assume_unique=True)[::-1].tolist()

    def step(self, link, now_s):
        """Queues what the connection takes."""
        while self._missing:
            index = self._missing[-1]
            if not link.send(self._frames.of(index)):
                return
            self._missing.pop()
            self.chunks_sent += 1
            self._quiet_since_s = now_s
        if now_s - self._quiet_since_s > _OFFER_AGAIN_S:
            self.offer(link, now_s)


class _ChunkFrames:
    """Frames of chunks. All but the last are as long: one is written field by field, then its number and bytes are
    replaced in place, which leaves an upload to the speed of copying."""

    def __init__(self, data):
        self._data, self._frame, self._size = data, None, 0

    def of(self, index):
        """Valid until the next call."""
        chunk = memoryview(self._data.bytes)[index * CHUNK_BYTES : (index + 1) * CHUNK_BYTES]
        if len(chunk) != self._size:
            # Not number 0, which would be left out.
            self._frame = bytearray(encode(SceneChunk(self._data.digest, 1, bytes(chunk))))
            self._size = len(chunk)
            places = field_places(self._frame)
            self._index_at, self._bytes_at = places["index"], places["bytes"]
        struct.pack_into("<I", self._frame, self._index_at, index)
        self._frame[self._bytes_at : self._bytes_at + self._size] = chunk
        return self._frame
