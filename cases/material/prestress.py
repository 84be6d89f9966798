"""Whether the joints of a rock mass carry its prestress."""

from math import inf, radians, tan

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.partition.joints import attitude
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.plane import InSituStress

SLACK = 1e-9  # of the stress: tractions that are at a limit


def refuse_beyond_strength(scene: AnyScene) -> None:
    """Raise SceneError where a joint opens or slides under the prestress: the scene would not start
    in equilibrium."""
    if scene.is_column or scene.prestress is None:
        return
    for one in scene.joint_sets:
        if what := beyond_strength(one, scene.prestress):
            allowed = f"exceeds the strength of a joint: '{one.name}' {what} under it"
            raise SceneError(scene.where, "prestress", None, allowed)


def beyond_strength(joint: JointSet, stress: InSituStress) -> str | None:
    """Return whether a joint "opens" or "slides" under a stress, None if it carries it."""
    sigma = stress.tensor
    normal, _ = attitude(joint, len(sigma))
    traction = sigma @ normal
    t_n, slack = float(normal @ traction), SLACK * np.abs(sigma).max()
    t_s = float(np.linalg.norm(traction - t_n * normal))
    tensile = inf if joint.tensile_strength is None else joint.tensile_strength
    if t_n < -slack - (0.0 if joint.tension is False else tensile):
        return "opens"
    if joint.friction_angle is None and joint.cohesion is None:
        return None
    limit = (joint.cohesion or 0.0) + t_n * tan(radians(joint.friction_angle or 0.0))
    return "slides" if t_s > max(limit, 0.0) + slack else None
