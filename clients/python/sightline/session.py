"""One client's conversation with a daemon: docs/protocol.md, sections 4 and 5. Poll-driven: nothing happens but in
calls of `poll`, none of which waits longer than told. Used by one thread at a time.
"""

import time
from collections import OrderedDict
from dataclasses import dataclass
from enum import Enum

import numpy as np

from .checks import MAX_VIEWS
from .errors import InputError, ProtocolError
from .link import Link
from .messages import (PROTOCOL_VERSION, Goodbye, Hello, Ping, Pong, Reason, Refusal, SceneState, SceneStatus,
                       ViewRequest, VisibleSet, Welcome, WhyAnswer)
from .upload import Upload
from .visible_sets import HeldSets
from .wire import decode, encode

_MAX_FRAMES_A_POLL = 256  # a daemon gone mad must not hold up the caller
_MAX_IN_FLIGHT = 64
_RETRY_S, _LONGEST_RETRY_S = 0.25, 1.0
_PINGS_A_SILENCE = 4
_UPLOAD_SILENCE_S = 10.0  # our own chunks wait before a ping in the queue


class State(Enum):
    CONNECTING = "connecting"  # nobody answers yet, or no longer
    UPLOADING = "uploading"  # the scene is on its way, or the daemon is preparing it
    OPEN = "open"
    REFUSED = "refused"  # for good; `refusal` says why


@dataclass
class Answer:
    """A visible set, whole, and the request it answers."""

    request: ViewRequest
    ids: np.ndarray  # ascending, read-only
    message: VisibleSet
    issued_s: float
    received_s: float
    tag: object  # what came with the request


