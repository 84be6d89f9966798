"""Conditions under which an exact solution covers a scene."""

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.scene import Scene
from jointwave.compare.solvers.record import Answer

#: Groups of physics by their names in `holds`.
DAMPED = ("damped joints", "damped rock")
LAYERS = ("thick layers", "soft layers", "stiff layers")


def holds(scene: Scene, held: tuple[str, ...], *against: tuple[bool, str]) -> Answer:
    """Return whether a solution applies to a scene, or the first reason why not.

    held : physics that the solution covers, by the names below. against : other reasons against it.
    """
    p, laws = calibrate(scene), (scene.joints, *scene.layers)
    physics = {part.name: (any(map(part.of, laws)), part.words) for part in PARTS} | {
        "spatial motion": (scene.is_spatial, "the motion is spatial"),
        "reversed load": (scene.load.direction[1] < 0, "the load acts against the axis"),
        "segments": (len(p.each) > 1, "the pillar has segments"),
        "scatter": (scene.scatter is not None, "the joints are random"),
        "gravity": (scene.gravity is not None, "gravity acts"),
        "prestress": (scene.prestress is not None, "the joints are prestressed"),
        "mass damping": (bool(p.mass_damping), "the damping is proportional to mass"),
        "local damping": (bool(p.local_damping), "the damping is local and not linear"),
        "thick layers": (has_thick_layer(scene), "a soft layer has a thickness"),
        "no tension": (not p.tension.all(), "a joint carries no tension"),
        "damped joints": (
            p.joint_time_constant is not None and p.joint_time_constant.any(),
            "the joints are damped",  # all of them in damped rock
        ),
        "damped rock": (bool(p.time_constant), "the rock is damped"),
        "quality factor": (scene.rock.quality_factor is not None, "the rock has a quality_factor"),
        "soft layers": (p.excess_compliance.any(), "a soft layer reflects"),
        "stiff layers": (
            (p.excess_compliance < 0).any(),
            "a soft layer is stiffer than the other joints",
        ),
        "fixed start": (scene.ends.start == "fixed", "the loaded end is fixed"),
    }
    beyond = (one for name, one in physics.items() if name not in held)
    return Answer.unless(*beyond, *against)


def has_thick_layer(scene: AnyScene) -> bool:
    """Return whether a soft layer is rock with a thickness, not a joint."""
    return any(layer.thickness is not None for layer in scene.soft_layers)
