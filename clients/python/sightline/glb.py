"""Binary glTF 2.0 as a Scene: what decides visibility, and names. With json and numpy alone.

Objects are nodes with a mesh, in the order of a walk from the scene's roots, first child first: the order that
Sightline's own loader has, so that ids mean the same to it. Not read: images (MASK materials with a texture hide
nothing), skins and morph targets (their rest pose), files beside this one, sparse accessors, draco, instancing.
"""

import json
import struct

import numpy as np

from .errors import InputError
from .scene import BLEND, MASK, OPAQUE, ObjectFlag, Scene

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_MODES = {"OPAQUE": OPAQUE, "MASK": MASK, "BLEND": BLEND}
_UNSUPPORTED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing")


def read_glb(file):
    """(scene, names): a Scene and the name of each object. Raises InputError naming the file."""
    with open(file, "rb") as stream:
        data = stream.read()
    try:
        return _Reader(data).read()
    except (KeyError, IndexError, TypeError, ValueError, struct.error) as error:
        raise InputError(f"{file}: {error or type(error).__name__}") from error


class _Reader:
    def __init__(self, data):
        magic, version, length = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or version != 2 or length > len(data):
            raise InputError("not a whole glTF 2.0 binary file")
        json_length, = struct.unpack_from("<I", data, 12)
        self.doc = json.loads(data[20 : 20 + json_length])
        self.binary = memoryview(data)[28 + json_length : length]
        for name in self.doc.get("extensionsRequired", []):
            if name in _UNSUPPORTED:
                raise InputError(f"needs {name}, which is not supported")
        self.scene, self.sources = Scene(), {}

    def read(self):
        self.default_material = None
        self.cut_out = []  # by material: its holes are in a texture that is not read
        for material in self.doc.get("materials", []):
            self._add_material(material)
        placements = list(self._walk())
        used = sorted({mesh for _, mesh, _ in placements})
        for mesh in used:
            self._add_vertices(self.doc["meshes"][mesh])
        numbers = {mesh: self._add_mesh(self.doc["meshes"][mesh]) for mesh in used}
        names = []
        for node, mesh, world in placements:
            number, flags = numbers[mesh]
            self.scene.add_object(number, world, flags)
            names.append(self.doc["nodes"][node].get("name") or f"node {node}")
        return self.scene, names

    def _add_material(self, material):
        pbr = material.get("pbrMetallicRoughness", {})
        mode = _MODES[material.get("alphaMode", "OPAQUE")]
        if material.get("extensions", {}).get("KHR_materials_transmission", {}).get("transmissionFactor", 0) > 0:
            mode = BLEND
        self.cut_out.append(mode == MASK and "baseColorTexture" in pbr)
        # The holes are in a texture that is not read: drawn whole, and see _add_mesh.
        self.scene.add_material(OPAQUE if self.cut_out[-1] else mode, pbr.get("baseColorFactor", [1, 1, 1, 1])[3],
                                material.get("alphaCutoff", 0.5), double_sided=material.get("doubleSided", False))

    def _walk(self):
        """(node, mesh, world_from_object) of each node with a mesh."""
        nodes = self.doc.get("nodes", [])
        scenes = self.doc.get("scenes")
        if scenes:
            roots = scenes[self.doc.get("scene", 0)].get("nodes", [])
        else:
            children = {child for node in nodes for child in node.get("children", [])}
            roots = [i for i in range(len(nodes)) if i not in children]
        reached = set()
        pending = [(root, np.eye(4)) for root in reversed(roots)]
        while pending:
            index, parent = pending.pop()
            if index in reached or index < 0:
                raise InputError(f"node {index}: is reached twice; nodes must form a tree")
            reached.add(index)
            node = nodes[index]
            world = parent @ _local_matrix(node)
            if "mesh" in node:
                yield index, node["mesh"], world
            pending.extend((child, world) for child in reversed(node.get("children", [])))

    def _triangles(self, mesh):
        return [p for p in mesh["primitives"] if p.get("mode", 4) in (4, 5, 6)]

    def _add_vertices(self, mesh):
        for primitive in self._triangles(mesh):
            source = primitive["attributes"]["POSITION"]
            if source not in self.sources:
                self.sources[source] = self.scene.add_vertices(self._accessor(source))

    def _add_mesh(self, mesh):
        primitives, cut_out = [], False
        for primitive in self._triangles(mesh):
            source = primitive["attributes"]["POSITION"]
            if "indices" in primitive:
                indices = self._accessor(primitive["indices"]).reshape(-1).astype(np.int64)
            else:
                indices = np.arange(self.doc["accessors"][source]["count"])
            indices = _separate(primitive.get("mode", 4), indices)
            material = primitive.get("material")
            if material is None:
                if self.default_material is None:
                    self.default_material = self.scene.add_material()
                    self.cut_out.append(False)
                material = self.default_material
            cut_out = cut_out or self.cut_out[material]
            primitives.append((indices + self.sources[source], material))
        flags = ObjectFlag.HIDES_NOTHING if cut_out else ObjectFlag(0)
        return self.scene.add_primitives(primitives), flags

    def _accessor(self, index):
        accessor = self.doc["accessors"][index]
        if "sparse" in accessor or "bufferView" not in accessor:
            raise InputError(f"accessor {index}: sparse, or without a buffer view, which is not supported")
        dtype, width = np.dtype(_COMPONENTS[accessor["componentType"]]), _WIDTHS[accessor["type"]]
        view = self.doc["bufferViews"][accessor["bufferView"]]
        if view["buffer"] != 0 or "uri" in self.doc["buffers"][0]:
            raise InputError("its buffer is another file, which is not supported")
        begin = view.get("byteOffset", 0)
        data = self.binary[begin : begin + view["byteLength"]]
        stride = view.get("byteStride", dtype.itemsize * width)
        return np.ndarray((accessor["count"], width), dtype, data, accessor.get("byteOffset", 0),
                          (stride, dtype.itemsize))


def _local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    matrix = np.eye(4)
    rotation = np.array(node.get("rotation", [0, 0, 0, 1]), float)
    x, y, z, w = rotation / np.linalg.norm(rotation)
    matrix[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    matrix[:3, :3] *= node.get("scale", [1, 1, 1])
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def _separate(mode, run):
    """Strips and fans as triangles of the same winding; what is over at the end is left out."""
    if mode == 4:
        return run[: len(run) // 3 * 3]
    i = np.arange(2, len(run))
    if mode == 6:
        return np.stack((run[i - 1], run[i], np.full(len(i), run[0])), 1).reshape(-1)
    odd = i % 2
    return np.stack((run[i - 2 + odd], run[i - 1 - odd], run[i]), 1).reshape(-1)
