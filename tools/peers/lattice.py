"""A square lattice of bodies on BPM bonds in LAMMPS beside rigid blocks in the plane.

Both have as many bodies and bonds, of equal mass, inertia and stiffness (normal, shear, bending),
begin with the same velocities and take the same steps on one core, in turns. After the last they
must be at the same place: what is timed is the same motion.
"""

import subprocess
from pathlib import Path
from statistics import median
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

SIDES = (32, 100, 316)  # bodies along each side
SCENE = Path(__file__).with_name("lattice.toml")
BODY_STEPS = 2_000_000  # of one run
SPEED = 0.1  # m/s: turns of 1e-4, above the 1e-8 of an arc cosine near 1 that LAMMPS takes them by
ALIKE = 1e-3  # of displacement: turns of 1e-4, which only LAMMPS takes as finite

INPUT = """\
run            {steps}
write_dump     all custom end.txt id x y modify sort id format float %.17g
"""


class Lattice(NamedTuple):
    """Blocks of 1 m, `side` along each side; pairs that touch [bonds, 2]; velocities [bodies, 3],
    m/s and rad/s; steps."""

    side: int
    model: Model
    pairs: np.ndarray
    centres: np.ndarray
    velocity: np.ndarray
    steps: int


def lattice(side: int) -> Lattice:
    """Return the lattice, with the inertia of spheres of diameter 1 m."""
    size = {"domain.size": [float(side), float(side)]}
    system = prepared(cases.load_variant(SCENE, "", size))
    inertia = system.model.blocks.inertia.copy()
    inertia[:, 2] = inertia[:, 0] / 10
    blocks = system.model.blocks._replace(inertia=inertia, dt=0.5 * system.model.blocks.dt)
    model = system.model._replace(blocks=blocks, held=None)
    model = model._replace(form=model.form._replace(held=False))
    velocity = SPEED * np.random.default_rng(1).uniform(-1, 1, (len(inertia), 3))
    centres = system.blocks.cut.centroid
    pairs = system.blocks.contacts.blocks
    return Lattice(side, model, pairs, centres, velocity, BODY_STEPS // side**2)


def ours(own: Lattice) -> tuple[np.ndarray, float]:
    """Return displacements [bodies, 2] (m) and seconds of stepping."""
    state, samples = state_at_rest(own.model), samples_for(own.model, 0)
    state.v[:] = own.velocity
    began = perf_counter()
    march(own.model, state, samples, 2 * own.steps, (1, 1 + own.steps))
    return state.u[:, :2].copy(), perf_counter() - began


def theirs(own: Lattice, place: Place, folder: Path) -> tuple[np.ndarray, float]:
    """Return the same from LAMMPS, whose own loop time is taken."""
    law, table = law_of(own.model.laws, 0), own.model.chunks.table[0]
    second = float(table[own.model.form.table.second])
    normal, shear = float(law.normal_stiffness), float(law.shear_stiffness)
    bonds = bpm_bonds(normal, shear, shear / 6, normal * second)
    numbers = {"dt": float(own.model.blocks.dt), "steps": own.steps, "cutoff": 2.0}
    text = (BODIES + INPUT).format(**SPHERES._asdict(), **numbers, bonds=bonds)
    speeds = enumerate(own.velocity.tolist(), 1)
    moves = "".join(f"{i} {u!r} {v!r} 0 0 0 {w!r}\n" for i, (u, v, w) in speeds)
    mass, box = own.model.blocks.inertia[0, 0], (0, own.side, 0, own.side)
    found = bodies(SPHERES, mass, 1.0, box, own.centres, own.pairs)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "in.lattice").write_text(text)
    (folder / "bodies.data").write_text(f"{found}\nVelocities\n\n{moves}")
    said = subprocess.run(
        [*place.command, "-in", "in.lattice"],
        cwd=folder,
        env=ONE_THREAD | place.environment,
        capture_output=True,
        text=True,
    )
    if said.returncode:
        raise SystemExit(f"lammps: exit {said.returncode}: {said.stdout.splitlines()[-1:]}")
    return np.loadtxt(folder / "end.txt", skiprows=9)[:, 1:] - own.centres, stepping(said.stdout)


def distance(found: np.ndarray, expected: np.ndarray) -> float:
    """Return how far apart both end, of the displacement; exit where that is not alike."""
    apart = float(np.linalg.norm(found - expected) / np.linalg.norm(expected))
    if not apart < ALIKE:
        raise SystemExit(f"{len(found)} bodies end {apart:.1e} apart: not the same motion")
    return apart


def compare(place: Place, rounds: int, root: Path) -> None:
    """Print the ratio of the rates of both for each size, and how far apart they end."""
    print("square lattice: rigid blocks in the plane over LAMMPS BPM bonds, body-steps/s")
    for side in SIDES:
        own = lattice(side)
        ours(own)  # compiles
        turns = [(ours(own), theirs(own, place, root / str(side))) for _ in range(rounds)]
        apart = distance(*(displacement for displacement, _ in turns[0]))
        seconds = [(mine, peer) for (_, mine), (_, peer) in turns]
        ratios = sorted(peer / mine for mine, peer in seconds)
        mine, peer = (side**2 * own.steps / median(column) for column in zip(*seconds, strict=True))
        print(
            f"  {side**2:>7,} bodies, {len(own.pairs):>7,} bonds: "
            f"{mine:.2e} over {peer:.2e}: {median(ratios):.1f} ({ratios[0]:.1f} to "
            f"{ratios[-1]:.1f}); after {own.steps} steps {apart:.0e} apart",
            flush=True,
        )
