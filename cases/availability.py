"""What the vocabulary can say and no engine can simulate yet: refused, never ignored."""

from collections.abc import Iterator

from cases.errors import SceneError
from cases.scene import JointLaw, Scene

JOINT_KEYS = (
    "friction_angle",
    "cohesion",
    "tensile_strength",
    "fracture_energy",
    "contact_points",
    "point_rule",
)


def refuse_unavailable(scene: Scene, where: str) -> None:
    """Raise SceneError for the first key whose physics is not built."""
    for key, value in _unavailable(scene):
        raise SceneError(where, key, value, "not available yet")


def _unavailable(scene: Scene) -> Iterator[tuple[str, object]]:
    yield from _joint_keys("joints", scene.joints)
    for i, layer in enumerate(scene.soft_layers):
        yield from _joint_keys(f"soft_layers[{i}]", layer)
        if layer.thickness is not None:
            yield f"soft_layers[{i}].thickness", layer.thickness
    if scene.load.direction != [0, 1, 0]:
        yield "load.direction", scene.load.direction
    if scene.load.at != [0, 0]:
        yield "load.at", scene.load.at
    if scene.ends.start == "fixed":
        yield "ends.start", scene.ends.start
    if scene.gravity is not None:
        yield "gravity", scene.gravity.acceleration
    if scene.prestress is not None:
        yield "prestress", scene.prestress.normal
    if scene.numerics.continuum.scheme == "implicit":
        yield "numerics.continuum.scheme", "implicit"


def _joint_keys(table: str, law: JointLaw) -> Iterator[tuple[str, object]]:
    for key in JOINT_KEYS:
        if getattr(law, key) is not None:
            yield f"{table}.{key}", getattr(law, key)
