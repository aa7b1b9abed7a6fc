"""Scenes as bytes, their digests, GLB files and camera matrices."""

import hashlib
import json
import math
import pathlib
import struct
import tempfile
import unittest

import support  # noqa: F401

import numpy as np

from sightline import camera
from sightline.errors import InputError
from sightline.glb import read_glb
from sightline.scene import (BLEND, MASK, MATERIAL, MESH, OBJECT, PRIMITIVE, ObjectFlag, Scene)
from sightline.table import Buffer

TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]


def small_scene():
    scene = Scene()
    texture = scene.add_alpha_texture([[0, 255, 7], [1, 2, 3]], repeat_u=False)
    plain = scene.add_material()
    leaves = scene.add_material(MASK, 0.75, 0.25, texture, double_sided=True)
    glass = scene.add_material(BLEND, 0.5)
    one = scene.add_mesh(TRIANGLE, material=plain)
    two = scene.add_mesh([*TRIANGLE, (1, 1, 0)], [0, 1, 2, 2, 1, 3], leaves, uvs=[(0, 0), (1, 0), (0, 1), (1, 1)])
    first = scene.add_vertices(TRIANGLE)
    many = scene.add_primitives([([first, first + 1, first + 2], glass), ([0, 1, 2], plain)])
    place = np.eye(4)
    place[:3, 3] = 10, 20, 30
    place[0, 1] = 0.5
    scene.add_object(one)
    scene.add_object(two, place, ObjectFlag.HIDES_NOTHING | ObjectFlag.CASTS_NO_SHADOW)
    scene.add_object(many, group=4)
    scene.add_object(one, place, group=4)
    scene.spare_objects = 2
    return scene


