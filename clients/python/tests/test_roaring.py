"""The Roaring reader against a plain slow one, and against what no conforming writer writes; deltas on held sets."""

import random
import struct
import unittest

from support import golden_frames, write_roaring

import numpy as np

from sightline import messages as m
from sightline import roaring, wire
from sightline.errors import ProtocolError
from sightline.visible_sets import HeldSets


def read_slowly(data):
    """The format again, value by value, without a check."""
    cookie, = struct.unpack_from("<I", data)
    at, flags = 4, b""
    if cookie == 12346:
        count, = struct.unpack_from("<I", data, 4)
        at = 8
    else:
        count = (cookie >> 16) + 1
        flags = data[4 : 4 + (count + 7) // 8]
        at += len(flags)
    headers = [struct.unpack_from("<HH", data, at + 4 * i) for i in range(count)]
    at += 4 * count + (4 * count if not flags or count >= 4 else 0)
    members = []
    for i, (key, less_one) in enumerate(headers):
        low = []
        if flags and flags[i // 8] >> i % 8 & 1:
            runs, = struct.unpack_from("<H", data, at)
            for r in range(runs):
                start, length = struct.unpack_from("<HH", data, at + 2 + 4 * r)
                low += range(start, start + length + 1)
            at += 2 + 4 * runs
        elif less_one + 1 <= 4096:
            low += struct.unpack_from(f"<{less_one + 1}H", data, at)
            at += 2 * (less_one + 1)
        else:
            low += [v for v in range(65536) if data[at + v // 8] >> v % 8 & 1]
            at += 8192
        members += [key << 16 | v for v in low]
    return members


def random_ids(rng):
    """Sparse, dense and in runs, over one to six containers."""
    ids = set()
    for key in rng.sample(range(40), rng.randint(1, 6)):
        kind = rng.random()
        if kind < 0.4:
            ids.update(key << 16 | rng.randrange(65536) for _ in range(rng.randint(1, 60)))
        elif kind < 0.7:
            for _ in range(rng.randint(1, 5)):
                start = rng.randrange(65536)
                ids.update(key << 16 | v for v in range(start, min(65536, start + rng.randint(1, 3000))))
        else:
            ids.update(key << 16 | v for v in rng.sample(range(65536), rng.randint(4090, 9000)))
    return sorted(ids)


class RoaringReader(unittest.TestCase):
    def test_reads_what_the_slow_one_reads(self):
        rng = random.Random(3)
        for _ in range(60):
            ids = random_ids(rng)
            data = write_roaring(ids, rng=rng)
            self.assertEqual(read_slowly(data), ids)
            self.assertEqual(roaring.read(data).tolist(), ids)

    def test_reads_the_empty_set_and_the_ends_of_containers(self):
        self.assertEqual(len(roaring.read(write_roaring([]))), 0)
        for kinds in (("array",), ("runs",)):
            ids = [0, 65535, 65536, 131071, 0xFFFFFFFF]
            self.assertEqual(roaring.read(write_roaring(ids, kinds)).tolist(), ids)
        whole = list(range(65536))
        for kinds in (("bitset",), ("runs",)):
            self.assertEqual(roaring.read(write_roaring(whole, kinds)).tolist(), whole)

    def test_refuses_every_proper_prefix_and_a_byte_more(self):
        rng = random.Random(4)
        for _ in range(10):
            data = write_roaring(rng.sample(range(200_000), 30), ("array", "runs"), rng)
            for size in range(len(data)):
                with self.assertRaises(ProtocolError):
                    roaring.read(data[:size])
            with self.assertRaises(ProtocolError):
                roaring.read(data + b"\0")

    def test_refuses_what_is_named_in_the_protocol(self):
        array = lambda *low: struct.pack(f"<IIHHI{len(low)}H", 12346, 1, 0, len(low) - 1, 16, *low)  # noqa: E731
        runs = lambda card, *pairs: struct.pack(  # noqa: E731
            f"<IBHHH{len(pairs)}H", 12347, 1, 0, card - 1, len(pairs) // 2, *pairs)
        self.assertEqual(roaring.read(array(1, 2)).tolist(), [1, 2])
        self.assertEqual(roaring.read(runs(4, 5, 1, 9, 1)).tolist(), [5, 6, 9, 10])
        hostile = {
            "an unknown cookie": struct.pack("<II", 12345, 0),
            "too many containers": struct.pack("<II", 12346, 65537),
            "values that descend": array(2, 1),
            "a value twice": array(1, 1),
            "an offset that points elsewhere": array(1, 2).replace(b"\x10\0\0\0", b"\x11\0\0\0"),
            "keys that descend": struct.pack("<IIHHHHIIHH", 12346, 2, 1, 0, 0, 0, 24, 26, 1, 1),
            "runs that are unsorted": runs(4, 9, 1, 5, 1),
            "runs that overlap": runs(4, 5, 1, 6, 1),
            "runs that touch": runs(4, 5, 1, 7, 1),
            "a run over the end": runs(2, 65535, 1),
            "another cardinality": runs(5, 5, 1, 9, 1),
            "no runs": runs(1),
            "run flags of no container": struct.pack("<IBHHHHH", 12347, 3, 0, 1, 1, 5, 1),
            "a bitset of another cardinality": struct.pack("<IIHHI", 12346, 1, 0, 4999, 16) + b"\xff" * 8192,
        }
        for what, data in hostile.items():
            with self.subTest(what), self.assertRaises(ProtocolError):
                roaring.read(data)

    def test_random_damage_gives_ascending_members_or_is_refused(self):
        rng = random.Random(5)
        read = 0
        for _ in range(3000):
            data = bytearray(write_roaring(rng.sample(range(150_000), 40), ("array", "runs"), rng))
            for _ in range(rng.randint(1, 3)):
                data[rng.randrange(len(data))] = rng.randrange(256)
            try:
                ids = roaring.read(bytes(data))
            except ProtocolError:
                continue
            read += 1
            self.assertTrue(np.all(ids[1:] > ids[:-1]))
        self.assertLess(read, 2000)


class HeldVisibleSets(unittest.TestCase):
    def message(self, seq, base, ids, count=None):
        return m.VisibleSet(1, seq, seq, base_seq=base, visible_count=len(ids) if count is None else count,
                            bitmap=write_roaring(ids))

    def test_golden_frames_give_their_ids(self):
        sets, frames = HeldSets(), golden_frames()
        for name, ids in (("keyframe", [1, 2, 3, 10, 70_000]), ("delta", [1, 2, 4, 10, 70_000])):
            self.assertEqual(sets.decode(wire.decode(frames["visible_set_" + name]), 70_001).tolist(), ids)
        self.assertEqual(sets.acked_seq, 5)

    def test_deltas_of_random_sets_come_out_whole(self):
        rng, sets, whole = random.Random(6), HeldSets(), {}
        for seq in range(1, 80):
            ids = sorted(rng.sample(range(500), rng.randint(0, 60)))
            base = rng.choice([0, *range(max(1, seq - 31), seq)])
            told = ids if base == 0 else sorted(set(ids) ^ set(whole[base]))
            message = self.message(seq, base, told, len(ids))
            self.assertEqual(sets.decode(message, 500).tolist(), ids)
            whole[seq] = ids

    def test_a_set_that_does_not_check_out_asks_for_a_keyframe(self):
        for bad in (self.message(2, 0, [1, 500]), self.message(2, 0, [1, 2], 3), self.message(3, 2, [1]),
                    m.VisibleSet(1, 2, 2, visible_count=1, bitmap=b"nonsense"),
                    m.VisibleSet(1, 2, 2, visible_count=1, bitmap=write_roaring([4]), extents_of=write_roaring([5]),
                                 extents=bytes(5)),
                    m.VisibleSet(1, 2, 2, visible_count=1, bitmap=write_roaring([4]), extents_of=write_roaring([4]),
                                 extents=bytes(4))):
            sets = HeldSets()
            sets.decode(self.message(1, 0, [7]), 500)
            self.assertEqual(sets.acked_seq, 1)
            with self.assertRaises(ProtocolError):
                sets.decode(bad, 500)
            self.assertEqual(sets.acked_seq, 0)
            self.assertEqual(sets.decode(self.message(4, 1, [8], 2), 500).tolist(), [7, 8])
            self.assertEqual(sets.acked_seq, 4)

    def test_an_old_set_is_dropped_without_ado(self):
        sets = HeldSets()
        sets.decode(self.message(5, 0, [7]), 500)
        with self.assertRaises(ProtocolError):
            sets.decode(self.message(4, 0, [8]), 500)
        self.assertEqual(sets.acked_seq, 5)


if __name__ == "__main__":
    unittest.main()
