"""Deformable rock by dolfinx's elements, with the joints as cohesive interfaces."""

from typing import Any

from jointwave.continuum.body.validity import applies

__all__ = ["applies", "simulate"]


def by_body(scene: Any) -> bool:
    """Return whether the dolfinx body runs a scene."""
    return True


def simulate(scene: Any, model: str = "jointed", dim: int | None = None, **about: Any) -> Any:
    """Simulate a scene as deformable rock, as `continuum.body.run.simulate` does."""
    from jointwave.continuum.body.run import simulate as by_dolfinx

    return by_dolfinx(scene, model, dim=dim, **about)
