"""Which objects of a scene can be seen? The calls a renderer makes.

    culler = Culler("tcp://127.0.0.1:5571", scene)          # or digest=..., for a scene the daemon has as a file
    visible = culler.ask(camera_from_world, clip_from_camera, size=(1280, 720))
    draw(everything in my view frustum if visible is None else visible.ids)

Conventions: matrices are 4x4, m[row, column], act on column vectors; `camera_from_world` is a rotation and a
translation; `clip_from_camera` is OpenGL's (see `camera` for others). World: right-handed, Y up, metres.

None, always, means: not known, so draw whatever your view frustum holds. A late, lost or dead daemon costs time,
never the picture. An object that is not in `ids` is hidden or outside the view; one that is may be either: cull by
your view frustum too. Not thread-safe: one thread, or a lock of yours.
"""

import time

import numpy as np

from .checks import MAX_VIEWS
from .edits import Edits
from .errors import InputError, Refused, Timeout
from .messages import Reason, ViewKind, ViewRequest, Why, eyes_array
from .scene import ObjectFlag, Scene
from .session import Session, State


class Visible:
    """One answer. `ids`: ascending, read-only; objects to draw, or to draw if they are in the view frustum."""

    def __init__(self, ids, answer, age_s):
        self.ids, self.age_s = ids, age_s  # age: since the request was sent, seconds
        self.reported = answer.ids  # as the daemon said, without what is drawn besides
        self.answer = answer

    def __len__(self):
        return len(self.ids)

    def __contains__(self, object_id):
        i = np.searchsorted(self.ids, object_id)
        return bool(i < len(self.ids) and self.ids[i] == object_id)

    def mask(self, object_count):
        """A bool for every object."""
        mask = np.zeros(object_count, bool)
        mask[self.ids] = True
        return mask