class Session:
    def __init__(self, endpoint, digest, object_count, client_name="sightline for Python", scene_data=None, keys=None,
                 silence_limit_s=1.0, clock=time.monotonic, context=None):
        """`scene_data`: sent when the daemon does not have the scene. `object_count` 0: the daemon's."""
        if len(digest) != 16:
            raise InputError("digest: must be 16 bytes")
        self._digest, self._object_count, self._name = bytes(digest), object_count, client_name
        self._clock, self._silence_limit_s = clock, silence_limit_s
        self._link = Link(endpoint, keys, context)
        self.upload = Upload(scene_data) if scene_data is not None else None
        self.state = State.CONNECTING
        self.welcome = self.refusal = None
        self.lost_count = self.bad_frames = 0
        self.last_fault = ""  # of the frames that were dropped, for a person
        self._why_answers = []
        self._last_poll_s = None
        self._request_seq = [0] * MAX_VIEWS
        self._forget()

    def _forget(self):
        self.welcome = None
        self._sets = [HeldSets() for _ in range(MAX_VIEWS)]
        self._in_flight = [OrderedDict() for _ in range(MAX_VIEWS)]
        self._next_try_s, self._retry_s, self._tried = None, _RETRY_S, False
        self._silence_s = self._pinged_at_s = 0.0
        if self.upload:
            self.upload.begin()

    @property
    def bytes_sent(self):
        return self._link.bytes_sent

    @property
    def bytes_received(self):
        return self._link.bytes_received

    def close(self):
        if self.welcome is not None:
            self._send(Goodbye(self.welcome.session_id))
        self.welcome = None
        self.state = State.REFUSED
        self.refusal = self.refusal or Refusal(Reason.SHUTTING_DOWN, "closed by this client")
        self._link.close()

    # --- the caller's side ---

    def send(self, request, tag=None):
        """Numbers the request, fills in what is the session's, sends it. False when the session is not open or the
        connection takes no more: the request is then forgotten."""
        if self.state != State.OPEN:
            return False
        view = request.view
        request.session_id = self.welcome.session_id
        request.request_seq = self._request_seq[view] + 1
        request.acked_set_seq = self._sets[view].acked_seq
        try:
            frame = encode(request)
        except ProtocolError as error:
            raise InputError(str(error)) from None
        if not self._link.send(frame):
            return False
        self._request_seq[view] += 1
        self._in_flight[view][request.request_seq] = (request, self._clock(), tag)
        if len(self._in_flight[view]) > _MAX_IN_FLIGHT:
            self._in_flight[view].popitem(last=False)
        return True

    def send_message(self, message):
        return self.state == State.OPEN and self._send(message)

    def take_why_answers(self):
        answers, self._why_answers = self._why_answers, []
        return answers

    def poll(self, timeout_s=0.0):
        """Does what is due and returns the answers that arrived, waiting for the first of anything until
        `timeout_s` is over."""
        if self.state == State.REFUSED:
            return []
        answers = self._read_all()
        self._step(self._clock())
        if not answers and timeout_s > 0.0 and self.state != State.REFUSED:
            self._link.wait(min(timeout_s, 0.05), bool(self.upload and self.upload.sending))
            answers = self._read_all()
            self._step(self._clock())
        return answers

    # --- what is due ---

    def _send(self, message):
        return self._link.send(encode(message))

    def _step(self, now_s):
        # A caller that does not poll for a while is not the daemon's silence.
        limit_s = self._silence_limit_s if self.state == State.OPEN else max(_UPLOAD_SILENCE_S, self._silence_limit_s)
        passed_s = 0.0 if self._last_poll_s is None else now_s - self._last_poll_s
        self._last_poll_s = now_s
        if self.state in (State.OPEN, State.UPLOADING):
            ping_interval_s = limit_s / _PINGS_A_SILENCE
            self._silence_s += min(max(passed_s, 0.0), ping_interval_s)
            if self._silence_s > limit_s:
                self._lose()
            elif self._silence_s - self._pinged_at_s >= ping_interval_s:
                self._pinged_at_s = self._silence_s
                self._send(Ping(0, now_s))
        if self.state == State.UPLOADING:
            self.upload.step(self._link, now_s)
        if self.state == State.CONNECTING:
            self._knock(now_s)

    def _knock(self, now_s):
        if self._next_try_s is not None and now_s < self._next_try_s:
            return
        if self._tried:
            # Anew each time, or the Hellos that pile up while nobody listens would all open a session.
            self._link.reconnect()
        self._tried = True
        if self.upload and self.upload.state != SceneState.READY:
            self.upload.offer(self._link, now_s)
        else:
            self._send(Hello(PROTOCOL_VERSION, self._name, self._digest))
        self._next_try_s = now_s + self._retry_s
        self._retry_s = min(2.0 * self._retry_s, _LONGEST_RETRY_S)

    def _lose(self, again_in_s=None, refusal=None):
        self.lost_count += self.state == State.OPEN
        if self.state != State.CONNECTING:
            self._link.reconnect()
        self.state = State.CONNECTING
        self._forget()
        self.refusal = refusal
        if again_in_s is not None:
            self._next_try_s, self._retry_s = self._clock() + again_in_s, again_in_s

    def _refuse(self, refusal):
        self._forget()
        self.state, self.refusal = State.REFUSED, refusal

    # --- what arrives ---

    def _read_all(self):
        answers = []
        for _ in range(_MAX_FRAMES_A_POLL):
            frame = self._link.receive()
            if frame is None:
                break
            try:
                message = decode(frame)
                handler = self._HANDLERS.get(type(message))
                if handler is None:
                    raise ProtocolError(f"{type(message).__name__}: is for the daemon")
                self._silence_s = self._pinged_at_s = 0.0
                answer = handler(self, message)
            except ProtocolError as error:
                self.bad_frames += 1
                self.last_fault = str(error)
                continue
            if answer is not None:
                answers.append(answer)
            if self.state == State.REFUSED:
                break
        return answers

    def _on_welcome(self, message):
        if message.version != PROTOCOL_VERSION:
            self._refuse(Refusal(Reason.VERSION_MISMATCH, f"the daemon speaks version {message.version} of the "
                                 f"protocol, this client {PROTOCOL_VERSION}", message.version))
            return
        if self._object_count and message.object_count != self._object_count:
            self._refuse(Refusal(Reason.SCENE_MISMATCH, f"the daemon has {message.object_count} objects, this client "
                                 f"{self._object_count}", message.version))
            return
        if self.welcome is not None and self.welcome.session_id != message.session_id:
            self.lost_count += 1
            self._forget()
        self.welcome, self.refusal = message, None
        self.state = State.OPEN

    def _on_refusal(self, message):
        if message.reason == Reason.MALFORMED:
            raise ProtocolError("refused: " + message.text)
        if message.reason == Reason.NO_SESSION:
            if self.state == State.OPEN:
                self._lose()
        elif message.reason == Reason.SCENE_MISMATCH and self.upload:
            self._lose(_RETRY_S, message)  # the daemon has dropped it: offer it again
        elif message.reason == Reason.LIMIT:
            self._lose(_LONGEST_RETRY_S, message)  # a place may come free, but hardly at once
        elif message.reason == Reason.SHUTTING_DOWN:
            self._lose(_RETRY_S, message)
        else:
            self._refuse(message)

    def _on_visible_set(self, message):
        if self.state != State.OPEN or message.session_id != self.welcome.session_id:
            return None  # of a session long gone
        if message.scene_digest != self._digest:
            raise ProtocolError("scene_digest: of another scene")
        ids = self._sets[message.view].decode(message, self.welcome.object_count)
        asked = self._in_flight[message.view]
        found = asked.get(message.request_seq)
        if found is None:
            return None
        while next(iter(asked)) != message.request_seq:  # older ones are not answered any more
            asked.popitem(last=False)
        del asked[message.request_seq]
        request, issued_s, tag = found
        return Answer(request, ids, message, issued_s, self._clock(), tag)

    def _on_ping(self, message):
        self._send(Pong(message.nonce, message.time_s))

    def _on_pong(self, message):
        pass

    def _on_scene_status(self, message):
        if not self.upload or self.state == State.OPEN or message.scene_digest != self._digest:
            return
        goes_on = self.upload.take_status(message, self._clock())
        if message.state == SceneState.FAILED:
            why = Refusal(Reason.LIMIT, "the scene: " + (message.text or "failed"))
            # On another connection: chunks that are still under way on this one would fail as well.
            self._lose(_RETRY_S, why) if goes_on else self._refuse(why)
        elif message.state == SceneState.READY:
            self.state = State.CONNECTING  # on the same connection, at once
            self._tried, self._next_try_s, self._retry_s = False, None, _RETRY_S
        else:
            self.state = State.UPLOADING

    def _on_why_answer(self, message):
        if self.state == State.OPEN and message.session_id == self.welcome.session_id:
            self._why_answers.append(message)
            del self._why_answers[:-_MAX_IN_FLIGHT]

    _HANDLERS = {Welcome: _on_welcome, Refusal: _on_refusal, VisibleSet: _on_visible_set, Ping: _on_ping,
                 Pong: _on_pong, SceneStatus: _on_scene_status, WhyAnswer: _on_why_answer}
