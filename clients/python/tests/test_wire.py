"""Frames: the golden ones, those of every message, and hostile ones."""

import dataclasses
import random
import unittest

from support import golden_frames

import numpy as np

from sightline import messages as m
from sightline import wire
from sightline.camera import look_at, perspective
from sightline.errors import ProtocolError

DIGEST = bytes(0x11 * i for i in range(16))
SESSION = 0x0123456789ABCDEF
EYE = (np.array([[1, 0, 0, -1.5], [0, 1, 0, -1.75], [0, 0, 1, -8], [0, 0, 0, 1.0]]),
       np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1.25, -2.25], [0, 0, -1, 0.0]]))


def same(a, b):
    return type(a) is type(b) and all(
        np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a))


def golden_request():
    return m.ViewRequest(
        SESSION, 7, 12.5, m.eyes_array([EYE]), (1024, 768), 0.125, 0.25, 4, True,
        np.array([(3, [1, 0, 0, 0, 1, 0, 0, 0, 1, 10, 20, 30])], m.MOVE),
        np.array([(5, [-1.5, 0, 2], [1.5, 2, 4.25])], m.BOX), np.array([(6, 0), (9, 1)], m.PRESENCE))


def samples():
    """One message of every type, no field at its default."""
    camera, lens = look_at((1, 2, 3), (4, 1, 9)), perspective(1.0, 1.5, 0.1)
    request = golden_request()
    request.eyes = m.eyes_array([(camera, lens), EYE])
    request.view, request.view_kind, request.control_size = 3, 1, (320, 200)
    return [
        m.Hello(1, "a name é", DIGEST),
        m.Welcome(1, 5, "server", "raster", 12, (512, 384), 8, 2.0, "histogram", 0.5, 60.0, "default", True),
        m.Refusal(2, "why", 1, DIGEST), request,
        m.VisibleSet(1, 5, 7, 12.5, DIGEST, 4, 3, b"bits", dict(zip(m.TIMES, (1.0, 2, 3, 4, 5, 6))), 40,
                     b"abc", b"de", 2),
        m.Ping(42, 12.5), m.Pong(42, 12.5), m.Goodbye(9),
        m.SceneOffer(1, DIGEST, 300_000, 10, 20, DIGEST + DIGEST),
        m.SceneStatus(DIGEST, 2, "building", 2, 1, b"held"), m.SceneChunk(DIGEST, 1, b"some bytes"),
        m.Why(1, 2, 3, 4),
        m.WhyAnswer(1, 2, 3, 4, 5, 4, 6, 1.5, 0.5, np.array([(7, 8), (9, 10)], m.BLOCKER)),
    ]


class GoldenFrames(unittest.TestCase):
    def test_decode_to_their_meaning(self):
        frames = golden_frames()
        decoded = {name: wire.decode(frame) for name, frame in frames.items()}
        self.assertGreaterEqual(len(frames), 9)
        self.assertTrue(same(decoded["hello"], m.Hello(1, "example", DIGEST)))
        self.assertTrue(same(decoded["ping"], m.Ping(42, 12.5)))
        self.assertTrue(same(decoded["goodbye"], m.Goodbye(SESSION)))
        self.assertTrue(same(decoded["view_request"], golden_request()))
        self.assertEqual((decoded["welcome"].object_count, decoded["welcome"].control_size), (70_001, (512, 384)))
        self.assertEqual(decoded["refusal"].text, "this daemon serves another scene")
        self.assertEqual(decoded["visible_set_delta"].base_seq, 4)

    def test_mean_the_same_when_written_again(self):
        for name, frame in golden_frames().items():
            with self.subTest(name):
                again = wire.encode(wire.decode(frame))
                self.assertTrue(same(wire.decode(again), wire.decode(frame)))
                # More than the protocol asks: we lay fields out as its own writers do.
                self.assertEqual(again, frame)


