"""The effects of a scene; all others are not computed."""

from collections.abc import Iterator
from dataclasses import dataclass

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

NO_SHEAR = "the joints carry no shear"
SIDES = ("quiet", "fixed", "periodic")
SLIPS = "friction_angle or cohesion is given"
STICKS = "neither friction_angle nor cohesion"


@dataclass(frozen=True)
class Effect:
    """One optional part of the physics: its name, whether the scene has it, and why."""

    name: str
    active: bool
    reason: str


def _called_for(name: str, why: object, why_not: str) -> Effect:
    """Return an effect; why : the reason if the scene has it, false otherwise."""
    return Effect(name, bool(why), str(why) if why else why_not)


def is_spatial(scene: Scene) -> bool:
    """Return whether a scene moves across its axis or turns its blocks; else it is axial."""
    return off_axis(scene) is not None


def effects(scene: AnyScene) -> list[Effect]:
    """Return every effect that this version knows of this kind of scene, in the order of cost."""
    if not isinstance(scene, Scene):
        return [
            *_of_joint_sets(scene),
            *(_of_sides(scene, kind) for kind in SIDES),
            _of_ledger(scene),
            _of_fields(scene),
            *_of_forces_in_plane(scene),
        ]
    p = calibrate(scene)
    return [
        *_of_joints(scene, p),
        *(_of_ends(scene, kind) for kind in ("quiet", "matched", "fixed")),
        _of_ledger(scene),
        _of_fields(scene),
        *_of_motion(scene, p),
        *_of_forces(scene, p),
    ]


def active_effects(scene: AnyScene) -> list[str]:
    """Return the names of the scene's active effects."""
    return [effect.name for effect in effects(scene) if effect.active]


def off_axis(scene: Scene) -> str | None:
    """Return why the scene is not axial; None if it is."""
    if scene.load.arm is not None:
        return "the load is a couple"
    if scene.load.is_across:
        return "the load has a component across the axis"
    if scene.load.is_eccentric:
        return "the load is eccentric"
    gravity = scene.gravity
    if gravity is not None and (gravity.direction[0] or gravity.direction[2]):
        return "gravity has a component across the axis"
    return None


def beyond_blocks(scene: AnyScene) -> str:
    """Return why rigid blocks do not simulate a scene with a quality factor, "" if they do: rock
    in series with a joint is one spring that relaxes where the joint is linear."""
    if not isinstance(scene, Scene):
        return "rigid blocks of a rock mass have no intact rock for a quality_factor"
    if is_spatial(scene):
        return "rigid blocks support a quality_factor in axial motion only"
    p = calibrate(scene)
    others = scene.gravity, scene.prestress, p.local_damping
    bends = not p.tension.all() or bool(p.strengths(shears=False))
    if bends or any(one is not None for one in others):
        return (
            "rigid blocks support a quality_factor with linear joints only, without gravity, "
            "prestress or local damping"
        )
    return ""


def bends(scene: Scene) -> bool:
    """Return whether a load or gravity bends a pillar whose blocks may rotate."""
    twists = scene.load.arm is not None and not scene.load.is_across and scene.gravity is None
    return is_spatial(scene) and scene.motion.rotation != "none" and not twists


def _of_joints(scene: Scene, p: Properties) -> Iterator[Effect]:
    source = "damping.rayleigh" if scene.damping.rayleigh else "damping_ratio"
    damped = p.joint_time_constant is not None and f"{source} is given"
    yield _called_for("dashpots", damped, "no damping_ratio")
    yield from _of_law(scene, along=False)
    parts, random = len(p.each), scene.scatter
    other = parts > 1 and f"{parts} segments"
    yield _called_for("segments", other, "no [[segments]]")
    yield _called_for("scatter", random and f"seed {random.seed}", "no [scatter]")
    no_tension, differ = int((~p.tension).sum()), len(p.soft)
    layers = differ and f"{differ} soft layer{'s' * (differ > 1)}"
    whose = no_tension and f"{no_tension} of {len(p.tension)} joints"
    yield _called_for("no tension", whose, _carries(p.friction is not None))
    alike = "all joints are equal: scalars, no arrays" if p.is_uniform else "no soft layers"
    yield _called_for("joints that differ", layers, alike)


def _of_ends(scene: Scene, kind: str) -> Effect:
    places = [f"ends.{k}" for k in ("start", "end") if getattr(scene.ends, k) == kind]
    return _called_for(f"{kind} ends", " and ".join(places), f"no end is {kind}")


def _carries(slides: bool) -> str:
    """Return why no joint opens; slides : whether joints have friction, which bounds no tension."""
    return "every joint carries tension" + ", also with friction" * slides


def _of_ledger(scene: AnyScene) -> Effect:
    """Return whether a scene records its energy ledger."""
    kept = scene.record.energy and "record.energy is on"
    return _called_for("energy ledger", kept, "record.energy = false")


def _of_fields(scene: AnyScene) -> Effect:
    """Return whether a scene records snapshots."""
    every = scene.record.fields
    why = every and f"a snapshot every {every:g} s"
    return _called_for("field output", why, "no record.fields")


