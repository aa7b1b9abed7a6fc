"""What the tests share: the golden frames, a Roaring writer, scenes, the executables, and a daemon in Python."""

import json
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(HERE.parent))

import numpy as np  # noqa: E402
import zmq  # noqa: E402

from sightline import messages as m  # noqa: E402
from sightline.checks import chunk_count_of  # noqa: E402
from sightline.errors import ProtocolError  # noqa: E402
from sightline.scene import digest_of  # noqa: E402
from sightline.wire import decode, encode  # noqa: E402

DEADLINE_S = 30.0


def golden_frames():
    frames = {}
    for file in sorted((ROOT / "tests" / "protocol" / "golden").glob("*.hex")):
        lines = (line for line in file.read_text().splitlines() if not line.startswith("#"))
        frames[file.stem] = bytes.fromhex(" ".join(lines))
    return frames


def write_roaring(ids, kinds=("array", "bitset", "runs"), rng=None):
    """A plain writer: containers of a kind chosen by `rng` among those that may hold them, or by size."""
    rng = rng or random.Random(0)
    containers = {}
    for value in sorted(set(int(i) for i in ids)):
        containers.setdefault(value >> 16, []).append(value & 0xFFFF)
    headers, bodies, run_flags = b"", [], []
    for key, low in containers.items():
        headers += struct.pack("<HH", key, len(low) - 1)
        allowed = [kind for kind in kinds if kind == "runs" or (kind == "array") == (len(low) <= 4096)]
        kind = rng.choice(allowed or ["array" if len(low) <= 4096 else "bitset"])
        run_flags.append(kind == "runs")
        if kind == "array":
            bodies.append(struct.pack(f"<{len(low)}H", *low))
        elif kind == "bitset":
            bits = bytearray(8192)
            for value in low:
                bits[value // 8] |= 1 << value % 8
            bodies.append(bytes(bits))
        else:
            runs = []
            for value in low:
                if runs and runs[-1][0] + runs[-1][1] + 1 == value:
                    runs[-1][1] += 1
                else:
                    runs.append([value, 0])
            bodies.append(struct.pack("<H", len(runs)) + b"".join(struct.pack("<HH", *run) for run in runs))
    count = len(containers)
    if any(run_flags):
        flags = bytearray((count + 7) // 8)
        for i, flag in enumerate(run_flags):
            flags[i // 8] |= flag << i % 8
        head = struct.pack("<I", 12347 | count - 1 << 16) + bytes(flags) + headers
        with_offsets = count >= 4
    else:
        head, with_offsets = struct.pack("<II", 12346, count) + headers, True
    position = len(head) + (4 * count if with_offsets else 0)
    for body in bodies:
        if with_offsets:
            head += struct.pack("<I", position)
        position += len(body)
    return head + b"".join(bodies)


def executable(name):
    """The built control_view or main_view; skips the test where there is none."""
    folder = os.environ.get("SIGHTLINE_BIN")
    file = pathlib.Path(folder or ROOT / "build" / "release" / "bin") / name
    if not file.exists():
        raise unittest.SkipTest(f"{file} is not built; set SIGHTLINE_BIN to the folder of the executables")
    return str(file)


class Daemon:
    """control_view on a wildcard port; stops with the block."""

    def __init__(self, *options):
        self._options = options

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory()
        announced = pathlib.Path(self._folder.name) / "endpoint"
        self.process = subprocess.Popen(
            [executable("control_view"), "--bind", "tcp://127.0.0.1:*", "--announce", str(announced),
             "--die-with-parent", "--log", "error", "--threads", "1", *self._options],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + DEADLINE_S
        while not (announced.exists() and announced.read_text().strip()):
            if self.process.poll() is not None or time.monotonic() > deadline:
                error = self.process.stderr.read() if self.process.poll() is not None else "not in time"
                self.__exit__()
                raise AssertionError(f"control_view did not start: {error}")
            time.sleep(0.01)  # there is nothing to wait on but the file
        self.endpoint = announced.read_text().strip()
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(10)
        self.process.stderr.close()
        self._folder.cleanup()


def digest_of_file(scene_file):
    out = subprocess.run([executable("main_view"), "info", "--scene", str(scene_file), "--json"], check=True,
                         capture_output=True, text=True, timeout=DEADLINE_S).stdout
    info = json.loads(out)
    return info["digest"], info["objects"]


class FakeDaemon:
    """As much of a daemon as the tests need, in a thread of this process. It answers every request with
    `visible(request)`, as a delta where it can, takes uploads, and counts what it is sent."""

    def __init__(self, digest=None, object_count=100, visible=lambda request: [1, 2, 3]):
        self.digest, self.object_count, self.visible = digest, object_count, visible
        self.scenes = {}  # digest: {"offer", "chunks"}; survives a restart of the socket
        self.requests, self.hellos, self.offers, self.chunks = [], 0, 0, 0
        self.held_at_offer = []
        self.silent = False
        self.drop_after_chunks = None  # pretends to die then
        self.fail_with = None  # text; instead of being ready
        self.full_offers = 0  # so many are told that there is no room
        self.failed = None
        self._sessions = {}
        self._socket = zmq.Context.instance().socket(zmq.ROUTER)
        self._socket.setsockopt(zmq.LINGER, 0)
        port = self._socket.bind_to_random_port("tcp://127.0.0.1")
        self.endpoint = f"tcp://127.0.0.1:{port}"
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join(DEADLINE_S)
        self._socket.close(0)
        if self.failed:
            raise self.failed

    def forget_sessions(self):
        self._sessions = {}

    def _run(self):
        try:
            while not self._stop.is_set():
                if self._socket.poll(20):
                    peer, frame = self._socket.recv_multipart()
                    if not self.silent:
                        self._take(peer, decode(frame))
        except Exception as error:  # handed to the test's thread
            self.failed = error

    def reply(self, peer, message):
        self._socket.send_multipart([peer, message if isinstance(message, bytes) else encode(message)])

    def _take(self, peer, message):
        handler = getattr(self, "_on_" + type(message).__name__, None)
        if handler:
            handler(peer, message)

    def _on_Ping(self, peer, message):
        self.reply(peer, m.Pong(message.nonce, message.time_s))

    def _on_Hello(self, peer, message):
        self.hellos += 1
        ready = message.scene_digest == self.digest or self._complete(message.scene_digest)
        if not ready:
            self.reply(peer, m.Refusal(m.Reason.SCENE_MISMATCH, "another scene", 1))
            return
        count = self.object_count
        if message.scene_digest in self.scenes:
            count = self.scenes[message.scene_digest]["offer"].object_count
        session = 1000 + self.hellos
        self._sessions[peer] = {"id": session, "digest": message.scene_digest, "sets": {}, "seq": {}}
        self.reply(peer, m.Welcome(1, session, "fake", "none", count, (64, 64)))

    def _on_ViewRequest(self, peer, message):
        session = self._sessions.get(peer)
        if session is None or session["id"] != message.session_id:
            self.reply(peer, m.Refusal(m.Reason.NO_SESSION, "who?", 1))
            return
        self.requests.append(message)
        ids = self.visible(message)
        if ids is None:
            return
        ids = np.asarray(sorted(ids), np.uint32)
        sets = session["sets"].setdefault(message.view, {})
        seq = session["seq"][message.view] = session["seq"].get(message.view, 0) + 1
        base = sets.get(message.acked_set_seq)
        bits = ids if base is None else np.setxor1d(base, ids)
        sets[seq] = ids
        self.reply(peer, m.VisibleSet(
            session["id"], seq, message.request_seq, message.for_time_s, session["digest"],
            0 if base is None else message.acked_set_seq, len(ids), write_roaring(bits), view=message.view))

    def _on_Why(self, peer, message):
        self.reply(peer, m.WhyAnswer(message.session_id, message.nonce, message.view, message.object_id, 1,
                                     m.WhyState.HIDDEN, hidden_by=np.array([(7, 20)], m.BLOCKER)))

    def _complete(self, digest):
        scene = self.scenes.get(digest)
        return bool(scene) and len(scene["chunks"]) == chunk_count_of(scene["offer"].byte_count)

    def _status(self, peer, digest, with_held):
        if self.fail_with and self._complete(digest):
            del self.scenes[digest]
            for state, text in ((m.SceneState.BUILDING, ""), (m.SceneState.FAILED, self.fail_with)):
                self.reply(peer, m.SceneStatus(digest, state, text))
            return
        scene = self.scenes[digest]
        state = m.SceneState.READY if self._complete(digest) else m.SceneState.UPLOADING
        self.reply(peer, m.SceneStatus(digest, state, "", chunk_count_of(scene["offer"].byte_count),
                                       len(scene["chunks"]), write_roaring(scene["chunks"]) if with_held else b""))

    def _on_SceneOffer(self, peer, message):
        self.offers += 1
        sizes = message.byte_count.to_bytes(8, "little") + message.object_count.to_bytes(4, "little") \
            + message.triangle_count.to_bytes(8, "little")
        if digest_of(message.chunk_digests + sizes) != message.scene_digest:
            raise ProtocolError("offer: its digest is not its own")
        if self.full_offers:
            self.full_offers -= 1
            self.reply(peer, m.SceneStatus(message.scene_digest, m.SceneState.FULL, "this daemon is full"))
            return
        scene = self.scenes.setdefault(message.scene_digest, {"offer": message, "chunks": {}})
        self.held_at_offer.append(len(scene["chunks"]))
        self._status(peer, message.scene_digest, True)

    def _on_SceneChunk(self, peer, message):
        self.chunks += 1
        if self.drop_after_chunks is not None and self.chunks > self.drop_after_chunks:
            return
        scene = self.scenes.get(message.scene_digest)
        if scene is None:
            self.reply(peer, m.SceneStatus(message.scene_digest, m.SceneState.FAILED, "a chunk of no offer"))
            return
        at = 16 * message.index
        if digest_of(message.bytes) != scene["offer"].chunk_digests[at : at + 16]:
            raise ProtocolError("chunk: its digest is not the offer's")
        scene["chunks"][message.index] = message.bytes
        if len(scene["chunks"]) % 16 == 0 or self._complete(message.scene_digest):
            self._status(peer, message.scene_digest, False)
