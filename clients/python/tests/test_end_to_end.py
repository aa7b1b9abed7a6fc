"""The client and the built control_view over loopback; sets judged by the built main_view against the whole image."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

from support import DEADLINE_S, HERE, Daemon, digest_of_file, executable

import numpy as np

from sightline import Culler, ObjectFlag, Scene, WhyState, camera, read_glb
from sightline.errors import InputError, Refused, Timeout

SIZE = (160, 120)
SIZE_TEXT = "160x120"
LENS = camera.perspective(math.radians(60.0), SIZE[0] / SIZE[1], 0.1, 10_000.0)
FRAMES = 24


def cube_scene(spare=0, flags=ObjectFlag(0)):
    """A wall in front of one of two cubes, and an id to spare."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    indices = [i for a, b, c, d in faces for i in (a, b, c, a, c, d)]
    scene = Scene()
    cube = scene.add_mesh(corners, indices)

    def place(x, y, z, sx=1.0, sy=1.0, sz=1.0):
        m = np.diag([sx, sy, sz, 1.0])
        m[:3, 3] = x, y, z
        return m

    scene.add_object(cube, place(-3, 0, -5, 2.5, 2.5, 0.2), flags)  # the wall
    scene.add_object(cube, place(-3, 0, -10))  # behind it
    scene.add_object(cube, place(3, 0, -10))  # in the open
    scene.spare_objects = spare
    return scene


class WithACity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.scene, cls.path = cls.folder / "city.glb", cls.folder / "walk.csv"
        cls.run_tool("generate", "city", "--objects", "300", "--seed", "3", "--out", cls.scene, "--path-out", cls.path)

    @staticmethod
    def run_tool(*arguments, code=0):
        done = subprocess.run([executable("main_view"), *map(str, arguments)], capture_output=True, text=True,
                              timeout=2 * DEADLINE_S)
        if done.returncode != code:
            raise AssertionError(f"main_view {arguments[0]} ended with {done.returncode}: {done.stderr}")
        return done

    def write_sets(self, sets):
        file = self.folder / "sets.csv"
        lines = (f"{frame}," + ("*" if ids is None else " ".join(map(str, ids))) for frame, ids in sets)
        file.write_text("frame,ids\n" + "\n".join(lines) + "\n")
        return file

    def judge(self, sets_file, code=0):
        report = self.folder / "judged.json"
        self.run_tool("judge", "--scene", self.scene, "--path", self.path, "--sets", sets_file, "--size", SIZE_TEXT,
                      "--max-wrong-pixels", "0", "--json", report, code=code)
        return json.loads(report.read_text())["quality"]