class Culler:
    """A scene at a daemon, and views of it."""

    def __init__(self, endpoint, scene=None, digest=None, object_count=0, keys=None,
                 client_name="sightline for Python"):
        """`scene`: a Scene or its data, uploaded where the daemon does not have it. Or `digest`, 16 bytes or 32 hex
        digits as `main_view info` prints them, of the scene that the daemon has read from a file. `keys`: a file of
        this client's CURVE keys, as `control_view keygen` writes it, with the daemon's `server_public_key`."""
        if (scene is None) == (digest is None):
            raise InputError("scene, digest: give one of them")
        data = scene.data() if isinstance(scene, Scene) else scene
        if data is not None:
            digest, object_count = data.digest, data.object_count
        elif isinstance(digest, str):
            try:
                digest = bytes.fromhex(digest)
            except ValueError:
                raise InputError("digest: must be 32 hex digits") from None
        self._data = data
        self._session = Session(endpoint, digest, object_count, client_name, data, keys)
        self._edits = Edits(object_count) if object_count else None
        self._welcome_seen = None
        self._newest = [None] * MAX_VIEWS
        self._reset = [True] * MAX_VIEWS
        self._why_nonce = 0
        self._always = np.zeros(0, np.uint32)
        self._never_hides = np.False_  # or a bool for every object
        if data is not None:
            self._always = np.flatnonzero(data.flags & ObjectFlag.ALWAYS_VISIBLE).astype(np.uint32)
            self._never_hides = np.ones(object_count, bool)  # as spare ids
            hides_nothing = (data.flags & ObjectFlag.HIDES_NOTHING != 0) | (data.groups != 0)
            self._never_hides[: len(hides_nothing)] = hides_nothing

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._session.close()

    @property
    def session(self):
        """For statistics: bytes, lost_count, bad_frames, upload, welcome."""
        return self._session

    @property
    def state(self):
        return self._session.state

    @property
    def progress(self):
        """Share of the scene that the daemon has; 1 when it needs nothing."""
        upload = self._session.upload
        return 1.0 if upload is None or self.state == State.OPEN else upload.progress

    def wait_until_open(self, timeout_s=10.0, on_progress=None):
        """Blocks until the session is open. Raises Refused, or Timeout saying what it waited for."""
        deadline = time.monotonic() + timeout_s
        while True:
            left_s = deadline - time.monotonic()
            self._take(self._session.poll(max(left_s, 0.0)))
            if on_progress:
                on_progress(self.progress)
            if self._opened():
                return self._session.welcome
            if left_s <= 0.0:
                refusal, upload = self._session.refusal, self._session.upload
                why = refusal.text if refusal else upload.text if upload and upload.text else self._session.last_fault
                why = why or "no answer"
                raise Timeout(f"{self.state.value} for {timeout_s} s: {why}")

    def _opened(self):
        if self.state == State.REFUSED:
            refusal = self._session.refusal
            reason = Reason(refusal.reason).name.lower() if refusal.reason <= 6 else str(refusal.reason)
            raise Refused(f"{reason}: {refusal.text}")
        if self.state != State.OPEN:
            return False
        welcome = self._session.welcome
        if self._welcome_seen is not welcome:
            self._welcome_seen = welcome
            self._newest = [None] * MAX_VIEWS
            self._reset = [True] * MAX_VIEWS
            if self._edits is None:
                self._edits = Edits(welcome.object_count)
            self._edits.forgotten()
        return True

    # --- edits: they count from the next request on, whatever its view ---

    def _editable(self):
        if self._edits is None:
            raise InputError("how many objects there are is not known yet: wait_until_open first")
        return self._edits

    def move(self, ids, world_from_object):
        """Objects that stand elsewhere now, 4x4 matrices. For what moves in every frame use set_boxes."""
        self._editable().move(ids, world_from_object)

    def set_boxes(self, ids, minimum, maximum):
        """All objects that are on the move, deform, or were added in spare ids, and world boxes that hold them until
        the next answer: they hide nothing. Replaces the boxes set before."""
        self._editable().set_boxes(ids, minimum, maximum)

    def set_present(self, ids, present):
        """Objects that vanish, or come back where they were last placed."""
        self._editable().set_present(ids, present)

    # --- views ---

    def request(self, camera_from_world, clip_from_camera, size=(0, 0), view=0, shadow_map=False, control_size=(0, 0),
                rotation_error_rad=0.0, position_error_m=0.0, for_time_s=None, fresh=False):
        """Asks, does not wait. The matrices are 4x4, or lists of up to 8 of them: the answer is what any eye sees.

        `size`: your image, pixels; the daemon then finds even slits of one pixel while the camera stands still.
        `control_size`: the image the daemon looks at; the larger, the surer; equal to `size`, and without errors,
        the answer is exact. `rotation_error_rad`, `position_error_m`: how far the camera may have turned and gone
        from this pose when the answer is used. `fresh`: forget what earlier answers of this view saw; the first
        request does so by itself. Returns whether it could be sent.
        """
        if not 0 <= view < MAX_VIEWS:
            raise InputError(f"view: must be below {MAX_VIEWS}")
        self._take(self._session.poll())
        if not self._opened():
            return False
        request = ViewRequest(
            eyes=_eyes(camera_from_world, clip_from_camera), main_size=tuple(size), control_size=tuple(control_size),
            rotation_error_rad=float(rotation_error_rad), position_error_m=float(position_error_m),
            for_time_s=time.monotonic() if for_time_s is None else float(for_time_s), view=view,
            view_kind=ViewKind.SHADOW_MAP if shadow_map else ViewKind.IMAGE,
            reset_filter=bool(fresh or self._reset[view]))
        self._edits.fill(request)
        return self._session.send(request, self._edits.version)

    def poll(self, view=0, max_age_s=None, timeout_s=0.0, camera_from_world=None):
        """The newest answer for a view, or None. Does not wait, or at most `timeout_s` for something to arrive. None
        too where the answer is older than max_age_s; where an object that hid something in it has moved or gone
        since: what it hid is not known; and where `camera_from_world`, the camera or eyes that are drawn with now, has
        turned or gone farther from the request's than that said it might."""
        self._take(self._session.poll(timeout_s))
        newest = self._newest[view]
        if newest is not None and camera_from_world is not None and not _serves(newest.request, camera_from_world):
            return None
        return self._visible(newest, max_age_s)

    def ask(self, camera_from_world, clip_from_camera, size, view=0, shadow_map=False, control_size=None, fresh=True,
            timeout_s=10.0):
        """Asks and waits for the answer to this very question: None when there is none in time.

        The control image is as large as yours, unless `control_size` says otherwise: (0, 0) for the daemon's. So
        the answer is exact: what your image of that size shows, no object more or less.
        """
        deadline = time.monotonic() + timeout_s
        marker = None  # the request that was sent, which the session numbers
        while True:
            if self._opened() and (marker is None or marker[0] is not self._session.welcome):
                asked_at = time.monotonic()
                sent = self.request(camera_from_world, clip_from_camera, size, view, shadow_map,
                                    size if control_size is None else control_size, fresh=fresh)
                marker = (self._session.welcome, asked_at) if sent else None
            self._take(self._session.poll(min(max(deadline - time.monotonic(), 0.0), 0.05)))
            newest = self._newest[view]
            if marker and newest is not None and newest.issued_s >= marker[1]:
                return self._visible(newest, None)
            if time.monotonic() >= deadline:
                return None

    def hidden_but_needed(self, view, others):
        """Objects that the newest set of `view` does not have and that of some view of `others` has: in no picture of
        `view`, and yet to be kept at hand, as for its shadow or its mirror. None where one of the sets is not known."""
        mine, theirs = self.poll(view), [self.poll(other) for other in others]
        if mine is None or any(visible is None for visible in theirs):
            return None
        seen = np.unique(np.concatenate([visible.ids for visible in theirs] or [mine.ids]))
        return np.setdiff1d(seen, mine.ids, assume_unique=True)

    def why(self, object_id, view=0, timeout_s=1.0):
        """The daemon's reason for the object's state in the last look at the view: a WhyAnswer (its `state` is one of
        WhyState), or None without an answer in time."""
        deadline = time.monotonic() + timeout_s
        self._why_nonce += 1
        if not self._opened() or not self._session.send_message(
                Why(self._session.welcome.session_id, self._why_nonce, view, int(object_id))):
            return None
        while True:
            self._take(self._session.poll(max(deadline - time.monotonic(), 0.0)))
            for answer in self._session.take_why_answers():
                if answer.nonce == self._why_nonce:
                    return answer
            if time.monotonic() >= deadline or self.state != State.OPEN:
                return None

    # --- answers ---

    def _take(self, answers):
        if self.state == State.OPEN:
            self._opened()
        for answer in answers:
            self._newest[answer.request.view] = answer
            self._reset[answer.request.view] = False
            self._edits.answered(answer.tag)

    def _visible(self, answer, max_age_s):
        if answer is None or self.state != State.OPEN or answer.request.session_id != self._session.welcome.session_id:
            return None
        age_s = time.monotonic() - answer.issued_s
        if max_age_s is not None and age_s > max_age_s:
            return None
        boxes_then = answer.request.boxed
        if self._edits.occluders_changed_since(answer.tag, boxes_then, self._never_hides):
            return None
        ids = self._with_groups(answer.ids)
        besides = np.concatenate((self._edits.to_draw_besides(answer.tag, boxes_then), self._always))
        if len(besides):
            ids = np.union1d(ids, besides).astype(np.uint32)
        ids = ids[self._edits.present[ids]]
        return Visible(ids, answer, age_s)

    def _with_groups(self, ids):
        """Levels of detail share an identity: where one is seen, each may be drawn."""
        if self._data is None or not self._data.groups.any():
            return ids
        groups = self._data.groups
        seen = np.unique(groups[ids[ids < len(groups)]])
        members = np.flatnonzero(np.isin(groups, seen[seen != 0]))
        return np.union1d(ids, members).astype(np.uint32)


