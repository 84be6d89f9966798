"""Deformable rock by dolfinx's elements, with the joints as cohesive interfaces."""

from typing import Any

from jointwave.continuum.body.validity import applies
from jointwave.continuum.simulate import simulate as by_tables

__all__ = ["applies", "simulate"]


def by_body(scene: Any, comm: Any = None) -> bool:
    """Return whether the dolfinx body runs a scene."""
    return comm is None or comm.size == 1


def simulate(scene: Any, model: str = "jointed", dim: int | None = None, **about: Any) -> Any:
    """Simulate a scene as deformable rock, as `continuum.body.run.simulate` does."""
    if by_body(scene, about.get("comm")):
        from jointwave.continuum.body.run import simulate as by_dolfinx

        return by_dolfinx(scene, model, dim=dim, **{k: v for k, v in about.items() if k != "comm"})
    return by_tables(scene, model, dim, **about)
