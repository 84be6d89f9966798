"""What the solutions ask of a scene before they hold."""

from cases.effects import is_spatial
from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene


def beyond(scene: Scene, *held: str) -> str | None:
    """Return why a solution does not hold for a scene, None where it does.

    held : what the solution holds for, of "spatial motion", "reversed load", "gravity",
        "prestress" and "mass damping".
    """
    p = calibrate(scene)
    physics = {
        "spatial motion": (is_spatial(scene), "the motion is spatial"),
        "reversed load": (scene.load.direction[1] < 0, "the load acts against the axis"),
        "softening": (p.tensile_strength is not None, "a joint has a tensile strength"),
        "gravity": (scene.gravity is not None, "gravity acts"),
        "prestress": (scene.prestress is not None, "the joints are prestressed"),
        "mass damping": (bool(p.mass_damping), "the damping is proportional to mass"),
        "local damping": (bool(p.local_damping), "the damping is local, which is not linear"),
    }
    reasons = (why for name, (there, why) in physics.items() if there and name not in held)
    return next(reasons, None)


def static_stress(scene: Scene) -> float:
    """Return what every section holds before the load acts, Pa, where gravity does not."""
    return scene.prestress.normal if scene.prestress else 0.0


def rock_is_damped(p: Properties) -> bool:
    """Return whether the rock and its ordinary joints carry dashpots."""
    return bool(p.time_constant)


def joints_are_damped(p: Properties) -> bool:
    """Return whether any joint carries a dashpot; a damped rock has damped joints."""
    return p.joint_time_constant is not None and bool(p.joint_time_constant.any())


def bars_tension(p: Properties) -> bool:
    """Return whether any joint cannot be pulled."""
    return not bool(p.tension.all())


def has_interfaces(p: Properties) -> bool:
    """Return whether a soft layer differs in stiffness from the ordinary joints."""
    return bool(p.excess_compliance.any())


def has_thick_layer(scene: Scene) -> bool:
    """Return whether a soft layer is rock of some thickness, not a joint."""
    return any(layer.thickness is not None for layer in scene.soft_layers)
