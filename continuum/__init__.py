"""Deformable rock by dolfinx's elements, with the joints as cohesive interfaces."""

from typing import Any

from jointwave.continuum.body.validity import applies

#: What describes rock of a script; dolfinx is imported when it is first asked for.
ROCK = ("Forms", "anisotropic", "elastic", "isotropic")
__all__ = ["applies", "simulate", *ROCK]


def __getattr__(name: str) -> Any:
    if name not in ROCK:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from jointwave.continuum.body import rock

    return getattr(rock, name)


def by_body(scene: Any) -> bool:
    """Return whether the dolfinx body runs a scene."""
    return True


def simulate(scene: Any, model: str = "jointed", dim: int | None = None, **about: Any) -> Any:
    """Simulate a scene as deformable rock, as `continuum.body.run.simulate` does."""
    from jointwave.continuum.body.run import simulate as by_dolfinx

    return by_dolfinx(scene, model, dim=dim, **about)
