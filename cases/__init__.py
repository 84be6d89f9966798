"""The scene: its keys, its calibration, and the shipped scenes.

`cases.load(path)` reads a scene file and returns one validated `Scene` per variant. Validation is
imported on first use: a shell's completion does not need it.
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
    """Import `Scene`, or a function that reads scenes, on first use."""
    if name in LAZY:
        return getattr(import_module(f"{__name__}.{LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