class AtZeroLatency(WithACity):
    def walk(self, culler):
        path = camera.CameraPath(self.path)
        for frame in range(0, 30 * FRAMES, 30):
            visible = culler.ask(path.at(frame / 60.0), LENS, SIZE, timeout_s=DEADLINE_S)
            yield frame, None if visible is None else visible.ids

    def test_the_image_is_that_of_the_whole_scene_and_nothing_hidden_is_drawn(self):
        digest, _ = digest_of_file(self.scene)
        with Daemon("--scene", str(self.scene)) as daemon, Culler(daemon.endpoint, digest=digest) as culler:
            culler.wait_until_open(DEADLINE_S)
            sets = list(self.walk(culler))
        quality = self.judge(self.write_sets(sets))
        self.assertEqual((quality["frames"], quality["fallback_frames"]), (FRAMES, 0))
        self.assertEqual((quality["frames_with_wrong_pixels"], quality["missed_objects_max"]), (0, 0))
        self.assertEqual(quality["conservativity_mean"], 1.0)
        self.assertLess(quality["triangles_drawn"], quality["triangles_frustum"])
        # The judge can say no: without the object that the first frame shows most of, there are wrong pixels.
        frame, ids = next((frame, ids) for frame, ids in sets if len(ids))
        quality = self.judge(self.write_sets([(frame, ids[:0])]), code=1)
        self.assertEqual(quality["frames_with_wrong_pixels"], 1)
        self.assertEqual(quality["missed_objects_max"], len(ids))
        # And everything is never wrong.
        self.assertEqual(self.judge(self.write_sets([(frame, None)]))["frames_with_wrong_pixels"], 0)

    def test_the_example_writes_what_the_judge_reads(self):
        digest, _ = digest_of_file(self.scene)
        out = self.folder / "example.csv"
        with Daemon("--scene", str(self.scene)) as daemon:
            done = subprocess.run(
                [sys.executable, "-B", str(HERE.parent / "examples" / "cull_scene.py"), str(self.scene),
                 str(self.path), "--connect", daemon.endpoint, "--digest", digest, "--size", SIZE_TEXT,
                 "--every", "60", "--out", str(out)],
                capture_output=True, text=True, timeout=2 * DEADLINE_S, env={"PYTHONPATH": str(HERE.parent)})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("left out", done.stdout)
        self.assertEqual(self.judge(out)["frames_with_wrong_pixels"], 0)

    def test_another_digest_is_refused(self):
        with Daemon("--scene", str(self.scene)) as daemon, Culler(daemon.endpoint, digest=bytes(16)) as culler:
            with self.assertRaisesRegex(Refused, "scene_mismatch"):
                culler.wait_until_open(DEADLINE_S)

    def test_ids_are_those_of_the_loader(self):
        scene, names = read_glb(self.scene)
        _, objects = digest_of_file(self.scene)
        self.assertEqual((len(scene), len(names)), (objects, objects))

    def test_sets_that_are_none_are_refused_in_one_line(self):
        for text in ("", "ids\n", "frame,ids\n", "frame,ids\n0 1\n", "frame,ids\n0,1  2\n", "frame,ids\n0,300\n",
                     "frame,ids\n5,1\n4,1\n", "frame,ids\n99999999,1\n", "frame,ids\n0,**\n"):
            file = self.folder / "bad.csv"
            file.write_text(text)
            done = self.run_tool("judge", "--scene", self.scene, "--path", self.path, "--sets", file, "--json",
                                 self.folder / "bad.json", code=2)
            self.assertRegex(done.stderr, r"^main_view: .*bad\.csv: line \d+: [^\n]+\n$")


