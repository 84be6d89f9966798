"""The scene: its vocabulary, its calibration, and the shipped scenes.

`cases.load(path)` reads a scene file and returns one validated `Scene` per variant.
"""

from cases.errors import SceneError, UnstableError
from cases.read import load, load_variant
from cases.schema.scene import Scene

__all__ = ["Scene", "SceneError", "UnstableError", "load", "load_variant"]
