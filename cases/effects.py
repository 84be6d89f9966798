"""The effects that a scene calls for; engines compute no others."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

NO_SHEAR = "the joints carry no shear"
ENDS = ("quiet", "matched", "fixed")
SIDES = ("quiet", "fixed", "roller", "periodic")
SLIPS = "friction_angle or cohesion is given"
STICKS = "neither friction_angle nor cohesion"

Called = tuple[str, object, str]  #: name, why the scene has it (false if not), why not otherwise


class Effect(NamedTuple):
    """One optional part of the physics: its name, whether the scene has it, and why."""

    name: str
    active: bool
    reason: str


def effects(scene: AnyScene) -> list[Effect]:
    """Return every known effect for this kind of scene, in the order of cost."""
    own = _of_column(scene) if scene.is_column else _of_joint_sets(scene)
    found = [*own, *_of_any(scene)]
    return [Effect(name, bool(why), str(why or why_not)) for name, why, why_not in found]


def active_effects(scene: AnyScene) -> list[str]:
    """Return the names of the scene's active effects."""
    return [effect.name for effect in effects(scene) if effect.active]


def _of_column(scene: Scene) -> Iterator[Called]:
    p, laws, random = calibrate(scene), [scene.joints, *scene.layers], scene.scatter
    of_joints = "damping_ratio" if any(one.damping_ratio for one in laws) else "viscosity"
    source = "damping.rayleigh" if scene.damping.rayleigh else of_joints
    damped = p.joint_time_constant is not None
    yield "dashpots", damped and f"{source} is given", "no damping_ratio, no viscosity"
    parts, differ, cause = len(p.each), len(p.soft), scene.off_axis
    yield "segments", parts > 1 and f"{parts} segments", "no [[segments]]"
    yield "scatter", random and f"seed {random.seed}", "no [scatter]"
    open_up = int((~p.tension).sum())
    whose = open_up and f"{open_up} of {len(p.tension)} joints"
    yield "no tension", whose, _carries(p.friction is not None)
    alike = "all joints are equal: scalars, no arrays" if p.is_uniform else "no soft layers"
    layers = differ and f"{differ} soft layer{'s' * (differ > 1)}"
    yield "joints that differ", layers, alike
    axial = "the load is axial and central: one degree of freedom per block"
    yield "spatial motion", cause and f"{cause}: {scene.block_freedoms} degrees of freedom", axial
    turns = f"motion.rotation = '{scene.rotation}'" if cause else "the blocks do not rotate"
    yield "finite rotation", cause and scene.rotation == "finite" and turns, turns
    slips = p.friction is not None or p.cohesion is not None
    yield "slip", cause and slips and SLIPS, STICKS if cause else NO_SHEAR
    for part in PARTS:
        if part.along and not cause:
            yield part.name, None, NO_SHEAR
        else:
            yield part.name, any(map(part.of, laws)) and part.why(True), part.why(False)
    yield from _of_sides(scene, ENDS, "end")
    shakes = f"load.quantity = '{scene.load.quantity}'"
    yield "shaken base", scene.shakes_base and shakes, shakes


def _of_joint_sets(scene: RockMass) -> Iterator[Called]:
    sets = scene.joint_sets

    def of(has: Iterable[bool], why: str) -> str:
        names = [one.name for one, there in zip(sets, has, strict=True) if there]
        return f"{why}: {', '.join(names)}" if names else ""

    dashpots = [(one.damping_ratio, one.viscosity) != (None, None) for one in sets]
    damped = of(dashpots, "damping_ratio or viscosity is given")
    whole = scene.damping.rayleigh and "damping.rayleigh is given"
    yield "dashpots", whole or damped, "no damping_ratio, no viscosity"
    rubs = [one.friction_angle is not None for one in sets]
    open_up = of((one.tension is False for one in sets), "tension = false")
    yield "no tension", open_up, _carries(any(rubs))
    slips = (rub or one.cohesion is not None for rub, one in zip(rubs, sets, strict=True))
    yield "slip", of(slips, SLIPS), STICKS
    for part in PARTS:
        yield part.name, of(map(part.of, sets), part.why(True)), part.why(False)
    waves, pushed = len(scene.waves), len(scene.pushes)
    yield "incident waves", waves and f"{waves} in [[waves]]", "no [[waves]]"
    yield "loads", pushed and f"{pushed} in [[loads]]", "no [[loads]]"
    yield from _of_sides(scene, SIDES, "side")
    yield "shaken base", scene.bases and "a load of kind 'base'", "no base is shaken"


def _carries(slides: bool) -> str:
    """Return why no joint opens; slides : whether joints have friction (no limit on tension)."""
    return "every joint carries tension" + ", also with friction" * slides


def _of_sides(scene: AnyScene, kinds: Iterable[str], noun: str) -> Iterator[Called]:
    for kind in kinds:
        places = ", ".join(key for key, held in scene.sides.items() if held == kind)
        yield f"{kind} {noun}s", places, f"no {noun} is {kind}"


def _of_any(scene: AnyScene) -> Iterator[Called]:
    """Yield the effects that any scene may have: recording, damping of the rock, body forces."""
    record = scene.record
    yield "energy ledger", record.energy and "record.energy is on", "record.energy = false"
    every = record.fields
    yield "field output", every and f"a snapshot every {every:g} s", "no record.fields"
    local, quality, gravity = scene.damping.local, scene.rock.quality_factor, scene.gravity
    alpha, stress = scene.damping.alpha, scene.prestress
    mass = alpha is not None and f"alpha = {alpha:.4g} 1/s"
    yield "mass damping", mass, "no mass_proportional, no rayleigh"
    yield "local damping", local and f"damping.local = {local:g}", "no damping.local"
    if quality:
        _, low, high = scene.rock.quality_frequencies(scene.pulses)
        band = f"rock.quality_factor = {quality:g} from {low:.4g} to {high:.4g} Hz"
    yield "constant Q", quality and band, "no rock.quality_factor"
    acts = gravity and ("static at the start" if gravity.static else "applied at t = 0")
    yield "gravity", acts, "no [gravity]"
    words = stress and stress.words + scene.excavated * ", openings excavated"
    yield "prestress", words, "no [prestress]"
