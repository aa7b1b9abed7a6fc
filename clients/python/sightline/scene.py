"""Describing a scene, and the bytes that carry it to the daemon.

A scene is meshes (triangles with a material), and objects that place them. An object's id is its place in the
order in which objects were added. World frame: right-handed, Y up, metres. Triangles are wound counter-clockwise
seen from their front; the back of a single-sided one is not there.

    scene = Scene()
    wall = scene.add_mesh(positions, indices)
    first = scene.add_object(wall)                        # id 0
    second = scene.add_object(wall, world_from_object)    # id 1, the same geometry elsewhere
    data = scene.data()                                   # bytes, digest, offer
"""

import hashlib
from enum import IntFlag
from functools import cached_property

import flatbuffers
import numpy as np

from .checks import CHUNK_BYTES, MAX_OBJECTS, chunk_count_of
from .errors import InputError
from .messages import SceneOffer
from .wire import write_structs

NO_TEXTURE = 0xFFFFFFFF
OPAQUE, MASK, BLEND = 0, 1, 2

PRIMITIVE = np.dtype([("first_index", "<u4"), ("index_count", "<u4"), ("material", "<u4")], align=True)
MESH = np.dtype([("first_primitive", "<u4"), ("primitive_count", "<u4")], align=True)
MATERIAL = np.dtype({"names": ["base_alpha", "alpha_cutoff", "texture", "alpha_mode", "double_sided"],
                     "formats": ["<f4", "<f4", "<u4", "u1", "u1"], "offsets": [0, 4, 8, 12, 13], "itemsize": 16},
                    align=True)
OBJECT = np.dtype({"names": ["world_from_object", "mesh", "flags", "group"],
                   "formats": [("<f8", 12), "<u4", "<u4", "<u4"], "offsets": [0, 96, 100, 104], "itemsize": 112},
                  align=True)


class ObjectFlag(IntFlag):
    """What an object is to the visibility test."""

    HIDES_NOTHING = 1  # tested, never an occluder: blended, or cut out by a texture that is not given
    OCCLUDER_ONLY = 2  # a proxy: hides what is behind it and is in no set
    CASTS_NO_SHADOW = 4  # neither hides nor is reported in a view for a shadow map
    ALWAYS_VISIBLE = 8  # drawn whatever the sets say


class Scene:
    """Collects a scene. Every call copies what it is given."""

    def __init__(self):
        self._positions, self._uvs, self._indices = [], [], []
        self._vertex_count = self._index_count = 0
        self._primitives, self._meshes, self._materials, self._textures, self._objects = [], [], [], [], []
        self.spare_objects = 0  # ids without geometry after those of the objects, for what is added later

    def __len__(self):
        """Ids: objects and spare ones."""
        return len(self._objects) + self.spare_objects

    def add_alpha_texture(self, alpha, repeat_u=True, repeat_v=True):
        """`alpha`: uint8, rows from the top. Returns its number."""
        alpha = np.ascontiguousarray(alpha, np.uint8)
        if alpha.ndim != 2 or alpha.size == 0:
            raise InputError("alpha: must be rows of uint8, at least one texel")
        self._textures.append((alpha, repeat_u, repeat_v))
        return len(self._textures) - 1

    def add_material(self, alpha_mode=OPAQUE, base_alpha=1.0, alpha_cutoff=0.5, texture=NO_TEXTURE,
                     double_sided=False):
        """MASK: a fragment with alpha below alpha_cutoff does not exist. BLEND: it hides nothing."""
        if alpha_mode not in (OPAQUE, MASK, BLEND):
            raise InputError("alpha_mode: must be OPAQUE, MASK or BLEND")
        if texture != NO_TEXTURE and not 0 <= texture < len(self._textures):
            raise InputError(f"texture: there is no texture {texture}")
        self._materials.append((base_alpha, alpha_cutoff, texture, alpha_mode, double_sided))
        return len(self._materials) - 1

    def add_vertices(self, positions, uvs=None):
        """Vertices that several primitives may share, mesh frame. Returns the number of the first."""
        positions = np.array(positions, np.float32).reshape(-1, 3)
        if not np.all(np.isfinite(positions)):
            raise InputError("positions: not finite")
        if uvs is not None:
            uvs = np.array(uvs, np.float32).reshape(-1, 2)
            if len(uvs) != len(positions):
                raise InputError("uvs: not one a vertex")
        first = self._vertex_count
        self._positions.append(positions)
        self._uvs.append(uvs)
        self._vertex_count += len(positions)
        return first

    def add_primitives(self, primitives):
        """A mesh of (indices, material) pairs; indices count from the scene's first vertex."""
        first = len(self._primitives)
        for indices, material in primitives:
            indices = np.array(indices, np.uint32).reshape(-1)
            if len(indices) % 3:
                raise InputError("indices: not three a triangle")
            if len(indices) and indices.max() >= self._vertex_count:
                raise InputError("indices: a vertex that is not there")
            if not 0 <= material < max(1, len(self._materials)):
                raise InputError(f"material: there is no material {material}")
            self._primitives.append((self._index_count, len(indices), material))
            self._indices.append(indices)
            self._index_count += len(indices)
        self._meshes.append((first, len(self._primitives) - first))
        return len(self._meshes) - 1

    def add_mesh(self, positions, indices=None, material=0, uvs=None):
        """A mesh of its own vertices and one material. Without indices every three vertices are a triangle."""
        positions = np.asarray(positions, np.float32).reshape(-1, 3)
        indices = np.arange(len(positions)) if indices is None else np.asarray(indices).reshape(-1)
        if len(indices) and (indices.min() < 0 or indices.max() >= len(positions)):
            raise InputError("indices: a vertex that is not there")
        return self.add_primitives([(indices + self.add_vertices(positions, uvs), material)])

    def add_object(self, mesh, world_from_object=None, flags=ObjectFlag(0), group=0):
        """Returns its id. `world_from_object`: 4x4, m[row, column], affine. `group`: levels of detail share one."""
        if not 0 <= mesh < len(self._meshes):
            raise InputError(f"mesh: there is no mesh {mesh}")
        if self.spare_objects or len(self._objects) + 1 >= MAX_OBJECTS:
            raise InputError("objects: no more once spare_objects is set")
        self._objects.append((placement(world_from_object), mesh, int(flags), group))
        return len(self._objects) - 1

    def data(self):
        """The scene's bytes and what is told of them. Equal scenes, made in the same way, have equal bytes."""
        return SceneData(self)


