"""Simulation by rigid blocks, with only the degrees of freedom that the scene needs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import xarray as xr

from jointwave.cases.effects import is_spatial
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.damping import NOT_OF_BLOCKS
from jointwave.cases.schema.scene import Scene
from jointwave.dem.axial.simulate import simulate as along_axis
from jointwave.dem.spatial.simulate import simulate as in_space
from jointwave.numerics.time_loop import Checkpointer

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField


def simulate(
    scene: AnyScene,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
    incident: IncidentField | None = None,
) -> xr.Dataset:
    """Simulate a scene with rigid blocks.

    progress : called with the finished fraction. keeper : of checkpoints,
    `numerics.time_loop`. incident : of a rock mass, the field that enters through quiet sides;
    absent: that of its waves in rock without joints.

    Raises SceneError for an unstable step, a static state that does not exist, rotations too
    large for their kinematics and a quality factor; StoppedError, an
    UnstableError with the result so far, when the motion leaves its bounds.
    """
    if (quality := scene.rock.quality_factor) is not None:
        raise SceneError(scene.where, "rock.quality_factor", quality, NOT_OF_BLOCKS)
    if not isinstance(scene, Scene):
        from jointwave.dem.run import (
            simulate as rock_mass,  # with shapely, which no pillar needs
        )

        return rock_mass(scene, progress, keeper, incident)
    if is_spatial(scene):
        return in_space(scene, progress, keeper)
    return along_axis(scene, progress, keeper)
