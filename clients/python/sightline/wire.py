"""Messages to frames and back, straight from docs/protocol.md: no generated code.

One row of FIELDS says how a field lies in its table; its place in the list is its slot. `decode` is safe on
untrusted bytes: whatever they are, it returns a message that keeps the protocol's rules or raises ProtocolError.
"""

import struct
from collections import namedtuple

import flatbuffers
import numpy as np

from . import messages as m
from .checks import MAX_TEXT_BYTES, check
from .errors import ProtocolError
from .table import Buffer

IDENTIFIER = b"SLN1"
MAX_FRAME_BYTES = 64 << 20

Scalar = namedtuple("Scalar", "name code default")
Struct = namedtuple("Struct", "name code optional")  # as a tuple; `optional`: left out when all are zero
Text = namedtuple("Text", "name")
Bytes = namedtuple("Bytes", "name always")  # `always`: written though it is empty
Structs = namedtuple("Structs", "name dtype")

U8, U16, U32, U64, F64, BOOL = "BHIQd?"


def _scalars(code, *names):
    return [Scalar(name, code, False if code == BOOL else 0) for name in names]


DIGEST = Struct("scene_digest", "16s", False)

FIELDS = {
    m.Hello: [*_scalars(U16, "version"), Text("client_name"), DIGEST],
    m.Welcome: [
        *_scalars(U16, "version"), *_scalars(U64, "session_id"), Text("server_name"), Text("engine"),
        *_scalars(U32, "object_count"), Struct("control_size", "II", False), Scalar("filter_length", U32, 1),
        Scalar("heartbeat_interval_s", F64, 1.0), Text("counter"), *_scalars(F64, "threshold", "control_rate_hz"),
        Text("preset"), *_scalars(BOOL, "refine")],
    m.Refusal: [*_scalars(U8, "reason"), Text("text"), *_scalars(U16, "server_version"),
                Struct("server_scene_digest", "16s", False)],
    m.ViewRequest: [
        *_scalars(U64, "session_id", "request_seq"), *_scalars(F64, "for_time_s"), Structs("eyes", m.EYE),
        Struct("main_size", "II", False), *_scalars(F64, "rotation_error_rad", "position_error_m"),
        *_scalars(U64, "acked_set_seq"), *_scalars(BOOL, "reset_filter"), Structs("moves", m.MOVE),
        Structs("boxed", m.BOX), Structs("presence", m.PRESENCE), *_scalars(U8, "view", "view_kind"),
        Struct("control_size", "II", True)],
    m.VisibleSet: [
        *_scalars(U64, "session_id", "set_seq", "request_seq"), *_scalars(F64, "for_time_s"), DIGEST,
        *_scalars(U64, "base_seq"), *_scalars(U32, "visible_count"), Bytes("bitmap", True),
        "times",  # a table of its own
        *_scalars(U32, "drawn_objects"), Bytes("extents_of", False), Bytes("extents", False), *_scalars(U8, "view")],
    m.Ping: [*_scalars(U64, "nonce"), *_scalars(F64, "time_s")],
    m.Pong: [*_scalars(U64, "nonce"), *_scalars(F64, "time_s")],
    m.Goodbye: [*_scalars(U64, "session_id")],
    m.SceneOffer: [*_scalars(U16, "version"), DIGEST, *_scalars(U64, "byte_count"), *_scalars(U32, "object_count"),
                   *_scalars(U64, "triangle_count"), Bytes("chunk_digests", True)],
    m.SceneStatus: [DIGEST, *_scalars(U8, "state"), Text("text"), *_scalars(U32, "chunk_count", "chunks_held"),
                    Bytes("held", False)],
    m.SceneChunk: [DIGEST, *_scalars(U32, "index"), Bytes("bytes", False)],
    m.Why: [*_scalars(U64, "session_id", "nonce"), *_scalars(U8, "view"), *_scalars(U32, "object_id")],
    m.WhyAnswer: [
        *_scalars(U64, "session_id", "nonce"), *_scalars(U8, "view"), *_scalars(U32, "object_id"),
        *_scalars(U64, "request_seq"), *_scalars(U8, "state"), *_scalars(U32, "pixels"),
        *_scalars(F64, "pixels_mean", "threshold"), Structs("hidden_by", m.BLOCKER)],
}
TYPES = list(FIELDS)  # Envelope.body_type is a message's place in it, counted from 1
TIMES = _scalars(F64, *m.TIMES)


# --- reading ---


def decode(frame):
    """The message of one frame. Raises ProtocolError for anything that is not one."""
    if len(frame) > MAX_FRAME_BYTES:
        raise ProtocolError(f"frame: {len(frame)} bytes, at most {MAX_FRAME_BYTES}")
    if len(frame) % 4:
        raise ProtocolError("frame: its length is not a multiple of 4")
    envelope = Buffer(frame).root(IDENTIFIER)
    body_type = envelope.scalar(0, struct.Struct("B"), 0, "body_type")
    if not 1 <= body_type <= len(TYPES):
        raise ProtocolError(f"body_type: {body_type} is unknown")
    body = envelope.table(1, "body")
    if body is None:
        raise ProtocolError("body: absent")
    kind = TYPES[body_type - 1]
    message = kind()
    for slot, field in enumerate(FIELDS[kind]):
        if field == "times":
            message.times = _read_times(body, slot)
        else:
            setattr(message, field.name, _read(body, slot, field))
    check(message)
    return message


