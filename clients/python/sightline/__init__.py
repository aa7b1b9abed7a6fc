"""Which objects of a scene can be seen: a client of Sightline's visibility daemon, in Python. See `Culler`."""

from .camera import CameraPath, camera_from_pose, from_zero_to_one, look_at, orthographic, perspective
from .culler import Culler, Visible
from .errors import InputError, ProtocolError, Refused, SightlineError, Timeout
from .glb import read_glb
from .messages import WhyState
from .scene import BLEND, MASK, OPAQUE, ObjectFlag, Scene, SceneData
from .session import State

__all__ = ["BLEND", "CameraPath", "Culler", "InputError", "MASK", "OPAQUE", "ObjectFlag", "ProtocolError", "Refused",
           "Scene", "SceneData", "SightlineError", "State", "Timeout", "Visible", "WhyState", "camera_from_pose",
           "from_zero_to_one", "look_at", "orthographic", "perspective", "read_glb"]
