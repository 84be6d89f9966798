"""Deformable rock as a dolfinx model, with the joints as cohesive interfaces."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from jointwave.continuum.validity import applies

if TYPE_CHECKING:
    from jointwave.continuum.run import simulate
    from jointwave.continuum.space.rock import Forms, anisotropic, elastic, isotropic
    from jointwave.continuum.xdmf import write_xdmf

#: The module of each name that needs dolfinx; it is imported at the first access.
MODULES = dict.fromkeys(("Forms", "anisotropic", "elastic", "isotropic"), "space.rock")
MODULES |= {"simulate": "run", "write_xdmf": "xdmf"}
__all__ = ["Forms", "anisotropic", "applies", "elastic", "isotropic", "simulate", "write_xdmf"]


def __getattr__(name: str) -> Any:
    """Import and return a name that needs dolfinx."""
    if name not in MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{MODULES[name]}"), name)
