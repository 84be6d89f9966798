"""Scenes of plane waves in densely jointed rock, as waves of its effective medium.

A wave travels in the medium (`cases.material.effective_medium`) in the scene's direction, at the
medium's speed: P is the wave whose motion is most nearly along this direction, and is the slowest
if joints open easily; S is the other wave whose polarisation is nearest to the scene's. `quantity =
"stress"` is the traction on the wave front, rho c v. Where joints cross, it enters all engines
through their quiet sides, since the rock beyond is jointed too and transmits no wave of intact
rock: the solution is exact for homogenised rock, and approximate for jointed rock in which
wavelengths are large compared with the spacings.

A free face reflects the two waves of the medium that have the same slowness along it and cancel the
traction there.

Valid for any crossing sets of linear joints without dashpots, in undamped rock with other sides
through which waves leave, from rest: at t = 0 no pulse may have begun within the domain.
"""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from jointwave.cases.histories import Integrated
from jointwave.cases.incident import COMPONENT, PlaneWave, PlaneWaves, across, in_components
from jointwave.cases.loads import history_of
from jointwave.cases.material.effective_medium import compliant, speeds, stiffness, tensor
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.material.rock_mass import initial_stress
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.pulse import Wave
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.rock_mass import conditions
from jointwave.compare.solvers.record import Answer, Form, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

ALIKE = 1e-9  # relative difference below which speeds are equal


@dataclass(frozen=True)
class MediumWave(PlaneWave):
    """A plane wave of a medium; its polarisation is a unit vector times an amplitude. stress : at 1
    m/s, in the components of a `WaveMotion`, Pa, tension positive."""

    stress: np.ndarray

    def unit_stress(self) -> np.ndarray:
        return self.stress


class MediumField(PlaneWaves):
    """The waves of a scene in the effective medium of its joints."""


def medium_field(scene: RockMass) -> MediumField:
    """Return the waves of a scene in its effective medium and their reflections from a free face;
    all joint sets must have a spacing."""
    C, face = medium_stiffness(scene), None if scene.in_space else conditions.free_face(scene)
    waves = [medium_wave(scene, one, C) for one in scene.waves]
    back = [] if face is None else [x for one in waves for x in _reflections(one, C, scene, face)]
    return MediumField((*waves, *back))


def medium_stiffness(scene: RockMass) -> np.ndarray:
    """Return the stiffness of the medium in Voigt's form, Pa, with joints closed by the initial
    stress in the middle of the domain."""
    middle = np.mean(scene.domain.corners, axis=0)[None]
    sets = compliant(scene.joint_sets, initial_stress(scene, middle)[0])
    return stiffness(elastic_rock(scene.rock), sets, scene.domain.dimension)


def medium_wave(scene: RockMass, wave: Wave, C: np.ndarray) -> MediumWave:
    """Return a wave of a scene in a medium of stiffness C (Pa, Voigt's form)."""
    n, density = np.array(wave.direction), scene.rock.density
    found, shapes = speeds(C, density, n)
    along, branch = n, int(np.abs(n @ shapes).argmax())
    if wave.kind == "S":
        along, shared = across(n, wave), np.abs(across(n, wave) @ shapes)
        shared[branch] = -1.0
        branch = int(shared.argmax())
    c = float(found[branch])
    alike = shapes[:, np.abs(found - c) < ALIKE * c]  # S waves of equal speed may be combined
    g = alike @ (along @ alike)
    g = g / np.linalg.norm(g)
    full = np.einsum("ijkl,k,l->ij", tensor(C), g, n) / c
    corners = np.array(scene.domain.corners)
    through = corners[np.argmin(corners @ n)] if wave.through is None else np.array(wave.through)
    over = density * c if wave.quantity == "stress" else 1.0
    pulse = history_of(wave, wave.amplitude / over)
    return MediumWave(elastic_rock(scene.rock), n, g, c, through, pulse, -in_components(full))


