"""What a client changes about its scene, and what of it the daemon has still to be told: docs/protocol.md, section 6.

Each change has a version, growing; every request carries all changes that no answer has confirmed.
"""

import numpy as np

from .errors import InputError
from .messages import BOX, MOVE, PRESENCE


class Edits:
    def __init__(self, object_count):
        self._count = object_count
        self.version = 0
        self._told = 0  # every change up to this version has been answered
        self._moved_at = np.zeros(object_count, np.int64)  # 0: never
        self._placements = None  # made when the first object moves
        self._presence_at = np.zeros(object_count, np.int64)
        self.present = np.ones(object_count, bool)
        self.boxes = np.zeros(0, BOX)

    def _ids(self, ids):
        ids = np.atleast_1d(np.asarray(ids, np.int64))
        if ids.ndim != 1 or (len(ids) and (ids.min() < 0 or ids.max() >= self._count)):
            raise InputError(f"ids: must be a list of numbers below {self._count}")
        if len(np.unique(ids)) != len(ids):
            raise InputError("ids: one is there twice")
        return ids

    def move(self, ids, world_from_object):
        """`world_from_object`: 4x4 matrices m[row, column], one an object."""
        ids = self._ids(ids)
        matrices = np.asarray(world_from_object, float).reshape(-1, 4, 4)
        if len(matrices) != len(ids):
            raise InputError("world_from_object: not one an object")
        if not np.all(np.isfinite(matrices)) or not np.all(matrices[:, 3] == (0, 0, 0, 1)):
            raise InputError("world_from_object: must be finite with the last row 0 0 0 1")
        if self._placements is None:
            self._placements = np.zeros((self._count, 12))
        self.version += 1
        self._placements[ids] = matrices[:, :3].transpose(0, 2, 1).reshape(-1, 12)
        self._moved_at[ids] = self.version

    def set_present(self, ids, present):
        ids = self._ids(ids)
        changed = ids[self.present[ids] != present]
        if len(changed):
            self.version += 1
            self.present[changed] = present
            self._presence_at[changed] = self.version

    def set_boxes(self, ids, minimum, maximum):
        """Replaces all boxes."""
        ids = self._ids(ids)
        boxes = np.zeros(len(ids), BOX)
        boxes["id"] = ids
        boxes["min"] = np.asarray(minimum, float).reshape(-1, 3)
        boxes["max"] = np.asarray(maximum, float).reshape(-1, 3)
        if not np.all(boxes["min"] <= boxes["max"]):
            raise InputError("boxes: must be finite, min <= max")
        self.boxes = boxes[np.argsort(ids)]

    def fill(self, request):
        """Puts into a request what it has to carry."""
        request.boxed = self.boxes
        if self._told == self.version:
            return
        moved = np.flatnonzero(self._moved_at > self._told)
        request.moves = np.zeros(len(moved), MOVE)
        request.moves["id"] = moved
        if len(moved):
            request.moves["m"] = self._placements[moved]
        changed = np.flatnonzero(self._presence_at > self._told)
        request.presence = np.zeros(len(changed), PRESENCE)
        request.presence["id"] = changed
        request.presence["present"] = self.present[changed]

    def answered(self, version):
        """An answer to a request that was filled at `version` has arrived."""
        self._told = max(self._told, version)

    def forgotten(self):
        """A new session knows nothing."""
        self._told = 0

    def occluders_changed_since(self, version, boxes_then, never_hides):
        """Whether an object that may have hidden something in a set of `version` stands elsewhere now, is on the move
        or is gone. What was boxed hid nothing; nor does an object of the mask `never_hides`."""
        changed = (self._moved_at > version) | ((self._presence_at > version) & ~self.present)
        changed[self.boxes["id"]] = True
        changed[boxes_then["id"]] = False
        return bool(np.any(changed & ~never_hides))

    def to_draw_besides(self, version, boxes_then):
        """Objects that a set of `version` cannot vouch for: they have come, or may have left the box they were in."""
        if version == self.version and boxes_then is self.boxes:
            return np.zeros(0, np.uint32)
        came = np.flatnonzero((self._presence_at > version) & self.present)
        begun = np.setdiff1d(self.boxes["id"], boxes_then["id"], assume_unique=True)
        _, then, now = np.intersect1d(boxes_then["id"], self.boxes["id"], assume_unique=True, return_indices=True)
        stays = np.all((self.boxes["min"][now] >= boxes_then["min"][then])
                       & (self.boxes["max"][now] <= boxes_then["max"][then]), axis=1)
        left = np.setdiff1d(boxes_then["id"], boxes_then["id"][then[stays]], assume_unique=True)
        return np.concatenate((came, begun, left)).astype(np.uint32)