class OverTheWire(WithACity):
    def test_an_uploaded_scene_gives_the_sets_of_its_file(self):
        scene, _ = read_glb(self.scene)
        digest, _ = digest_of_file(self.scene)
        with Daemon("--scene", str(self.scene)) as daemon:
            with Culler(daemon.endpoint, scene) as culler, Culler(daemon.endpoint, digest=digest) as by_file:
                culler.wait_until_open(DEADLINE_S)
                by_file.wait_until_open(DEADLINE_S)
                self.assertGreater(culler.session.upload.chunks_sent, 0)
                sets, of_file = list(self.walk(culler)), list(self.walk(by_file))
            with Culler(daemon.endpoint, scene) as second:
                second.wait_until_open(DEADLINE_S)
                self.assertEqual(second.session.upload.chunks_sent, 0)
        for (frame, ids), (_, expected) in zip(sets, of_file):
            self.assertEqual(ids.tolist(), expected.tolist(), frame)
        self.assertEqual(self.judge(self.write_sets(sets))["frames_with_wrong_pixels"], 0)

    walk = AtZeroLatency.walk

    def test_objects_move_go_and_come(self):
        wall, behind, free, spare = range(4)
        camera_from_world = camera.look_at((0, 0, 5), (0, 0, -5))
        away = np.eye(4)
        away[:3, 3] = 100, 0, 0
        with Daemon() as daemon, Culler(daemon.endpoint, cube_scene(spare=1)) as culler:
            culler.wait_until_open(DEADLINE_S)

            def ask():
                return culler.ask(camera_from_world, LENS, SIZE, timeout_s=DEADLINE_S).ids.tolist()

            self.assertEqual(ask(), [wall, free])
            self.assertEqual(culler.why(behind, timeout_s=DEADLINE_S).state, WhyState.HIDDEN)
            self.assertEqual(culler.why(behind, timeout_s=DEADLINE_S).hidden_by["id"].tolist(), [wall])
            culler.set_present([wall], False)
            self.assertEqual(ask(), [behind, free])
            self.assertEqual(culler.why(wall, timeout_s=DEADLINE_S).state, WhyState.ABSENT)
            culler.set_present([wall], True)
            culler.move([free], away)
            self.assertEqual(ask(), [wall])
            # Boxed, the wall hides nothing; the object in the spare id is in the open, then behind the wall.
            culler.set_boxes([wall, spare], [(-6, -3, -6), (2, -1, -11)], [(0, 3, -4), (4, 1, -9)])
            self.assertEqual(ask(), [wall, behind, spare])
            culler.set_boxes([spare], [(-4, -1, -11)], [(-2, 1, -9)])
            self.assertEqual(ask(), [wall])

    def test_views_of_one_session_have_answers_of_their_own(self):
        ahead, back = camera.look_at((0, 0, 5), (0, 0, -5)), camera.look_at((0, 0, 5), (0, 0, 15))
        with Daemon() as daemon, Culler(daemon.endpoint, cube_scene()) as culler:
            culler.wait_until_open(DEADLINE_S)
            for _ in range(3):
                self.assertEqual(culler.ask(ahead, LENS, SIZE, timeout_s=DEADLINE_S).ids.tolist(), [0, 2])
                self.assertEqual(culler.ask(back, LENS, SIZE, view=5, timeout_s=DEADLINE_S).ids.tolist(), [])
            self.assertEqual(culler.poll().ids.tolist(), [0, 2])

    def test_flags_mean_what_they_say(self):
        ahead = camera.look_at((0, 0, 5), (0, 0, -5))
        for flags, image, shadow in (
                (ObjectFlag.HIDES_NOTHING, [0, 1, 2], [0, 1, 2]), (ObjectFlag.OCCLUDER_ONLY, [2], [2]),
                (ObjectFlag.CASTS_NO_SHADOW, [0, 2], [1, 2]), (ObjectFlag(0), [0, 2], [0, 2])):
            with self.subTest(flags), Daemon() as daemon, Culler(daemon.endpoint, cube_scene(flags=flags)) as culler:
                culler.wait_until_open(DEADLINE_S)
                self.assertEqual(culler.ask(ahead, LENS, SIZE, timeout_s=DEADLINE_S).ids.tolist(), image)
                self.assertEqual(
                    culler.ask(ahead, LENS, SIZE, view=1, shadow_map=True, timeout_s=DEADLINE_S).ids.tolist(), shadow)

    def test_keys_let_in_who_has_them(self):
        def keygen(name):
            file = self.folder / name
            subprocess.run([executable("control_view"), "keygen", "--out", str(file)], check=True, capture_output=True,
                           timeout=DEADLINE_S)
            return file

        server, client = keygen("server.toml"), keygen("client.toml")
        with self.assertRaisesRegex(InputError, "server_public_key"):
            Culler("tcp://127.0.0.1:9", cube_scene(), keys=client)
        public = next(line for line in server.read_text().splitlines() if line.startswith("public_key"))
        with client.open("a") as out:
            out.write(f"server_{public}\n")
        with Daemon("--keys", str(server)) as daemon:
            with Culler(daemon.endpoint, cube_scene(), keys=client) as culler:
                culler.wait_until_open(DEADLINE_S)
            with Culler(daemon.endpoint, cube_scene()) as stranger, self.assertRaises(Timeout):
                stranger.wait_until_open(0.5)

    def test_a_scene_over_the_limits_is_refused_with_the_limit(self):
        with Daemon("--max-objects", "2") as daemon, Culler(daemon.endpoint, cube_scene()) as culler:
            with self.assertRaisesRegex(Refused, "at most 2"):
                culler.wait_until_open(DEADLINE_S)


if __name__ == "__main__":
    unittest.main()
