"""Square and cubic lattices: bodies on BPM bonds in LAMMPS against rigid blocks.

Both have equal numbers of bodies and bonds, mass, inertia and stiffness (normal, shear, bending,
torsion), start with the same velocities and take the same steps on one core, in turn. Their final
positions must agree, so that the same motion is timed. Joints with slip have no equivalent among
bonds; their time is compared with that of the same bonds.
"""

import subprocess
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from environment import Place
from job import ONE_THREAD
from lammps_bonds import BODIES, SPHERES, bodies, bpm_bonds, stepping

from jointwave import cases
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import Model, samples_for, state_at_rest
from jointwave.dem.prepare import prepared
from jointwave.joints.law import law_of

SCENES = {
    dim: Path(__file__).with_name(f"{name}.toml") for dim, name in ((2, "square"), (3, "cubic"))
}
SIDES = {2: (32, 100, 316), 3: (10, 22, 46)}  # bodies along each side
COULOMB = {"friction_angle": 30.0, "cohesion": 1e5, "point_rule": "midpoint"}
BODY_STEPS = 2_000_000  # of one run, about
#: m/s. It gives rotations of 1e-4, well above the error 1e-8 of LAMMPS's arc cosine near 1.
SPEED = 0.1
ALIKE = 1e-3  # tolerance over displacement: only LAMMPS treats the rotations of 1e-4 as finite

INPUT = """\
run            {steps}
write_dump     all custom end.txt id x y z modify sort id format float %.17g
"""


class Lattice(NamedTuple):
    """Blocks of 1 m in `dim` dimensions; touching pairs [bonds, 2]; centres [bodies, dim], m;
    velocities [bodies, freedoms], m/s and rad/s; number of steps."""

    dim: int
    model: Model
    pairs: np.ndarray
    centres: np.ndarray
    velocity: np.ndarray
    steps: int


def lattice(side: int, dim: int, law: dict) -> Lattice:
    """Return the lattice with the inertia of spheres of 1 m. law : keys of its joint sets."""
    changes = {f"joint_sets.{k}.{key}": value for k in range(dim) for key, value in law.items()}
    changes["domain.size"] = [float(side)] * dim
    system = prepared(cases.load_variant(SCENES[dim], "", changes))
    inertia = system.model.blocks.inertia.copy()
    inertia[:, dim:] = inertia[:, :1] / 10
    blocks = system.model.blocks._replace(inertia=inertia, dt=0.5 * system.model.blocks.dt)
    model = system.model._replace(blocks=blocks, held=None)
    model = model._replace(form=model.form._replace(held=False))
    velocity = SPEED * np.random.default_rng(1).uniform(-1, 1, inertia.shape)
    pairs, centres = system.blocks.contacts.blocks, system.blocks.cut.centroid
    return Lattice(dim, model, pairs, centres, velocity, max(10, BODY_STEPS // len(inertia)))


def in_space(values: np.ndarray) -> np.ndarray:
    """Return vectors [n, dim] padded with zeros to [n, 3]."""
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def ours(own: Lattice) -> tuple[np.ndarray, float]:
    """Return displacements [bodies, dim], m, and seconds of stepping of jointwave."""
    state, samples = state_at_rest(own.model), samples_for(own.model, 0)
    state.v[:] = own.velocity
    began = perf_counter()
    march(own.model, state, samples, 2 * own.steps, (1, 1 + own.steps))
    return state.u[:, : own.dim].copy(), perf_counter() - began


def theirs(own: Lattice, place: Place, folder: Path) -> tuple[np.ndarray, float]:
    """Return displacements [bodies, dim], m, and seconds of stepping (loop time) of LAMMPS."""
    law = law_of(own.model.laws, 0)  # of faces of 1 m2
    normal, shear = float(law.normal_stiffness), float(law.shear_stiffness)
    bonds = bpm_bonds(normal, shear, shear / 6, normal / 12)
    numbers = {"dt": float(own.model.blocks.dt), "steps": own.steps, "cutoff": 2.0}
    text = (BODIES + INPUT).format(**SPHERES._asdict(), **numbers, bonds=bonds)
    moving, turning = own.velocity[:, : own.dim], own.velocity[:, own.dim :]
    turning = in_space(turning) if own.dim == 3 else turning * [0.0, 0.0, 1.0]
    speeds = np.hstack([in_space(moving), turning]).tolist()
    moves = "".join(f"{i} {' '.join(map(repr, one))}\n" for i, one in enumerate(speeds, 1))
    mass, centres = float(own.model.blocks.inertia[0, 0]), in_space(own.centres)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "in.lattice").write_text(text)
    data = bodies(SPHERES, mass, 1.0, centres, own.pairs)
    (folder / "bodies.data").write_text(f"{data}\nVelocities\n\n{moves}")
    said = subprocess.run(
        [*place.command, "-in", "in.lattice"],
        cwd=folder,
        env=ONE_THREAD | place.environment,
        capture_output=True,
        text=True,
    )
    if said.returncode:
        raise SystemExit(f"lammps: exit {said.returncode}: {said.stdout.splitlines()[-1:]}")
    moved = np.loadtxt(folder / "end.txt", skiprows=9)[:, 1:] - centres
    return moved[:, : own.dim], stepping(said.stdout)


def distance(found: np.ndarray, expected: np.ndarray) -> float:
    """Return the difference of final displacements over their size; exit if they do not agree."""
    apart = float(np.linalg.norm(found - expected) / np.linalg.norm(expected))
    if not apart < ALIKE:
        raise SystemExit(f"{len(found)} bodies end {apart:.1e} apart: not the same motion")
    return apart


def compare(place: Place, rounds: int, root: Path) -> None:
    """Print the ratio of both rates for each size, and the difference of final displacements."""
    for dim, sides in SIDES.items():
        shape = {2: "square", 3: "cubic"}[dim]
        print(f"{shape} lattice: rigid blocks over LAMMPS BPM bonds, body-steps/s", flush=True)
        for side in sides:
            own, slips = lattice(side, dim, {}), lattice(side, dim, COULOMB)
            ours(own), ours(slips)  # compiles
            turns = [
                (ours(own), ours(slips), theirs(own, place, root / f"{dim}-{side}"))
                for _ in range(rounds)
            ]
            apart = distance(turns[0][0][0], turns[0][2][0])
            seconds = np.array([[took for _, took in turn] for turn in turns])
            mine, slipping, peer = len(own.centres) * own.steps / np.median(seconds, axis=0)
            ratios = seconds[:, 2] / seconds[:, 0]
            points = 2 ** (dim - 1)
            print(
                f"  {len(own.centres):>7,} bodies, {len(own.pairs):>7,} bonds: "
                f"{mine:.2e} over {peer:.2e}: {np.median(ratios):.1f} ({ratios.min():.1f} to "
                f"{ratios.max():.1f}); after {own.steps} steps {apart:.0e} apart; with slip at "
                f"{points} points a face {slipping / peer:.1f}",
                flush=True,
            )
