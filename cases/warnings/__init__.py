"""Warnings of likely mistakes in a scene, one line each.

No scene is refused: unusual values may be intended. `--strict` makes each line an error.
"""

from jointwave.cases.plausible import implausible
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.warnings.pillar import warnings_of_pillar


def warnings(scene: AnyScene) -> list[str]:
    """Return warnings of probable mistakes in a scene, one line each."""
    if scene.is_column:
        found = warnings_of_pillar(scene)
    else:
        from jointwave.cases.warnings.rock_mass import warnings_in_plane  # with shapely

        found = warnings_in_plane(scene)
    if scene.damping.local and any(one.amplitude for one in scene.pulses):
        found.append(
            "damping.local distorts waves: it is meant for static states, not for a scene with a "
            "load"
        )
    return [*implausible(scene), *found]