_SLACK = 1e-9  # rounding, radians and metres


def _serves(request, camera_from_world):
    """Whether eyes are as near to those of a request as it said they would be."""
    now = np.asarray(camera_from_world, float).reshape(-1, 4, 4)
    then = request.eyes["camera_from_world"].reshape(-1, 4, 4).transpose(0, 2, 1)
    if len(now) != len(then):
        return False
    way = [np.linalg.inv(a)[:3, 3] - np.linalg.inv(b)[:3, 3] for a, b in zip(now, then)]
    # The angle of a rotation by its difference from the identity, which is exact for small ones.
    turn = [2.0 * np.arcsin(min(1.0, np.linalg.norm(a[:3, :3] - b[:3, :3]) / 8.0**0.5)) for a, b in zip(now, then)]
    return (np.linalg.norm(way, axis=1).max() <= request.position_error_m + _SLACK
            and max(turn) <= request.rotation_error_rad + _SLACK)


def _eyes(camera_from_world, clip_from_camera):
    cameras = np.asarray(camera_from_world, float).reshape(-1, 4, 4)
    clips = np.asarray(clip_from_camera, float).reshape(-1, 4, 4)
    if len(clips) == 1:
        clips = np.repeat(clips, len(cameras), axis=0)
    if len(cameras) != len(clips) or not 1 <= len(cameras) <= 8:
        raise InputError("camera_from_world, clip_from_camera: give 1 to 8 eyes, one projection each or one for all")
    return eyes_array(list(zip(cameras, clips)))