class SceneBytes(unittest.TestCase):
    def setUp(self):
        self.data = small_scene().data()
        self.table = Buffer(self.data.bytes).root(b"SLSD")

    def numbers(self, slot, dtype):
        return np.frombuffer(self.table.vector(slot, np.dtype(dtype).itemsize, 4, "list"), dtype)

    def test_hold_what_was_described(self):
        self.assertEqual(len(self.data.bytes) % 4, 0)
        self.assertEqual(self.numbers(0, "<f4").reshape(-1, 3)[:3].tolist(), [list(map(float, v)) for v in TRIANGLE])
        self.assertEqual(self.numbers(1, "<f4").reshape(-1, 2)[3:7].tolist(), [[0, 0], [1, 0], [0, 1], [1, 1]])
        self.assertEqual(self.numbers(2, "<u4").tolist(), [0, 1, 2, 3, 4, 5, 5, 4, 6, 7, 8, 9, 0, 1, 2])
        self.assertEqual(self.table.structs(3, PRIMITIVE, "").tolist(), [(0, 3, 0), (3, 6, 1), (9, 3, 2), (12, 3, 0)])
        self.assertEqual(self.table.structs(4, MESH, "").tolist(), [(0, 1), (1, 1), (2, 2)])
        self.assertEqual(self.table.structs(5, MATERIAL, "").tolist(),
                         [(1.0, 0.5, 0xFFFFFFFF, 0, 0), (0.75, 0.25, 0, 1, 1), (0.5, 0.5, 0xFFFFFFFF, 2, 0)])
        objects = self.table.structs(7, OBJECT, "")
        self.assertEqual(objects["mesh"].tolist(), [0, 1, 2, 0])
        self.assertEqual(objects["flags"].tolist(), [0, 5, 0, 0])
        self.assertEqual(objects["group"].tolist(), [0, 0, 4, 4])
        self.assertEqual(objects["world_from_object"][1].tolist(), [1, 0, 0, 0.5, 1, 0, 0, 0, 1, 10, 20, 30])
        self.assertEqual(self.table.scalar(8, struct.Struct("<I"), 0, ""), 2)

    def test_hold_textures(self):
        vector = self.table.target(6, "textures")
        at = vector + 4 + struct.unpack_from("<I", self.data.bytes, vector + 4)[0]
        texture = self.table.buffer.table_at(at, "texture")
        self.assertEqual([texture.scalar(i, struct.Struct("<I"), 0, "") for i in (0, 1)], [3, 2])
        self.assertEqual([texture.scalar(i, struct.Struct("?"), False, "") for i in (2, 3)], [False, True])
        self.assertEqual(texture.vector(4, 1, 1, ""), bytes([0, 255, 7, 1, 2, 3]))

    def test_are_those_of_the_cpp_client(self):
        # What encode_scene_data of protocol/scene_data.cpp and offer_of give for this very scene.
        self.assertEqual(self.data.digest.hex(), "237134cbe013033c10cadf91c3dca4e5")

    def test_are_the_same_for_the_same_scene_and_others_for_another(self):
        again = small_scene()
        for _ in range(20):
            dirt = [np.full(size, 255, np.uint8) for size in range(16, 1024, 16)]
            del dirt
            self.assertEqual(again.data().digest, self.data.digest)
        again.spare_objects = 3
        self.assertNotEqual(again.data().digest, self.data.digest)

    def test_counts_include_shared_meshes_and_spare_ids(self):
        self.assertEqual((self.data.object_count, self.data.triangle_count), (6, 1 + 2 + 2 + 1))

    def test_digests_are_those_of_the_protocol(self):
        scene = Scene()
        mesh = scene.add_mesh(np.arange(300_000.0).reshape(-1, 3)[: 99_999])
        scene.add_object(mesh)
        data = scene.data()
        size = 262_144
        chunks = [data.bytes[i : i + size] for i in range(0, len(data.bytes), size)]
        self.assertGreater(len(chunks), 4)
        digests = b"".join(hashlib.blake2b(chunk, digest_size=16).digest() for chunk in chunks)
        self.assertEqual(data.offer.chunk_digests, digests)
        tail = struct.pack("<QIQ", len(data.bytes), 1, 33_333)
        self.assertEqual(data.digest, hashlib.blake2b(digests + tail, digest_size=16).digest())
        self.assertEqual(b"".join(data.chunk(i) for i in range(len(chunks))), data.bytes)

    def test_what_cannot_be_is_refused_with_its_name(self):
        scene = Scene()
        mesh = scene.add_mesh(TRIANGLE)
        nan = np.eye(4)
        nan[0, 3] = math.nan
        for wrong, name in ((lambda: scene.add_mesh(TRIANGLE, [0, 1, 3]), "indices"),
                            (lambda: scene.add_mesh(TRIANGLE, [0, 1]), "indices"),
                            (lambda: scene.add_mesh([(math.inf, 0, 0)] * 3), "positions"),
                            (lambda: scene.add_object(mesh + 1), "mesh"),
                            (lambda: scene.add_object(mesh, nan), "world"),
                            (lambda: scene.add_object(mesh, np.zeros((4, 4))), "world"),
                            (lambda: scene.add_material(texture=0), "texture"),
                            (lambda: scene.add_mesh(TRIANGLE, material=3), "material"),
                            (lambda: scene.add_mesh(TRIANGLE, uvs=[(0, 0)]), "uvs")):
            with self.assertRaisesRegex(InputError, name):
                wrong()


def write_glb(file, nodes, scene_nodes, extra=None):
    positions = np.array(TRIANGLE + [(1, 1, 0)], "<f4").tobytes()
    indices = np.array([0, 1, 2, 3], "<u2").tobytes()
    doc = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": scene_nodes}], "nodes": nodes,
           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]},
                      {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 5, "material": 0}]}],
           "materials": [{"alphaMode": "BLEND", "doubleSided": True}],
           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                         {"bufferView": 1, "componentType": 5123, "count": 4, "type": "SCALAR"}],
           "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                           {"buffer": 0, "byteOffset": 48, "byteLength": 8}],
           "buffers": [{"byteLength": 56}]}
    doc.update(extra or {})
    text = json.dumps(doc).encode()
    text += b" " * (-len(text) % 4)
    binary = positions + indices
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    pathlib.Path(file).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


class GlbFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "scene.glb"

    def test_place_nodes_first_child_first(self):
        turn = [0, math.sin(math.pi / 4), 0, math.cos(math.pi / 4)]  # +X to -Z
        write_glb(self.file, [
            {"name": "root", "translation": [10, 0, 0], "rotation": turn, "children": [2, 1]},
            {"name": "second", "mesh": 0, "translation": [1, 0, 0], "scale": [2, 2, 2]}, {"name": "first", "mesh": 1},
            {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}], [0, 3])
        scene, names = read_glb(self.file)
        self.assertEqual(names, ["first", "second", "node 3"])
        worlds = [np.array(w).reshape(4, 3).T for w, *_ in scene._objects]
        np.testing.assert_allclose(worlds[1][:, 3], [10, 0, -1], atol=1e-12)
        np.testing.assert_allclose(worlds[1][:, 0], [0, 0, -2], atol=1e-12)
        self.assertEqual(worlds[2][:, 3].tolist(), [5, 6, 7])
        data = scene.data()
        self.assertEqual(data.triangle_count, 2 + 1 + 1)  # a strip of four; four loose vertices are one triangle

    def test_strips_keep_their_winding(self):
        write_glb(self.file, [{"mesh": 1}], [0])
        scene, _ = read_glb(self.file)
        corners = np.concatenate(scene._positions)[np.concatenate(scene._indices)].reshape(-1, 3, 3)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.assertEqual(np.sign(normals[:, 2]).tolist(), [1, 1])

    def test_that_are_none_are_refused_by_name(self):
        for content in (b"", b"glTF", b"glTF" + bytes(40), struct.pack("<4sIIII", b"glTF", 2, 20, 0, 0)):
            self.file.write_bytes(content)
            with self.assertRaisesRegex(InputError, "scene.glb"):
                read_glb(self.file)
        for nodes, roots in (([{"mesh": 7}], [0]), ([{"children": [0]}], [0]), ([{"mesh": 0}], [3])):
            write_glb(self.file, nodes, roots)
            with self.assertRaisesRegex(InputError, "scene.glb"):
                read_glb(self.file)
        write_glb(self.file, [{"mesh": 0}], [0], {"accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4000, "type": "VEC3"}]})
        with self.assertRaisesRegex(InputError, "scene.glb"):
            read_glb(self.file)


class Cameras(unittest.TestCase):
    def test_perspective_maps_near_far_and_edges(self):
        for far in (50.0, math.inf):
            clip = camera.perspective(math.pi / 2, 2.0, 0.5, far)
            near = clip @ (1.0, 0.5, -0.5, 1.0)
            np.testing.assert_allclose(near / near[3], (1, 1, -1, 1))
            distant = clip @ (0, 0, -min(far, 1e12), 1.0)
            self.assertAlmostEqual(distant[2] / distant[3], 1.0)

    def test_other_depth_ranges_become_opengls(self):
        near, far = 0.5, 50.0
        gl = camera.perspective(1.0, 1.5, near, far)
        zero_to_one = gl.copy()
        zero_to_one[2] = 0.5 * (gl[2] + gl[3])
        np.testing.assert_allclose(camera.from_zero_to_one(zero_to_one), gl)
        reversed_z = gl.copy()
        reversed_z[2] = 0.5 * (gl[3] - gl[2])
        np.testing.assert_allclose(camera.from_zero_to_one(reversed_z, True), gl)
        infinite_reversed = camera.perspective(1.0, 1.5, near)
        expected = infinite_reversed.copy()
        infinite_reversed[2] = (0, 0, 0, near)
        np.testing.assert_allclose(camera.from_zero_to_one(infinite_reversed, True), expected)

    def test_look_at_and_pose_agree(self):
        m = camera.look_at((1, 2, 3), (1, 2, -5))
        np.testing.assert_allclose(m, camera.camera_from_pose((1, 2, 3), (1, 0, 0, 0)), atol=1e-15)
        half = math.sqrt(0.5)  # a quarter turn to the left: looks along -X
        np.testing.assert_allclose(camera.camera_from_pose((1, 2, 3), (half, 0, half, 0)),
                                   camera.look_at((1, 2, 3), (-9, 2, 3)), atol=1e-15)

    def test_paths_go_straight_and_turn_evenly(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "path.csv"
            file.write_text(f"t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,4,0,0,0,0,2,0\n")
            path = camera.CameraPath(file)
            half = math.pi / 8
            np.testing.assert_allclose(path.at(0.25), camera.camera_from_pose(
                (1, 0, 0), (math.cos(half), 0, math.sin(half), 0)), atol=1e-12)
            np.testing.assert_allclose(path.at(9.0), camera.camera_from_pose((4, 0, 0), (0, 0, 1, 0)))
            self.assertEqual(path.duration_s, 1.0)


if __name__ == "__main__":
    unittest.main()
