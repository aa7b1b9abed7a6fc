"""What a message may hold, beyond its form: the limits of docs/protocol.md, section 8.

Used both ways: on a peer's message before anybody reads it, and on our own before it leaves.
"""

import numpy as np

from .errors import ProtocolError
from .messages import (PROTOCOL_VERSION, Goodbye, Hello, Ping, Pong, Refusal, SceneChunk, SceneOffer, SceneState,
                       SceneStatus, ViewRequest, VisibleSet, Welcome, Why, WhyAnswer)

MAX_OBJECTS = 4_294_967_294
MAX_EYES = 8
MAX_VIEWS = 16
MAX_SIDE = 16_384
MAX_CONTROL_PIXELS = 3840 * 2160
MAX_VALUE = 1e12
MAX_LIST = 1_048_576
MAX_BLOCKERS = 64
MAX_TEXT_BYTES = 1024
CHUNK_BYTES = 262_144


def require(holds, text):
    # Written for numpy too: a NaN compares false and so does not hold.
    if not holds:
        raise ProtocolError(text)


def _duration(value, name):
    require(0.0 <= value <= MAX_VALUE, f"{name}: negative or not finite")


def _time(value, name):
    require(-MAX_VALUE <= value <= MAX_VALUE, f"{name}: not a time")


def _size(size, name):
    width, height = size
    require(max(width, height) <= MAX_SIDE and (width == 0) == (height == 0), f"{name}: not an image size")


def _within(values, name):
    require(np.all(np.abs(values) <= MAX_VALUE), f"{name}: not finite or too large")


def _ascending(ids, name):
    require(np.all(ids[1:] > ids[:-1]), f"{name}: object ids not ascending")
    require(not len(ids) or ids[-1] < MAX_OBJECTS, f"{name}: object id too large")


def _view(view):
    require(view < MAX_VIEWS, f"view: {view}, must be below {MAX_VIEWS}")


def check_eye(camera_from_world, clip_from_camera, name):
    """Matrices as m[row, column]. The rotation orthonormal, the projection invertible."""
    _within(camera_from_world, f"{name}.camera_from_world")
    _within(clip_from_camera, f"{name}.clip_from_camera")
    rotation = camera_from_world[:3, :3]
    require(np.array_equal(camera_from_world[3], (0, 0, 0, 1))
            and np.all(np.abs(rotation.T @ rotation - np.eye(3)) <= 1e-4) and np.linalg.det(rotation) > 0,
            f"{name}.camera_from_world: not a rotation and a translation")
    try:
        inverse = np.linalg.inv(clip_from_camera)
    except np.linalg.LinAlgError:
        inverse = np.full((4, 4), np.nan)
    with np.errstate(all="ignore"):
        require(np.all(np.abs(inverse) <= MAX_VALUE)
                and np.all(np.abs(clip_from_camera @ inverse - np.eye(4)) <= 1e-6),
                f"{name}.clip_from_camera: has no inverse")


def _hello(message):
    pass


def _welcome(message):
    require(message.session_id != 0, "session_id: 0")
    require(message.object_count <= MAX_OBJECTS, "object_count: too large")
    _size(message.control_size, "control_size")
    require(message.filter_length >= 1, "filter_length: 0")
    require(0.0 < message.heartbeat_interval_s <= 3600.0, "heartbeat_interval_s: not within 0 to 3600")
    _duration(message.threshold, "threshold")
    _duration(message.control_rate_hz, "control_rate_hz")


def _refusal(message):
    # A newer daemon may have reasons of its own; it is refusing us all the same.
    require(message.reason != 0, "reason: 0")
    require(message.reason <= 6 or message.server_version != PROTOCOL_VERSION, "reason: unknown")


def _view_request(message):
    require(message.request_seq != 0, "request_seq: 0")
    _time(message.for_time_s, "for_time_s")
    _size(message.main_size, "main_size")
    _duration(message.rotation_error_rad, "rotation_error_rad")
    _duration(message.position_error_m, "position_error_m")
    require(1 <= len(message.eyes) <= MAX_EYES, f"eyes: {len(message.eyes)}, must be 1 to {MAX_EYES}")
    for i, eye in enumerate(message.eyes):
        check_eye(eye["camera_from_world"].reshape(4, 4).T, eye["clip_from_camera"].reshape(4, 4).T, f"eyes[{i}]")
    for name in ("moves", "boxed", "presence"):
        require(len(getattr(message, name)) <= MAX_LIST, f"{name}: more than {MAX_LIST}")
    _within(message.moves["m"], "moves")
    ids = np.sort(message.moves["id"])
    _ascending(ids, "moves (sorted)")
    boxed = message.boxed
    _within(boxed["min"], "boxed")
    _within(boxed["max"], "boxed")
    require(np.all(boxed["min"] <= boxed["max"]), "boxed: min above max")
    _ascending(boxed["id"], "boxed")
    _ascending(message.presence["id"], "presence")
    _view(message.view)
    require(message.view_kind <= 1, "view_kind: unknown")
    _size(message.control_size, "control_size")
    require(message.control_size[0] * message.control_size[1] <= MAX_CONTROL_PIXELS,
            f"control_size: above {MAX_CONTROL_PIXELS} pixels")


def _visible_set(message):
    require(message.set_seq != 0, "set_seq: 0")
    require(message.request_seq != 0, "request_seq: 0")
    require(message.base_seq < message.set_seq, "base_seq: not before set_seq")
    _time(message.for_time_s, "for_time_s")
    require(message.visible_count <= MAX_OBJECTS, "visible_count: too large")
    for value in message.times.values():
        _duration(value, "times")
    _view(message.view)


def _ping(message):
    _time(message.time_s, "time_s")


def _goodbye(message):
    pass


def chunk_count_of(byte_count):
    return -(-byte_count // CHUNK_BYTES)


def _scene_offer(message):
    require(message.object_count <= MAX_OBJECTS, "object_count: too large")
    require(message.byte_count > 0, "byte_count: 0")
    require(len(message.chunk_digests) == 16 * chunk_count_of(message.byte_count), "chunk_digests: not one a chunk")


def _scene_status(message):
    require(1 <= message.state <= max(SceneState), "state: unknown")
    require(message.chunks_held <= message.chunk_count, "chunks_held: above chunk_count")


def _scene_chunk(message):
    require(0 < len(message.bytes) <= CHUNK_BYTES, f"bytes: none, or above {CHUNK_BYTES}")


def _why(message):
    _view(message.view)
    require(message.object_id < MAX_OBJECTS, "object_id: too large")


def _why_answer(message):
    _view(message.view)
    require(1 <= message.state <= 9, "state: unknown")
    _duration(message.pixels_mean, "pixels_mean")
    _duration(message.threshold, "threshold")
    require(len(message.hidden_by) <= MAX_BLOCKERS, f"hidden_by: more than {MAX_BLOCKERS}")


CHECKS = {Hello: _hello, Welcome: _welcome, Refusal: _refusal, ViewRequest: _view_request, VisibleSet: _visible_set,
          Ping: _ping, Pong: _ping, Goodbye: _goodbye, SceneOffer: _scene_offer, SceneStatus: _scene_status,
          SceneChunk: _scene_chunk, Why: _why, WhyAnswer: _why_answer}


def check(message):
    """Raises ProtocolError naming the first field that cannot be."""
    CHECKS[type(message)](message)
