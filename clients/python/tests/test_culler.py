"""The client against a daemon made for it: sessions, uploads, edits, views, and what happens when things go wrong."""

import time
import unittest

from support import FakeDaemon

import numpy as np

from sightline import messages as m
from sightline.camera import look_at, perspective
from sightline.culler import Culler
from sightline.errors import InputError, Refused, Timeout
from sightline.scene import ObjectFlag, Scene
from sightline.session import State

DIGEST = bytes(range(16))
CAMERA, LENS = look_at((0, 0, 5), (0, 0, 0)), perspective(1.0, 1.5, 0.1)
SIZE = (320, 200)


def at(x):
    place = np.eye(4)
    place[0, 3] = x
    return place


def until(condition, culler, timeout_s=20.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        culler.poll(timeout_s=0.01)
        if time.monotonic() > deadline:
            raise AssertionError("not in time")


class WithADaemon(unittest.TestCase):
    def start(self, digest=DIGEST, **options):
        daemon = FakeDaemon(digest, **options)
        self.enterContext(daemon) if hasattr(self, "enterContext") else self._enter(daemon)
        return daemon

    def _enter(self, context):
        context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)

    def connect(self, daemon, **options):
        culler = Culler(daemon.endpoint, **(options or {"digest": DIGEST}))
        self.addCleanup(culler.close)
        culler.wait_until_open(20)
        return culler


class Asking(WithADaemon):
    def test_gives_the_answer_to_this_very_question(self):
        daemon = self.start(visible=lambda r: [len(r.eyes), 10 + r.view])
        culler = self.connect(daemon)
        self.assertEqual(culler.ask(CAMERA, LENS, SIZE).ids.tolist(), [1, 10])
        visible = culler.ask([CAMERA, at(1) @ CAMERA], LENS, SIZE, view=3)
        self.assertEqual(visible.ids.tolist(), [2, 13])
        self.assertTrue(13 in visible and 10 not in visible)
        self.assertEqual(np.flatnonzero(visible.mask(100)).tolist(), [2, 13])
        np.testing.assert_allclose(daemon.requests[0].eyes[0]["camera_from_world"].reshape(4, 4).T, CAMERA)
        np.testing.assert_allclose(daemon.requests[0].eyes[0]["clip_from_camera"].reshape(4, 4).T, LENS)

    def test_asks_for_an_image_as_large_as_ones_own_and_for_no_memory(self):
        daemon = self.start()
        culler = self.connect(daemon)
        culler.ask(CAMERA, LENS, SIZE)
        culler.ask(CAMERA, LENS, SIZE, control_size=(0, 0), fresh=False)
        first, second = daemon.requests
        self.assertEqual((first.main_size, first.control_size, first.reset_filter), (SIZE, SIZE, True))
        self.assertEqual((second.main_size, second.control_size, second.reset_filter), (SIZE, (0, 0), False))

    def test_acknowledges_sets_so_that_deltas_follow_and_each_view_for_itself(self):
        answers = iter([[1, 2], [2, 3], [5], [2, 3, 4]])
        daemon = self.start(visible=lambda r: next(answers))
        culler = self.connect(daemon)
        sets = [culler.ask(CAMERA, LENS, SIZE, view=view).ids.tolist() for view in (0, 0, 1, 0)]
        self.assertEqual(sets, [[1, 2], [2, 3], [5], [2, 3, 4]])
        self.assertEqual([r.acked_set_seq for r in daemon.requests], [0, 1, 0, 2])
        self.assertEqual([r.request_seq for r in daemon.requests], [1, 2, 1, 3])

    def test_gives_nothing_when_no_answer_comes_in_time(self):
        daemon = self.start(visible=lambda r: None)
        culler = self.connect(daemon)
        self.assertIsNone(culler.ask(CAMERA, LENS, SIZE, timeout_s=0.1))
        self.assertIsNone(culler.poll())

    def test_asks_again_when_the_session_was_reaped(self):
        daemon = self.start()
        culler = self.connect(daemon)
        culler.ask(CAMERA, LENS, SIZE)
        daemon.forget_sessions()
        self.assertEqual(culler.ask(CAMERA, LENS, SIZE, timeout_s=20).ids.tolist(), [1, 2, 3])
        self.assertEqual((daemon.hellos, culler.session.lost_count), (2, 1))

    def test_refuses_what_is_no_camera_and_goes_on(self):
        culler = self.connect(self.start())
        for camera, lens in ((np.diag([2.0, 1, 1, 1]), LENS), (CAMERA, np.zeros((4, 4))), (CAMERA * np.nan, LENS),
                             ([CAMERA] * 9, LENS), ([CAMERA] * 3, [LENS] * 2)):
            with self.assertRaises(InputError):
                culler.ask(camera, lens, SIZE)
        with self.assertRaises(InputError):
            culler.ask(CAMERA, LENS, SIZE, view=16)
        self.assertEqual(len(culler.ask(CAMERA, LENS, SIZE)), 3)

    def test_tells_why(self):
        culler = self.connect(self.start())
        answer = culler.why(5, view=2)
        self.assertEqual((answer.object_id, answer.view, answer.state), (5, 2, m.WhyState.HIDDEN))
        self.assertEqual(answer.hidden_by.tolist(), [(7, 20)])


