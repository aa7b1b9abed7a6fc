"""Matrices of cameras. m[row, column], acting on column vectors; OpenGL clip space, -w to w on every axis; a camera
looks down its own -Z, +X is right, +Y up."""

import math

import numpy as np


def perspective(vertical_fov_rad, aspect, near_m, far_m=math.inf):
    """clip_from_camera of a symmetric field; `aspect` is width / height."""
    half = math.tan(vertical_fov_rad / 2.0)
    m = np.zeros((4, 4))
    m[0, 0] = 1.0 / (aspect * half)
    m[1, 1] = 1.0 / half
    m[3, 2] = -1.0
    if math.isinf(far_m):
        m[2, 2], m[2, 3] = -1.0, -2.0 * near_m
    else:
        m[2, 2] = -(far_m + near_m) / (far_m - near_m)
        m[2, 3] = -(2.0 * far_m * near_m) / (far_m - near_m)
    return m


def orthographic(left, right, bottom, top, near_m, far_m):
    """clip_from_camera of a box, for a light that shines in parallel."""
    m = np.diag([2.0 / (right - left), 2.0 / (top - bottom), -2.0 / (far_m - near_m), 1.0])
    m[0, 3] = -(right + left) / (right - left)
    m[1, 3] = -(top + bottom) / (top - bottom)
    m[2, 3] = -(far_m + near_m) / (far_m - near_m)
    return m


def from_zero_to_one(clip_from_camera, reversed_z=False):
    """OpenGL's clip_from_camera of one whose depth runs from 0 (near) to w (far), as in Direct3D, Vulkan and Metal,
    or from w to 0 with reversed_z. An infinite far plane stays one."""
    to_gl = np.eye(4)
    to_gl[2, 2:] = (-2.0, 1.0) if reversed_z else (2.0, -1.0)
    return to_gl @ np.asarray(clip_from_camera, float)


def from_z_up(world_z_up):
    """Placement or pose of a world whose Z is up (x, y, z) in one whose Y is up (x, z, -y)."""
    turn = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    return turn @ np.asarray(world_z_up, float)


def camera_from_pose(position_m, world_from_camera):
    """camera_from_world of a place and a unit quaternion (w, x, y, z) that turns camera to world directions."""
    w, x, y, z = (float(v) for v in world_from_camera)
    x, y, z = -x, -y, -z
    rotation = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    px, py, pz = (float(v) for v in position_m)
    m = np.eye(4)
    m[:3, :3] = rotation
    m[:3, 3] = -(rotation[:, 0] * px + rotation[:, 1] * py + rotation[:, 2] * pz)
    return m


def look_at(eye_m, target_m, up=(0.0, 1.0, 0.0)):
    """camera_from_world of a camera at `eye_m` that looks at `target_m`."""
    eye = np.asarray(eye_m, float)
    back = eye - np.asarray(target_m, float)
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    m = np.eye(4)
    m[:3, :3] = right, np.cross(back, right), back
    m[:3, 3] = -(m[:3, :3] @ eye)
    return m


class CameraPath:
    """Poses over time, of a CSV file t,px,py,pz,qw,qx,qy,qz: seconds, metres, camera to world."""

    def __init__(self, file):
        rows = np.atleast_2d(np.loadtxt(file, delimiter=",", skiprows=1))
        if rows.shape[1] != 8 or not np.all(np.isfinite(rows)) or np.any(np.diff(rows[:, 0]) <= 0):
            raise ValueError(f"{file}: must have the columns t,px,py,pz,qw,qx,qy,qz and times that grow")
        self.times, self.positions = rows[:, 0], rows[:, 1:4]
        lengths = np.array([math.sqrt((w * w + x * x) + (y * y + z * z)) for w, x, y, z in rows[:, 4:]])
        lengths[np.abs(lengths - 1.0) < 1e-15] = 1.0
        self.rotations = rows[:, 4:] / lengths[:, None]

    @property
    def duration_s(self):
        return float(self.times[-1])

    def at(self, time_s):
        """camera_from_world: along a line between samples, turning at an even speed."""
        after = int(np.searchsorted(self.times, time_s - 1e-9))
        if after == len(self.times):
            return camera_from_pose(self.positions[-1], self.rotations[-1])
        if after == 0 or self.times[after] <= time_s + 1e-9:
            return camera_from_pose(self.positions[after], self.rotations[after])
        a, b = after - 1, after
        share = (time_s - self.times[a]) / (self.times[b] - self.times[a])
        position = self.positions[a] * (1.0 - share) + self.positions[b] * share
        return camera_from_pose(position, _slerp(self.rotations[a], self.rotations[b], share))


def _slerp(a, b, share):
    """Shoemake, "Animating rotation with quaternion curves", 1985; the shorter way round."""
    cosine = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
    if cosine < 0.0:
        b, cosine = -b, -cosine
    if cosine > 1.0 - np.finfo(float).eps:
        q = a * (1.0 - share) + b * share
    else:
        angle = math.acos(cosine)
        q = (math.sin((1.0 - share) * angle) * a + math.sin(share * angle) * b) / math.sin(angle)
    return q * (1.0 / math.sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3])))