def _of_motion(scene: Scene, p: Properties) -> Iterator[Effect]:
    cause, rotation = off_axis(scene), scene.motion.rotation
    freedoms = 3 if rotation == "none" else 6
    axial = "the load is axial and central: one degree of freedom per block"
    yield _called_for("spatial motion", cause and f"{cause}: {freedoms} degrees of freedom", axial)
    turns = f"motion.rotation = '{rotation}'" if cause else "the blocks do not rotate"
    yield Effect("finite rotation", cause is not None and rotation == "finite", turns)
    slips = p.friction is not None or p.cohesion is not None
    given = cause and slips and SLIPS
    yield _called_for("slip", given, STICKS if cause else NO_SHEAR)
    yield from _of_law(scene, along=True)


def _of_law(scene: Scene, along: bool) -> Iterator[Effect]:
    """Yield the optional parts of the joint law: those in shear, or the others."""
    still = along and off_axis(scene) is None
    for part in PARTS:
        if part.along == along:
            has = any(part.of(law) for law in (scene.joints, *scene.layers))
            yield Effect(part.name, has and not still, NO_SHEAR if still else part.why(has))


def _of_body_forces(scene: AnyScene, alpha: float | None) -> Iterator[Effect]:
    """Yield the effects on blocks themselves; alpha : of mass-proportional damping, 1/s."""
    local, quality, gravity = scene.damping.local, scene.rock.quality_factor, scene.gravity
    mass = alpha is not None and f"alpha = {alpha:.4g} 1/s"
    yield _called_for("mass damping", mass, "no mass_proportional, no rayleigh")
    yield _called_for("local damping", local and f"damping.local = {local:g}", "no damping.local")
    yield _called_for("constant Q", quality and _relaxes(scene), "no rock.quality_factor")
    acts = gravity and ("static at the start" if gravity.static else "applied at t = 0")
    yield _called_for("gravity", acts, "no [gravity]")


def _relaxes(scene: AnyScene) -> str:
    _, low, high = scene.rock.quality_frequencies(scene.pulses)
    return f"rock.quality_factor = {scene.rock.quality_factor:g} from {low:.4g} to {high:.4g} Hz"


def _of_forces(scene: Scene, p: Properties) -> Iterator[Effect]:
    yield from _of_body_forces(scene, p.mass_damping)
    stress = scene.prestress
    yield _called_for("prestress", stress and f"{stress.normal:.4g} Pa", "no [prestress]")
    yield Effect("shaken base", scene.shakes_base, f"load.quantity = '{scene.load.quantity}'")


def _of_joint_sets(scene: RockMass) -> Iterator[Effect]:
    stiffness_damping = scene.damping.rayleigh is not None
    damped = [one for one in scene.joint_sets if one.damping_ratio is not None]
    if stiffness_damping:
        yield Effect("dashpots", True, "damping.rayleigh is given")
    else:
        yield _of_sets("dashpots", damped, "damping_ratio is given", "no damping_ratio")
    no_tension = [one for one in scene.joint_sets if one.tension is False]
    slides = any(one.friction_angle is not None for one in scene.joint_sets)
    yield _of_sets("no tension", no_tension, "tension = false", _carries(slides))
    slips = [s for s in scene.joint_sets if s.friction_angle is not None or s.cohesion is not None]
    yield _of_sets("slip", slips, SLIPS, STICKS)
    for part in PARTS:
        having = [one for one in scene.joint_sets if part.of(one)]
        yield _of_sets(part.name, having, part.why(True), part.why(False))


def _of_sets(name: str, found: list[JointSet], why: str, why_not: str) -> Effect:
    """Return an effect of joints, which those sets call for."""
    whose = ", ".join(one.name for one in found)
    return _called_for(name, found and f"{why}: {whose}", why_not)


def _of_sides(scene: RockMass, kind: str) -> Effect:
    sides = [f"boundaries.{side}" for side in scene.boundaries.sides(kind)]
    return _called_for(f"{kind} sides", ", ".join(sides), f"no side is {kind}")


def _of_forces_in_plane(scene: RockMass) -> Iterator[Effect]:
    yield from _of_body_forces(scene, scene.damping.alpha)
    stress = scene.prestress
    keys = ("xx", "yy", "zz", "xy", "yz", "xz") if scene.in_space else ("xx", "yy", "xy")
    words = stress and ", ".join(f"{key} {getattr(stress, key):.4g}" for key in keys)
    words = words and words + " Pa" + scene.excavated * ", openings excavated"
    yield _called_for("prestress", words, "no [prestress]")
    waves, pushed = len(scene.waves), len(scene.pushes)
    yield _called_for("incident waves", waves and f"{waves} in [[waves]]", "no [[waves]]")
    yield _called_for("loads", pushed and f"{pushed} in [[loads]]", "no [[loads]]")
    yield _called_for("shaken base", scene.bases and "a load of kind 'base'", "no base is shaken")