class NotWaiting(WithADaemon):
    def test_poll_gives_the_newest_answer_with_its_age(self):
        culler = self.connect(self.start())
        self.assertIsNone(culler.poll())
        self.assertTrue(culler.request(CAMERA, LENS, SIZE))
        until(lambda: culler.poll() is not None, culler)
        self.assertEqual(culler.poll().ids.tolist(), [1, 2, 3])
        self.assertGreater(culler.poll().age_s, 0.0)
        self.assertIsNone(culler.poll(max_age_s=0.0))

    def test_a_camera_that_went_farther_than_was_said_has_no_set(self):
        culler = self.connect(self.start())
        culler.request(CAMERA, LENS, SIZE, rotation_error_rad=0.1, position_error_m=0.5)
        until(lambda: culler.poll() is not None, culler)

        def turned(angle, way=0.0, about=1):
            i, j = [k for k in range(3) if k != about]
            turn = np.eye(4)
            turn[i, i] = turn[j, j] = np.cos(angle)
            turn[i, j], turn[j, i] = -np.sin(angle), np.sin(angle)
            return turn @ CAMERA @ at(way)

        for about in range(3):
            self.assertIsNotNone(culler.poll(camera_from_world=turned(0.099, 0.49, about)))
            self.assertIsNone(culler.poll(camera_from_world=turned(0.101, 0.0, about)))
        self.assertIsNone(culler.poll(camera_from_world=turned(0.0, 0.51)))
        self.assertIsNone(culler.poll(camera_from_world=turned(np.pi)))
        self.assertIsNone(culler.poll(camera_from_world=[CAMERA, CAMERA]))
        culler.ask(CAMERA, LENS, SIZE)
        self.assertIsNotNone(culler.poll(camera_from_world=CAMERA))

    def test_what_one_view_hides_may_be_needed_by_another(self):
        daemon = self.start(visible=lambda r: {0: [1, 2], 1: [2, 3], 2: [5]}[r.view])
        culler = self.connect(daemon)
        self.assertIsNone(culler.hidden_but_needed(0, [1]))
        for view in range(3):
            culler.ask(CAMERA, LENS, SIZE, view=view)
        self.assertEqual(culler.hidden_but_needed(0, [1, 2]).tolist(), [3, 5])
        self.assertEqual(culler.hidden_but_needed(0, []).tolist(), [])

    def test_the_first_request_of_a_view_begins_afresh_and_the_others_do_not(self):
        daemon = self.start()
        culler = self.connect(daemon)
        for _ in range(2):
            before = len(daemon.requests)
            culler.request(CAMERA, LENS, SIZE)
            until(lambda: len(daemon.requests) > before and culler.poll() is not None, culler)
        self.assertEqual([r.reset_filter for r in daemon.requests], [True, False])

    def test_a_daemon_that_falls_silent_is_lost_and_found(self):
        daemon = self.start()
        culler = self.connect(daemon)
        culler.ask(CAMERA, LENS, SIZE)
        daemon.silent = True
        until(lambda: culler.state != State.OPEN, culler)
        self.assertIsNone(culler.poll())
        self.assertFalse(culler.request(CAMERA, LENS, SIZE))
        daemon.silent = False
        culler.wait_until_open(20)
        self.assertIsNone(culler.poll(), "a set of the old session")

    def test_a_daemon_that_is_not_there_costs_time_alone(self):
        culler = Culler("tcp://127.0.0.1:9", digest=DIGEST)
        self.addCleanup(culler.close)
        self.assertIsNone(culler.poll())
        self.assertFalse(culler.request(CAMERA, LENS, SIZE))
        self.assertIsNone(culler.ask(CAMERA, LENS, SIZE, timeout_s=0.1))
        with self.assertRaises(Timeout):
            culler.wait_until_open(0.1)

    def test_another_scene_or_object_count_is_refused_with_its_reason(self):
        daemon = self.start()
        other = Culler(daemon.endpoint, digest=bytes(16))
        self.addCleanup(other.close)
        with self.assertRaisesRegex(Refused, "another scene"):
            other.wait_until_open(20)
        fewer = Culler(daemon.endpoint, digest=DIGEST, object_count=99)
        self.addCleanup(fewer.close)
        with self.assertRaisesRegex(Refused, "100 objects"):
            fewer.wait_until_open(20)

    def test_frames_of_a_lying_daemon_are_dropped_and_counted(self):
        daemon = self.start()
        culler = self.connect(daemon)
        culler.ask(CAMERA, LENS, SIZE)
        daemon.visible = lambda r: [5, 100]  # an id the scene does not have
        self.assertIsNone(culler.ask(CAMERA, LENS, SIZE, timeout_s=0.3))
        self.assertGreaterEqual(culler.session.bad_frames, 1)
        daemon.visible = lambda r: [5]
        self.assertEqual(culler.ask(CAMERA, LENS, SIZE).ids.tolist(), [5])
        self.assertEqual(daemon.requests[-1].acked_set_seq, 0)