class Messages(unittest.TestCase):
    def test_of_every_type_survive_the_wire(self):
        self.assertEqual([type(message) for message in samples()], wire.TYPES)
        for message in samples():
            self.assertTrue(same(wire.decode(wire.encode(message)), message), message)

    def test_have_zeros_where_no_field_lies(self):
        clean = golden_request()
        dirty = golden_request()
        for name in ("moves", "boxed", "presence"):
            array = np.frombuffer(b"\xff" * getattr(dirty, name).nbytes, getattr(dirty, name).dtype).copy()
            for field in array.dtype.names:
                array[field] = getattr(clean, name)[field]
            setattr(dirty, name, array)
        self.assertEqual(wire.encode(dirty), wire.encode(clean))

    def test_that_no_peer_would_take_are_not_written(self):
        def request(**changes):
            return dataclasses.replace(golden_request(), **changes)

        mirror = np.diag([-1.0, 1, 1, 1])
        for message in (
                request(request_seq=0), request(eyes=m.eyes_array([])), request(eyes=m.eyes_array([EYE] * 9)),
                request(eyes=m.eyes_array([(mirror, EYE[1])])),
                request(eyes=m.eyes_array([(EYE[0], np.zeros((4, 4)))])),
                request(eyes=m.eyes_array([(EYE[0], EYE[1] * np.nan)])), request(view=16), request(main_size=(0, 5)),
                request(rotation_error_rad=float("nan")), request(control_size=(16_000, 16_000)),
                request(boxed=np.array([(5, [1, 0, 0], [0, 1, 1])], m.BOX)),
                request(presence=np.array([(9, 0), (6, 1)], m.PRESENCE)),
                request(moves=np.array([(1, [0] * 12), (1, [0] * 12)], m.MOVE)),
                m.SceneChunk(DIGEST, 0, b""), m.SceneChunk(DIGEST, 0, bytes(262_145)), m.SceneOffer(1, DIGEST, 0)):
            with self.assertRaises(ProtocolError):
                wire.encode(message)
            with self.assertRaises(ProtocolError):
                wire.decode(wire.encode_unchecked(message))

    def test_with_control_characters_are_refused(self):
        for text in ("a\nb", "a\x7fb", "\x85", "\u2028", "x" * 1025):
            with self.assertRaises(ProtocolError):
                wire.decode(wire.encode_unchecked(m.Hello(1, text, DIGEST)))


class HostileFrames(unittest.TestCase):
    def refuses_or_reads(self, frame):
        try:
            return wire.decode(frame)
        except ProtocolError:
            return None

    def frames(self):
        return [*golden_frames().values(), *(wire.encode(message) for message in samples())]

    def test_every_proper_prefix_is_refused_or_is_a_message_without_its_padding(self):
        for frame in self.frames():
            for size in range(len(frame)):
                message = self.refuses_or_reads(frame[:size])
                if message is not None:
                    self.assertEqual(frame[size:].strip(b"\0"), b"")

    def test_every_word_as_any_offset_raises_nothing_else(self):
        values = [value.to_bytes(4, "little", signed=True) for value in (0, 1, 4, -1, -4, 2**31 - 1, -(2**31))]
        for frame in self.frames():
            for at in range(0, len(frame), 2):
                for value in values:
                    self.refuses_or_reads(frame[:at] + value + frame[at + 4 :])

    def test_random_damage_raises_nothing_else(self):
        rng = random.Random(11)
        frames, refused = self.frames(), 0
        for _ in range(20_000):
            frame = bytearray(rng.choice(frames))
            for _ in range(rng.randint(1, 6)):
                frame[rng.randrange(len(frame))] = rng.randrange(256)
            refused += self.refuses_or_reads(bytes(frame)) is None
        self.assertGreater(refused, 1000)

    def test_noise_and_huge_lengths_raise_nothing_else(self):
        rng = random.Random(12)
        for _ in range(3000):
            self.assertIsNone(self.refuses_or_reads(b"\x08\0\0\0SLN1" + rng.randbytes(4 * rng.randrange(40))))
        self.assertIsNone(self.refuses_or_reads(b""))
        self.assertIsNone(self.refuses_or_reads(bytes(wire.MAX_FRAME_BYTES + 4)))

    def test_whole_words_behind_the_buffer_are_ignored(self):
        frame = golden_frames()["ping"]
        self.assertTrue(same(wire.decode(frame + bytes(8)), m.Ping(42, 12.5)))
        self.assertIsNone(self.refuses_or_reads(frame + b"x"))


if __name__ == "__main__":
    unittest.main()