def placement(matrix):
    """Twelve numbers, column by column, of an affine 4x4 matrix m[row, column]; None is the identity."""
    matrix = np.eye(4) if matrix is None else np.asarray(matrix, float)
    if matrix.shape != (4, 4) or not np.all(np.isfinite(matrix)) or not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise InputError("world_from_object: must be a finite 4x4 matrix with the last row 0 0 0 1")
    return matrix[:3].T.reshape(12)


class SceneData:
    """A scene that no longer changes: `bytes`, and `offer` with the digests of its chunks and of the whole."""

    def __init__(self, scene):
        objects = np.array(scene._objects, OBJECT) if scene._objects else np.zeros(0, OBJECT)
        primitives = np.array(scene._primitives, PRIMITIVE)
        meshes = np.array(scene._meshes, MESH)
        triangles = np.concatenate(([0], np.cumsum(primitives["index_count"].astype(np.uint64) // 3)))
        first = meshes["first_primitive"].astype(np.int64)
        of_mesh = triangles[first + meshes["primitive_count"]] - triangles[first]
        self.object_count = len(scene)
        self.triangles = np.zeros(self.object_count, np.int64)  # of each object; spare ids have none
        self.triangles[: len(objects)] = of_mesh[objects["mesh"]]
        self.triangle_count = int(self.triangles.sum())
        self.flags = objects["flags"].copy()
        self.groups = objects["group"].copy()
        self.bytes = _encode(scene, primitives, meshes, objects)

    def chunk(self, index):
        return self.bytes[index * CHUNK_BYTES : (index + 1) * CHUNK_BYTES]

    @property
    def digest(self):
        return self.offer.scene_digest

    @cached_property
    def offer(self):
        count = chunk_count_of(len(self.bytes))
        digests = b"".join(digest_of(self.chunk(i)) for i in range(count))
        sizes = len(self.bytes).to_bytes(8, "little") + self.object_count.to_bytes(4, "little") \
            + self.triangle_count.to_bytes(8, "little")
        return SceneOffer(scene_digest=digest_of(digests + sizes), byte_count=len(self.bytes),
                          object_count=self.object_count, triangle_count=self.triangle_count, chunk_digests=digests)


def digest_of(data):
    return hashlib.blake2b(data, digest_size=16).digest()


def _joined(parts, dtype):
    parts = [part.reshape(-1) for part in parts]
    return np.concatenate(parts).astype(dtype, copy=False) if parts else np.zeros(0, dtype)


def _encode(scene, primitives, meshes, objects):
    """One FlatBuffers buffer of protocol/scene_data.fbs, in the order in which the C++ client writes it."""
    uvs = []
    if any(part is not None for part in scene._uvs):
        uvs = [np.zeros((len(p), 2), "<f4") if uv is None else uv for p, uv in zip(scene._positions, scene._uvs)]
    materials = np.array(scene._materials or [(1.0, 0.5, NO_TEXTURE, OPAQUE, False)], MATERIAL)

    builder = flatbuffers.Builder(1024 + 12 * scene._vertex_count + 4 * scene._index_count + objects.nbytes)
    textures = [_texture(builder, *texture) for texture in scene._textures]
    alpha_textures = _tables(builder, textures)
    positions = _numbers(builder, _joined(scene._positions, "<f4"))
    uv_list = _numbers(builder, _joined(uvs, "<f4"))
    indices = builder.CreateNumpyVector(_joined(scene._indices, "<u4"))
    lists = [write_structs(builder, array) for array in (primitives, meshes, materials, objects)]
    builder.StartObject(9)
    builder.PrependUint32Slot(8, scene.spare_objects, 0)
    targets = [positions, uv_list, indices, *lists[:3], alpha_textures, lists[3]]
    for slot in reversed(range(8)):
        builder.PrependUOffsetTRelativeSlot(slot, targets[slot], 0)
    builder.Finish(builder.EndObject(), b"SLSD")
    return bytes(builder.Output())


def _numbers(builder, array):
    return builder.CreateNumpyVector(array) if len(array) else 0


def _tables(builder, tables):
    if not tables:
        return 0
    builder.StartVector(4, len(tables), 4)
    for table in reversed(tables):
        builder.PrependUOffsetTRelative(table)
    return builder.EndVector()


def _texture(builder, alpha, repeat_u, repeat_v):
    data = builder.CreateByteVector(alpha.tobytes())
    builder.StartObject(5)
    builder.PrependUOffsetTRelativeSlot(4, data, 0)
    builder.PrependUint32Slot(1, alpha.shape[0], 0)
    builder.PrependUint32Slot(0, alpha.shape[1], 0)
    builder.PrependBoolSlot(3, repeat_v, False)
    builder.PrependBoolSlot(2, repeat_u, False)
    return builder.EndObject()
