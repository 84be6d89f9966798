"""Warnings of likely mistakes in a scene, one line each.

No scene is refused: unusual values may be intended. `--strict` makes each line an error.
"""

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.cases.warnings.pillar import warnings_of_pillar


def warnings(scene: AnyScene) -> list[str]:
    """Return warnings of probable mistakes in a scene, one line each."""
    if isinstance(scene, Scene):
        return warnings_of_pillar(scene)
    from jointwave.cases.warnings.rock_mass import warnings_in_plane  # with shapely

    return warnings_in_plane(scene)
