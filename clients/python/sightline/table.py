"""Reading FlatBuffers that nobody has verified.

Python's flatbuffers package has no verifier and follows offsets wherever they lead. This reader checks every
offset before it follows it, and alignment as the C++ verifier does, so that both ends refuse the same frames.
Fields are asked for by their slot: their position in the table of the schema, counted from 0, unions twice.
"""

import struct

import numpy as np

from .errors import ProtocolError

_U16 = struct.Struct("<H")
_U32 = struct.Struct("<I")
_I32 = struct.Struct("<i")


class Buffer:
    """The bytes of one frame. Every read is inside them or raises ProtocolError."""

    def __init__(self, frame):
        self.bytes = bytes(frame)

    def need(self, position, size, alignment, what):
        if position < 0 or position + size > len(self.bytes):
            raise ProtocolError(f"{what}: points outside the frame")
        if position % alignment:
            raise ProtocolError(f"{what}: not aligned")

    def read(self, scalar, position, what):
        self.need(position, scalar.size, scalar.size, what)
        return scalar.unpack_from(self.bytes, position)[0]

    def root(self, identifier):
        self.need(0, 8, 4, "header")
        if self.bytes[4:8] != identifier:
            raise ProtocolError(f"header: not a {identifier.decode()} buffer")
        return self.table_at(_U32.unpack_from(self.bytes, 0)[0], "root")

    def table_at(self, position, what):
        return Table(self, position, what)


class Table:
    """A table whose vtable has been checked."""

    def __init__(self, buffer, position, what):
        self.buffer, self.position, self.what = buffer, position, what
        self.vtable = position - buffer.read(_I32, position, what)
        size = buffer.read(_U16, self.vtable, what + ": vtable")
        if size % 2 or size < 4:
            raise ProtocolError(f"{what}: vtable of {size} bytes")
        buffer.need(self.vtable, size, 2, what + ": vtable")
        self.slot_count = size // 2 - 2

    def at(self, slot):
        """Where the field lies in the buffer; None when it is absent."""
        if slot >= self.slot_count:
            return None
        offset = _U16.unpack_from(self.buffer.bytes, self.vtable + 4 + 2 * slot)[0]
        return self.position + offset if offset else None

    def scalar(self, slot, scalar, default, what):
        position = self.at(slot)
        return default if position is None else self.buffer.read(scalar, position, what)

    def struct(self, slot, size, alignment, what):
        """The bytes of a struct; None when absent."""
        position = self.at(slot)
        if position is None:
            return None
        self.buffer.need(position, size, alignment, what)
        return self.buffer.bytes[position : position + size]

    def target(self, slot, what):
        """Where what the field points at begins; None when absent."""
        position = self.at(slot)
        if position is None:
            return None
        offset = self.buffer.read(_U32, position, what)
        if offset == 0:
            raise ProtocolError(f"{what}: points at itself")
        return position + offset

    def table(self, slot, what):
        target = self.target(slot, what)
        return None if target is None else self.buffer.table_at(target, what)

    def vector(self, slot, element_size, alignment, what):
        """The bytes of a vector's elements; empty when absent."""
        target = self.target(slot, what)
        if target is None:
            return b""
        count = self.buffer.read(_U32, target, what)
        begin, size = target + 4, count * element_size
        self.buffer.need(begin, size, 1, what)
        if begin % alignment:
            raise ProtocolError(f"{what}: not aligned")
        return self.buffer.bytes[begin : begin + size]

    def text(self, slot, what):
        """The bytes of a string; empty when absent."""
        target = self.target(slot, what)
        if target is None:
            return b""
        count = self.buffer.read(_U32, target, what)
        self.buffer.need(target + 4, count + 1, 1, what)
        if self.buffer.bytes[target + 4 + count] != 0:
            raise ProtocolError(f"{what}: no zero at its end")
        return self.buffer.bytes[target + 4 : target + 4 + count]

    def structs(self, slot, dtype, what):
        """A list of structs as a numpy array of `dtype`; read-only, empty when absent."""
        return np.frombuffer(self.vector(slot, dtype.itemsize, dtype.alignment, what), dtype)
