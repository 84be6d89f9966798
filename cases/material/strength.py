"""The strength of every joint, from its own keys or those of [joints]."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from cases.schema.scene import Scene

#: Strength (Pa) and opening (m) of a joint that never fails beside joints that do; its square is
#: still a number.
UNLIMITED = 1e100

KEYS = ("friction_angle", "cohesion", "residual_cohesion", "tensile_strength", "fracture_energy")


class Strength(NamedTuple):
    """Float arrays [N - 1], each None where no joint has it.

    friction : tan of the friction angle. cohesion, residual_cohesion, tensile_strength : Pa.
    critical_opening : w_c = 2 G_c / sigma_t, at which softening has used up the strength, m.
    """

    friction: np.ndarray | None
    cohesion: np.ndarray | None
    residual_cohesion: np.ndarray | None
    tensile_strength: np.ndarray | None
    critical_opening: np.ndarray | None


def strength(scene: Scene, soft: np.ndarray) -> Strength:
    """Return the strength of all joints, of which `soft` are those of the soft layers.

    Beside joints that slip, one without friction and cohesion of its own has a cohesion without
    limit; beside joints that break, one without tensile strength likewise.
    """
    if all(getattr(law, key) is None for law in (scene.joints, *scene.layers) for key in KEYS):
        return Strength(None, None, None, None, None)
    angle, cohesion, residual, limit, energy = (_per_joint(scene, soft, key) for key in KEYS)
    slips = ~(np.isnan(angle) & np.isnan(cohesion))
    never = ~slips & slips.any()
    whole = np.where(never, UNLIMITED, np.nan_to_num(cohesion))
    return Strength(
        friction=_where_given(angle, np.tan(np.radians(np.nan_to_num(angle)))),
        cohesion=whole if never.any() or not np.isnan(cohesion).all() else None,
        residual_cohesion=_where_given(residual, np.where(np.isnan(residual), whole, residual)),
        tensile_strength=_where_given(limit, np.nan_to_num(limit, nan=UNLIMITED)),
        critical_opening=_where_given(limit, np.nan_to_num(2 * energy / limit, nan=UNLIMITED)),
    )


def _per_joint(scene: Scene, soft: np.ndarray, key: str) -> np.ndarray:
    """Return a key's value at every joint [N - 1], nan where it has none."""
    values = np.full(scene.pillar.block_count - 1, _number(getattr(scene.joints, key)))
    values[soft] = [_number(getattr(layer, key)) for layer in scene.layers]
    return values


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _where_given(given: np.ndarray, filled: np.ndarray) -> np.ndarray | None:
    return None if np.isnan(given).all() else filled
