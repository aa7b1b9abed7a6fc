"""The sets of one view that deltas may be told against: docs/protocol.md, section 5."""

from collections import OrderedDict

import numpy as np

from . import roaring
from .errors import ProtocolError

_HELD = 32


class HeldSets:
    """Keeps the newest 32. A set that does not check out changes nothing but what is acknowledged next."""

    def __init__(self):
        self._held = OrderedDict()
        self._newest = 0
        self._keyframe_needed = False

    @property
    def acked_seq(self):
        """What the next request has to name: 0 asks for a keyframe."""
        return 0 if self._keyframe_needed else self._newest

    def decode(self, message, object_count):
        """The whole set as ascending uint32. Raises ProtocolError for one that has to be dropped."""
        if message.set_seq <= self._newest:
            raise ProtocolError(f"set_seq: {message.set_seq} after {self._newest}")
        try:
            ids = self._whole(message, object_count)
        except ProtocolError:
            self._keyframe_needed = True
            raise
        self._keyframe_needed = False
        self._newest = message.set_seq
        self._held[message.set_seq] = ids
        if len(self._held) > _HELD:
            self._held.popitem(last=False)
        return ids

    def _whole(self, message, object_count):
        ids = roaring.read(message.bitmap)
        if len(ids) and ids[-1] >= object_count:
            raise ProtocolError("bitmap: an id that the scene does not have")
        if message.base_seq:
            base = self._held.get(message.base_seq)
            if base is None:
                raise ProtocolError(f"base_seq: {message.base_seq} is not held")
            ids = np.setxor1d(base, ids, assume_unique=True)
        if len(ids) != message.visible_count:
            raise ProtocolError("visible_count: not that of the set")
        _check_extents(message, ids)
        ids.setflags(write=False)
        return ids


def _check_extents(message, ids):
    """They are optional to use, and this client does not: only their form is looked at."""
    if not message.extents_of and not message.extents:
        return
    named = roaring.read(message.extents_of)
    if len(message.extents) != 5 * len(named):
        raise ProtocolError("extents: not five bytes an object")
    if len(np.setdiff1d(named, ids, assume_unique=True)):
        raise ProtocolError("extents_of: an object that is not in the set")