class Edits(WithADaemon):
    def test_moves_go_with_every_request_until_one_is_answered(self):
        daemon = self.start(visible=lambda r: None)
        culler = self.connect(daemon)
        culler.move([7, 4], [at(7), at(4)])
        culler.set_present([9], False)
        for _ in range(2):
            culler.request(CAMERA, LENS, SIZE)
        until(lambda: len(daemon.requests) == 2, culler)
        daemon.visible = lambda r: [1]
        culler.ask(CAMERA, LENS, SIZE, view=1)
        culler.ask(CAMERA, LENS, SIZE)
        told = [[(int(mv["id"]), mv["m"][9]) for mv in r.moves] for r in daemon.requests]
        self.assertEqual(told, [[(4, 4.0), (7, 7.0)]] * 3 + [[]])
        self.assertEqual([r.presence.tolist() for r in daemon.requests], [[(9, 0)]] * 3 + [[]])

    def test_a_new_session_is_told_everything_again(self):
        daemon = self.start()
        culler = self.connect(daemon)
        culler.move(3, at(3))
        culler.ask(CAMERA, LENS, SIZE)
        daemon.forget_sessions()
        culler.ask(CAMERA, LENS, SIZE, timeout_s=20)
        self.assertEqual(daemon.requests[-1].moves["id"].tolist(), [3])

    def test_boxes_go_with_every_request(self):
        daemon = self.start()
        culler = self.connect(daemon)
        culler.set_boxes([8, 2], [(0, 0, 0), (1, 1, 1)], [(9, 9, 9), (2, 2, 2)])
        for _ in range(2):
            culler.ask(CAMERA, LENS, SIZE)
        self.assertEqual([r.boxed["id"].tolist() for r in daemon.requests], [[2, 8]] * 2)
        self.assertEqual(daemon.requests[0].boxed["max"][1].tolist(), [9, 9, 9])

    def test_a_set_is_not_used_when_something_it_was_hidden_by_has_gone(self):
        for edit in (lambda c: c.move(7, at(1)), lambda c: c.set_present(7, False),
                     lambda c: c.set_boxes([7], [(0, 0, 0)], [(1, 1, 1)])):
            daemon = self.start()
            culler = self.connect(daemon)
            culler.ask(CAMERA, LENS, SIZE)
            self.assertIsNotNone(culler.poll())
            edit(culler)
            self.assertIsNone(culler.poll())
            self.assertIsNotNone(culler.ask(CAMERA, LENS, SIZE))

    def test_what_a_set_cannot_vouch_for_is_drawn_besides(self):
        culler = self.connect(self.start())
        culler.set_present([20], False)
        culler.set_boxes([30, 40], [(0, 0, 0)] * 2, [(1, 1, 1)] * 2)
        self.assertEqual(culler.ask(CAMERA, LENS, SIZE).ids.tolist(), [1, 2, 3])
        culler.set_present([20], True)  # came back
        culler.set_boxes([30, 40], [(0, 0, 0), (0, 0, 0.5)], [(1, 1, 1.5), (1, 1, 1)])  # 30 left its box
        self.assertEqual(culler.poll().ids.tolist(), [1, 2, 3, 20, 30])
        culler.set_boxes([], [], [])
        self.assertEqual(culler.poll().ids.tolist(), [1, 2, 3, 20, 30, 40])

    def test_that_cannot_be_are_refused(self):
        culler = self.connect(self.start())
        for wrong in (lambda: culler.move(100, at(0)), lambda: culler.move([1, 1], [at(0)] * 2),
                      lambda: culler.move([1, 2], [at(0)]), lambda: culler.move(1, at(np.inf)),
                      lambda: culler.set_boxes([1], [(1, 0, 0)], [(0, 1, 1)]), lambda: culler.set_present([-1], True)):
            with self.assertRaises(InputError):
                wrong()
        culler.ask(CAMERA, LENS, SIZE)
        self.assertEqual(len(culler.poll()), 3)


