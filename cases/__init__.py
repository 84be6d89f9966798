"""What is simulated: the scene vocabulary, its calibration, and the scenes themselves.

`cases.load(path)` reads a scene file and returns one validated `Scene` per variant.
"""

from cases.errors import SceneError, UnstableError
from cases.read import load, load_variant
from cases.schema.scene import Scene

__all__ = ["Scene", "SceneError", "UnstableError", "load", "load_variant"]
