"""The messages of docs/protocol.md as plain values. `wire` turns them into frames and back.

Matrices are 4x4 numpy arrays in the mathematical layout: m[row, column], acting on column vectors. All times are
seconds of the client's own clock.
"""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

PROTOCOL_VERSION = 1
NO_DIGEST = bytes(16)

# As the structs of the schema lie in memory.
MOVE = np.dtype({"names": ["id", "m"], "formats": ["<u4", ("<f8", 12)], "offsets": [0, 8], "itemsize": 104},
                align=True)
BOX = np.dtype({"names": ["id", "min", "max"], "formats": ["<u4", ("<f8", 3), ("<f8", 3)], "offsets": [0, 8, 32],
                "itemsize": 56}, align=True)
PRESENCE = np.dtype({"names": ["id", "present"], "formats": ["<u4", "u1"], "offsets": [0, 4], "itemsize": 8},
                    align=True)
BLOCKER = np.dtype([("id", "<u4"), ("pixels", "<u4")], align=True)
EYE = np.dtype([("camera_from_world", "<f8", 16), ("clip_from_camera", "<f8", 16)], align=True)
TIMES = ("queue_s", "cull_s", "draw_s", "count_s", "filter_s", "encode_s")


class Reason(IntEnum):
    VERSION_MISMATCH = 1
    SCENE_MISMATCH = 2
    MALFORMED = 3
    NO_SESSION = 4
    LIMIT = 5
    SHUTTING_DOWN = 6


class ViewKind(IntEnum):
    IMAGE = 0
    SHADOW_MAP = 1


class SceneState(IntEnum):
    UPLOADING = 1
    BUILDING = 2
    READY = 3
    FAILED = 4
    FULL = 5


class WhyState(IntEnum):
    UNKNOWN = 1
    VISIBLE = 2
    OUTSIDE = 3
    HIDDEN = 4
    BELOW_THRESHOLD = 5
    HELD_BY_FILTER = 6
    ABSENT = 7
    OPEN = 8
    BOXED = 9


def eyes_array(views):
    """EYE structs of (camera_from_world, clip_from_camera) pairs."""
    eyes = np.zeros(len(views), EYE)
    for eye, (camera_from_world, clip_from_camera) in zip(eyes, views):
        eye["camera_from_world"] = np.asarray(camera_from_world, float).T.reshape(16)
        eye["clip_from_camera"] = np.asarray(clip_from_camera, float).T.reshape(16)
    return eyes


def _none(dtype):
    return field(default_factory=lambda: np.zeros(0, dtype))


@dataclass
class Hello:
    version: int = PROTOCOL_VERSION
    client_name: str = ""
    scene_digest: bytes = NO_DIGEST


@dataclass
class Welcome:
    version: int = 0
    session_id: int = 0
    server_name: str = ""
    engine: str = ""
    object_count: int = 0
    control_size: tuple = (0, 0)
    filter_length: int = 1
    heartbeat_interval_s: float = 1.0
    counter: str = ""
    threshold: float = 0.0
    control_rate_hz: float = 0.0
    preset: str = ""
    refine: bool = False


@dataclass
class Refusal:
    reason: int = 0
    text: str = ""
    server_version: int = 0
    server_scene_digest: bytes = NO_DIGEST


@dataclass
class ViewRequest:
    session_id: int = 0
    request_seq: int = 0
    for_time_s: float = 0.0
    eyes: np.ndarray = _none(EYE)
    main_size: tuple = (0, 0)
    rotation_error_rad: float = 0.0
    position_error_m: float = 0.0
    acked_set_seq: int = 0
    reset_filter: bool = False
    moves: np.ndarray = _none(MOVE)
    boxed: np.ndarray = _none(BOX)
    presence: np.ndarray = _none(PRESENCE)
    view: int = 0
    view_kind: int = ViewKind.IMAGE
    control_size: tuple = (0, 0)


@dataclass
class VisibleSet:
    session_id: int = 0
    set_seq: int = 0
    request_seq: int = 0
    for_time_s: float = 0.0
    scene_digest: bytes = NO_DIGEST
    base_seq: int = 0
    visible_count: int = 0
    bitmap: bytes = b""
    times: dict = field(default_factory=lambda: dict.fromkeys(TIMES, 0.0))
    drawn_objects: int = 0
    extents_of: bytes = b""
    extents: bytes = b""
    view: int = 0


@dataclass
class Ping:
    nonce: int = 0
    time_s: float = 0.0


@dataclass
class Pong:
    nonce: int = 0
    time_s: float = 0.0


@dataclass
class Goodbye:
    session_id: int = 0


@dataclass
class SceneOffer:
    version: int = PROTOCOL_VERSION
    scene_digest: bytes = NO_DIGEST
    byte_count: int = 0
    object_count: int = 0
    triangle_count: int = 0
    chunk_digests: bytes = b""  # 16 bytes a chunk


@dataclass
class SceneStatus:
    scene_digest: bytes = NO_DIGEST
    state: int = 0
    text: str = ""
    chunk_count: int = 0
    chunks_held: int = 0
    held: bytes = b""  # Roaring bitmap of chunk numbers


@dataclass
class SceneChunk:
    scene_digest: bytes = NO_DIGEST
    index: int = 0
    bytes: bytes = b""


@dataclass
class Why:
    session_id: int = 0
    nonce: int = 0
    view: int = 0
    object_id: int = 0


@dataclass
class WhyAnswer:
    session_id: int = 0
    nonce: int = 0
    view: int = 0
    object_id: int = 0
    request_seq: int = 0
    state: int = 0
    pixels: int = 0
    pixels_mean: float = 0.0
    threshold: float = 0.0
    hidden_by: np.ndarray = _none(BLOCKER)