def _reflections(
    wave: MediumWave, C: np.ndarray, scene: RockMass, face: conditions.Face
) -> list[MediumWave]:
    """Return the reflections of a wave from a free face of a medium of stiffness C: the waves with
    slownesses p t + q m, with the incident p along the face, that travel away from it and cancel
    the traction on it; waves that decay from the face are left out."""
    m, density, c = face.normal, scene.rock.density, tensor(C)
    t, slowness = np.array([-m[1], m[0]]), wave.direction / wave.speed
    p = slowness @ t
    M, N, L = (np.einsum("ijkl,j,l->ik", c, *x) for x in ((m, m), (m, t), (t, t)))
    damped, still = p * (N + N.T), p * p * L - density * np.eye(2)
    companion = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, still), -np.linalg.solve(M, damped)]]
    )
    roots = np.linalg.eigvals(companion)
    found = []
    for q in roots[np.abs(roots.imag) < 1e-9 * np.abs(roots).max()].real:
        s = p * t + q * m
        values, shapes = np.linalg.eigh(np.einsum("ijkl,j,l->ik", c, s, s) - density * np.eye(2))
        g = shapes[:, np.abs(values).argmin()]
        stress = -np.einsum("ijkl,k,l->ij", c, g, s)
        if (stress @ m) @ g > 0:  # energy flows inwards
            found.append((s, g, stress))
    pulled = wave.stress[COMPONENT[2]] @ m
    share = np.linalg.lstsq(np.array([s @ m for *_, s in found]).T, -pulled, rcond=None)[0]
    at = wave.through + (face.offset - wave.through @ m) * m  # where the pulse meets the face
    late, back = wave.lateness(at[None])[0], []
    for (s, g, stress), r in zip(found, share, strict=True):
        speed = float(1 / np.hypot(*s))
        through, own = at - late * speed * speed * s, in_components(r * stress)
        back.append(MediumWave(wave.rock, speed * s, r * g, speed, through, wave.pulse, own))
    return back


def applies(scene: RockMass) -> Answer:
    """Return whether the scene has only waves, and they travel in an effective medium."""
    face = None if scene.in_space else conditions.free_face(scene)
    answer = conditions.holds(
        scene,
        ("waves", "prestress"),
        (not scene.joint_sets, "there is no joint"),
        (conditions.all_parallel(scene), "joints are parallel: see parallel-joints"),
        (any(one.spacing is None for one in scene.joint_sets), "a joint has no spacing"),
    ) and conditions.waves_leave(scene, face)
    if not answer:
        return answer
    corners, waves = np.array(scene.domain.corners), medium_field(scene).waves
    decays = face is not None and len(waves) < 3 * len(scene.waves)
    first = min(one.lateness(corners).min() for one in waves)
    return Answer.unless(
        (decays, "a wave decays from the free face"),
        (first < -1e-9 * scene.time.duration, "a pulse is inside the domain before t = 0"),
    )


def solve(scene: RockMass) -> xr.Dataset:
    """Return velocity, displacement and stress at the points of a scene."""
    times, points, field = sample_times(scene), scene.places["points"], medium_field(scene)
    velocity, stress = field(points, times)
    by_integral = (replace(wave, pulse=Integrated(wave.pulse)) for wave in field.waves)
    moved, _ = MediumField(tuple(by_integral))(points, times)
    values = {
        "velocity": velocity.swapaxes(1, 2),
        "displacement": moved.swapaxes(1, 2),
        "stress": conditions.prestress_of(scene) - stress.swapaxes(1, 2),
    }
    return dataset(scene, SOLVER.name, times, values)


SOLVER = Solver(
    name="effective-medium",
    rock=Rock.HOMOGENISED,
    form=Form.CLOSED,
    kinds=("rock mass",),
    dimension=3,
    in_space=True,
    label="effective medium, exact",
    line=thin("#005a3c", 6, (9, 13)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {
            "continuum-equivalent": "elements and time stepping of the homogenised rock"
        },
        Kind.MODELLING: {
            "continuum-jointed": "joints smeared over the rock",
            "dem": "rigid blocks with every joint instead of homogenised rock",
        },
    },
)
