"""Reading Roaring bitmaps in the portable format, with the checks that docs/protocol.md asks for.

Chambi, Lemire, Kaser, Godin, "Better bitmap performance with Roaring bitmaps", 2016; the format is that of
RoaringFormatSpec. Anything that a conforming writer would not have written raises ProtocolError.
"""

import struct

import numpy as np

from .errors import ProtocolError

_WITHOUT_RUNS = 12346
_WITH_RUNS = 12347  # in the low 16 bits; the high ones hold the container count less one
_MAX_CONTAINERS = 1 << 16
_OFFSETS_FROM = 4  # with runs, fewer containers than this have no offsets
_MAX_ARRAY = 4096
_BITSET_BYTES = 8192


class _Cursor:
    def __init__(self, data):
        self.data, self.position = memoryview(data), 0

    def take(self, size, what):
        if size > len(self.data) - self.position:
            raise ProtocolError(f"bitmap: {what} cut short")
        self.position += size
        return self.data[self.position - size : self.position]

    def words(self, count, dtype, what):
        return np.frombuffer(self.take(count * np.dtype(dtype).itemsize, what), dtype)


def read(data):
    """The members, ascending, as a numpy array of uint32."""
    cursor = _Cursor(data)
    cookie, = struct.unpack("<I", cursor.take(4, "header"))
    runs = b""
    if cookie == _WITHOUT_RUNS:
        count, = struct.unpack("<I", cursor.take(4, "container count"))
        if count > _MAX_CONTAINERS:
            raise ProtocolError("bitmap: more than 65536 containers")
    elif cookie & 0xFFFF == _WITH_RUNS:
        count = (cookie >> 16) + 1
        runs = bytes(cursor.take((count + 7) // 8, "run flags"))
        if runs[-1] >> ((count - 1) % 8 + 1):
            raise ProtocolError("bitmap: run flags of containers that are not there")
    else:
        raise ProtocolError("bitmap: unknown cookie")

    headers = cursor.words(2 * count, "<u2", "container headers")
    keys, cardinalities = headers[0::2], headers[1::2].astype(np.int64) + 1
    offsets = None
    if not runs or count >= _OFFSETS_FROM:
        offsets = cursor.words(count, "<u4", "offsets")
    if np.any(keys[1:] <= keys[:-1]):
        raise ProtocolError("bitmap: container keys not ascending")

    parts = []
    for i in range(count):
        if offsets is not None and offsets[i] != cursor.position:
            raise ProtocolError("bitmap: a container is not where its offset says")
        cardinality = int(cardinalities[i])
        if runs and runs[i // 8] >> (i % 8) & 1:
            low = _read_runs(cursor, cardinality)
        elif cardinality <= _MAX_ARRAY:
            low = _read_array(cursor, cardinality)
        else:
            low = _read_bitset(cursor, cardinality)
        parts.append(low.astype(np.uint32) | np.uint32(int(keys[i]) << 16))
    if cursor.position != len(cursor.data):
        raise ProtocolError("bitmap: bytes after the last container")
    return np.concatenate(parts) if parts else np.zeros(0, np.uint32)


def _read_array(cursor, cardinality):
    values = cursor.words(cardinality, "<u2", "array container")
    if np.any(values[1:] <= values[:-1]):
        raise ProtocolError("bitmap: array container not ascending")
    return values


def _read_bitset(cursor, cardinality):
    bits = np.unpackbits(cursor.words(_BITSET_BYTES, "u1", "bitset container"), bitorder="little")
    values = np.flatnonzero(bits)
    if len(values) != cardinality:
        raise ProtocolError("bitmap: bitset container of another cardinality than its header says")
    return values


def _read_runs(cursor, cardinality):
    run_count, = struct.unpack("<H", cursor.take(2, "run container"))
    if run_count == 0:
        raise ProtocolError("bitmap: run container without runs")
    pairs = cursor.words(2 * run_count, "<u2", "run container").astype(np.int64)
    starts, lasts = pairs[0::2], pairs[0::2] + pairs[1::2]
    if np.any(starts[1:] <= lasts[:-1] + 1):
        raise ProtocolError("bitmap: run container with runs that are unsorted, overlap or touch")
    if lasts[-1] > 0xFFFF:
        raise ProtocolError("bitmap: run container with a run over its end")
    lengths = lasts - starts + 1
    if lengths.sum() != cardinality:
        raise ProtocolError("bitmap: run container of another cardinality than its header says")
    # Every value is its place in the list, moved by what its run begins later than the list does.
    return np.arange(cardinality) + np.repeat(starts - np.cumsum(lengths) + lengths, lengths)
