"""The connection: frames of one part to and from the daemon. docs/protocol.md, sections 1, 7 and 9."""

import re

import zmq

from .errors import InputError
from .wire import MAX_FRAME_BYTES

_FAREWELL_MS = 100
_QUEUE_LENGTH = 16
_KEYS = ("public_key", "secret_key", "server_public_key")


class Link:
    """A DEALER socket that can be thrown away and made anew. Used by one thread at a time."""

    def __init__(self, endpoint, keys=None, context=None):
        self._endpoint, self._keys = endpoint, read_keys(keys) if keys else None
        self._context = context or zmq.Context.instance()
        self._socket = None
        self.bytes_sent = self.bytes_received = 0
        self.reconnect()

    def reconnect(self):
        """Whatever was queued either way is gone; to the daemon this is another peer."""
        self.close(0)
        socket = self._context.socket(zmq.DEALER)
        for option, value in (
                (zmq.LINGER, _FAREWELL_MS), (zmq.SNDHWM, _QUEUE_LENGTH), (zmq.RCVHWM, _QUEUE_LENGTH),
                (zmq.MAXMSGSIZE, MAX_FRAME_BYTES), (zmq.IPV6, int("[" in self._endpoint)),
                (zmq.RECONNECT_IVL, 50), (zmq.RECONNECT_IVL_MAX, 500), (zmq.HANDSHAKE_IVL, 5000),
                (zmq.TCP_KEEPALIVE, 1), (zmq.TCP_KEEPALIVE_IDLE, 10), (zmq.TCP_KEEPALIVE_INTVL, 5),
                (zmq.TCP_KEEPALIVE_CNT, 3)):
            socket.setsockopt(option, value)
        if self._keys:
            socket.curve_publickey, socket.curve_secretkey, socket.curve_serverkey = self._keys
        try:
            socket.connect(self._endpoint)
        except zmq.ZMQError as error:
            socket.close(0)
            raise InputError(f"{self._endpoint}: {error}; give tcp://HOST:PORT or ipc://PATH") from None
        self._socket = socket

    def send(self, frame):
        """Whether it could be queued; never waits."""
        try:
            self._socket.send(frame, zmq.NOBLOCK)
        except zmq.Again:
            return False
        self.bytes_sent += len(frame)
        return True

    def receive(self):
        """The next frame that has arrived; None when there is none. Never waits."""
        while True:
            try:
                parts = self._socket.recv_multipart(zmq.NOBLOCK)
            except zmq.Again:
                return None
            self.bytes_received += sum(map(len, parts))
            if len(parts) == 1:
                return parts[0]

    def wait(self, timeout_s, to_send=False):
        """Until a frame arrives, or with `to_send` can be queued, or the time is over."""
        events = zmq.POLLIN | (zmq.POLLOUT if to_send else 0)
        self._socket.poll(max(0, int(1000 * timeout_s + 0.999)), events)

    def close(self, linger_ms=_FAREWELL_MS):
        if self._socket is not None:
            self._socket.close(linger_ms)
            self._socket = None


def read_keys(file):
    """(public, secret, server's public) of a key file: lines NAME = "KEY", a key being 40 characters of Z85."""
    with open(file, encoding="utf-8") as stream:
        keys = dict(re.findall(r'^\s*(\w+)\s*=\s*"([^"]*)"', stream.read(), re.MULTILINE))
    for name in _KEYS:
        if not re.fullmatch(r"[0-9a-zA-Z.\-:+=^!/*?&<>()\[\]{}@%$#]{40}", keys.get(name, "")):
            raise InputError(f"{file}: {name}: must be there, and 40 characters of Z85")
    return tuple(keys[name].encode("ascii") for name in _KEYS)