def _read(table, slot, field):
    name = field.name
    if isinstance(field, Scalar):
        return table.scalar(slot, struct.Struct("<" + field.code), field.default, name)
    if isinstance(field, Struct):
        layout = struct.Struct("<" + field.code)
        data = table.struct(slot, layout.size, 1 if field.code == "16s" else 4, name)
        values = layout.unpack(bytes(layout.size) if data is None else data)
        return values[0] if len(values) == 1 else values
    if isinstance(field, Text):
        return _clean(table.text(slot, name), name)
    if isinstance(field, Bytes):
        return table.vector(slot, 1, 1, name)
    return table.structs(slot, field.dtype, name)


def _read_times(body, slot):
    table = body.table(slot, "times")
    if table is None:
        return dict.fromkeys(m.TIMES, 0.0)
    return {field.name: _read(table, i, field) for i, field in enumerate(TIMES)}


def _clean(data, name):
    """UTF-8 without control characters, or line breaks that terminals know."""
    if len(data) > MAX_TEXT_BYTES:
        raise ProtocolError(f"{name}: {len(data)} bytes, at most {MAX_TEXT_BYTES}")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        raise ProtocolError(f"{name}: not UTF-8") from None
    if any(is_control(c) for c in text):
        raise ProtocolError(f"{name}: holds control characters")
    return text


def is_control(character):
    code = ord(character)
    return code < 0x20 or 0x7F <= code < 0xA0 or code in (0x2028, 0x2029)


def field_places(frame):
    """Where in a frame of ours each field of its body begins: of a scalar itself, of a list its first element."""
    envelope = Buffer(frame).root(IDENTIFIER)
    body = envelope.table(1, "body")
    fields = FIELDS[TYPES[envelope.scalar(0, struct.Struct("B"), 0, "body_type") - 1]]
    places = {}
    for slot, field in enumerate(fields):
        if field != "times" and body.at(slot) is not None:
            places[field.name] = body.at(slot) if isinstance(field, (Scalar, Struct)) else body.target(slot, "") + 4
    return places


# --- writing ---


def encode(message):
    """One frame. Raises ProtocolError for a message that no peer would take."""
    check(message)
    return encode_unchecked(message)


def encode_unchecked(message):
    """Such as encode, of a message that may break the rules: for tests of a peer."""
    lists = sum(len(value) for value in vars(message).values() if isinstance(value, bytes))
    builder = flatbuffers.Builder(1024 + lists)  # it grows by copying
    body_type = TYPES.index(type(message)) + 1
    body = _write_table(builder, FIELDS[type(message)], message)
    builder.StartObject(2)
    builder.PrependUOffsetTRelativeSlot(1, body, 0)
    builder.PrependUint8Slot(0, body_type, 0)
    builder.Finish(builder.EndObject(), IDENTIFIER)
    return bytes(memoryview(builder.Bytes)[builder.Head() :])


_PREPEND = {U8: "Uint8", U16: "Uint16", U32: "Uint32", U64: "Uint64", F64: "Float64", BOOL: "Bool"}


def _write_table(builder, fields, values):
    """What lies outside the table comes first; then its fields, the largest first, as flatc's own writers do."""
    targets = [_write_target(builder, field, values) for field in fields]
    builder.StartObject(len(fields))
    sizes = [struct.calcsize("<" + field.code) if isinstance(field, Scalar) else 4 for field in fields]
    for size in (8, 4, 2, 1):
        for slot in reversed(range(len(fields))):
            if sizes[slot] == size:
                _write_field(builder, slot, fields[slot], values, targets[slot])
    return builder.EndObject()


def _write_target(builder, field, values):
    if field == "times":
        builder.StartObject(len(TIMES))
        for slot in reversed(range(len(TIMES))):
            builder.PrependFloat64Slot(slot, values.times[TIMES[slot].name], 0.0)
        return builder.EndObject()
    value = getattr(values, field.name)
    if isinstance(field, Text) and value:
        return builder.CreateString(value)
    if isinstance(field, Bytes) and (value or field.always):
        return builder.CreateByteVector(value)
    if isinstance(field, Structs) and len(value):
        return write_structs(builder, np.ascontiguousarray(value, field.dtype))
    return 0


def write_structs(builder, array):
    """A vector of structs, of the bytes of a numpy array, zero where no field lies: numpy leaves there what the memory
    held before, and a scene's digest is taken over its bytes."""
    layout = np.zeros(array.dtype.itemsize, np.uint8)
    for field, offset in array.dtype.fields.values():
        layout[offset : offset + field.itemsize] = 1
    data = (np.frombuffer(array.tobytes(), np.uint8).reshape(-1, len(layout)) * layout).tobytes()
    builder.StartVector(array.dtype.itemsize, len(array), array.dtype.alignment)
    _place(builder, data)
    return builder.EndVector()


def _place(builder, data):
    # The package has calls for single numbers only; room has been made for these bytes by the call before.
    builder.head = builder.head - len(data)
    builder.Bytes[builder.head : builder.head + len(data)] = data


def _write_field(builder, slot, field, values, target):
    if isinstance(field, Scalar):
        getattr(builder, f"Prepend{_PREPEND[field.code]}Slot")(slot, getattr(values, field.name), field.default)
    elif isinstance(field, Struct):
        value = getattr(values, field.name)
        parts = value if isinstance(value, tuple) else (value,)
        if field.optional and not any(parts):
            return
        data = struct.pack("<" + field.code, *parts)
        builder.Prep(1 if field.code == "16s" else 4, len(data))
        _place(builder, data)
        builder.PrependStructSlot(slot, builder.Offset(), 0)
    else:
        builder.PrependUOffsetTRelativeSlot(slot, target, 0)