def large_scene(objects=40, vertices=9_000):
    """About 10 chunks."""
    rng = np.random.default_rng(1)
    scene = Scene()
    mesh = scene.add_mesh(rng.normal(size=(20 * vertices, 3)))
    for i in range(objects):
        scene.add_object(mesh, at(i), ObjectFlag.ALWAYS_VISIBLE if i == 30 else 0, group=5 if i in (2, 12) else 0)
    scene.spare_objects = 2
    return scene


class Uploading(WithADaemon):
    def test_sends_a_scene_once_and_a_second_client_nothing(self):
        daemon, data = self.start(None), large_scene().data()
        progress = []
        first = Culler(daemon.endpoint, data)
        self.addCleanup(first.close)
        first.wait_until_open(20, progress.append)
        count = len(data.offer.chunk_digests) // 16
        self.assertGreater(count, 8)
        self.assertEqual((daemon.offers, daemon.chunks), (1, count))
        chunks = daemon.scenes[data.digest]["chunks"]
        self.assertEqual(b"".join(chunks[i] for i in range(count)), data.bytes)
        self.assertEqual(progress[-1], 1.0)
        second = self.connect(daemon, scene=data)
        self.assertEqual((daemon.offers, daemon.chunks), (2, count))
        self.assertIsNotNone(second.ask(CAMERA, LENS, SIZE))

    def test_goes_on_where_it_was_after_a_reconnect(self):
        daemon, data = self.start(None), large_scene().data()
        daemon.drop_after_chunks = 3
        dying = Culler(daemon.endpoint, data)
        until(lambda: daemon.chunks > 3, dying)
        dying.close()
        daemon.drop_after_chunks = None
        again = self.connect(daemon, scene=data)
        held = daemon.held_at_offer[-1]
        self.assertGreaterEqual(held, 3)
        self.assertEqual(again.session.upload.chunks_sent, len(data.offer.chunk_digests) // 16 - held)

    def test_offers_again_when_chunks_got_lost(self):
        daemon, data = self.start(None), large_scene().data()
        daemon.drop_after_chunks = 5
        culler = Culler(daemon.endpoint, data)
        self.addCleanup(culler.close)
        until(lambda: daemon.chunks >= len(data.offer.chunk_digests) // 16, culler)
        daemon.drop_after_chunks = None
        culler.wait_until_open(20)
        self.assertEqual(daemon.offers, 2)

    def test_offers_again_to_a_daemon_that_forgot_the_scene(self):
        daemon, data = self.start(None), large_scene().data()
        culler = self.connect(daemon, scene=data)
        culler.ask(CAMERA, LENS, SIZE)
        daemon.scenes.clear()
        daemon.forget_sessions()
        self.assertIsNotNone(culler.ask(CAMERA, LENS, SIZE, timeout_s=20))

    def test_begins_anew_when_the_daemon_was_started_anew_amid_the_chunks(self):
        daemon, data = self.start(None), large_scene().data()
        daemon.drop_after_chunks = 2
        culler = Culler(daemon.endpoint, data)
        self.addCleanup(culler.close)
        until(lambda: daemon.chunks > 2, culler)
        daemon.scenes.clear()
        daemon.drop_after_chunks = None
        culler.wait_until_open(20)
        self.assertIsNotNone(culler.ask(CAMERA, LENS, SIZE))

    def test_a_scene_that_the_daemon_will_not_have_is_refused_with_its_reason(self):
        daemon, data = self.start(None), large_scene().data()
        daemon.fail_with = "a vertex is not a number"
        culler = Culler(daemon.endpoint, data)
        self.addCleanup(culler.close)
        with self.assertRaisesRegex(Refused, "a vertex is not a number"):
            culler.wait_until_open(20)
        self.assertEqual(daemon.offers, 2)

    def test_a_full_daemon_is_asked_again(self):
        daemon, data = self.start(None), large_scene().data()
        daemon.full_offers = 1
        culler = Culler(daemon.endpoint, data)
        self.addCleanup(culler.close)
        with self.assertRaisesRegex(Timeout, "full"):
            culler.wait_until_open(0.5)
        culler.wait_until_open(20)
        self.assertEqual(daemon.offers, 2)

    def test_groups_and_always_visible_objects_are_drawn(self):
        daemon, data = self.start(None), large_scene().data()
        culler = self.connect(daemon, scene=data)
        visible = culler.ask(CAMERA, LENS, SIZE)
        self.assertEqual(visible.ids.tolist(), [1, 2, 3, 12, 30])
        self.assertEqual(visible.reported.tolist(), [1, 2, 3])
        # A spare id has no geometry that could have hidden anything.
        culler.set_boxes([40], [(0, 0, 0)], [(1, 1, 1)])
        self.assertEqual(culler.poll().ids.tolist(), [1, 2, 3, 12, 30, 40])


if __name__ == "__main__":
    unittest.main()
