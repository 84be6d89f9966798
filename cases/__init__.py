"""The scene: its vocabulary, its calibration, and the shipped scenes.

`cases.load(path)` reads a scene file and returns one validated `Scene` per variant.
What validates it is imported when it is asked for: a shell's completion needs none of it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from jointwave.cases.errors import SceneError, UnstableError

if TYPE_CHECKING:
    from jointwave.cases.read import load, load_tables, load_variant
    from jointwave.cases.schema.scene import Scene

__all__ = ["Scene", "SceneError", "UnstableError", "load", "load_tables", "load_variant"]
LAZY = dict.fromkeys(("load", "load_tables", "load_variant"), "read") | {"Scene": "schema.scene"}


def __getattr__(name: str) -> Any:
    """Return the class of scenes, or a function that reads them."""
    if name in LAZY:
        return getattr(import_module(f"{__name__}.{LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
