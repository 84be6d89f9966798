"""A square lattice of bodies on BPM bonds in LAMMPS beside rigid blocks in the plane.

    python tools/peers/lattice.py [--rounds N]

Both have as many bodies and bonds, of equal mass, inertia and stiffness (normal, shear, bending),
begin with the same velocities and take the same steps on one core, in turns. After the last they
must be at the same place: what is timed is the same motion.
"""

import argparse
import re
import subprocess
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import NamedTuple

import environment
import numpy as np
from environment import Place
from job import ONE_THREAD
from lammps_bonds import UNBREAKABLE
from measure import on_one_core

from jointwave import cases
from jointwave.dem.blocks.leapfrog import march, samples_for
from jointwave.dem.blocks.model import PlaneModel, state_at_rest
from jointwave.dem.blocks.system import prepared
from jointwave.joints.law import law_of

SIDES = (32, 100, 316)  # bodies along each side
SCENE = Path(__file__).with_name("lattice.toml")
BODY_STEPS = 2_000_000  # of one run
SPEED = 0.1  # m/s: turns of 1e-4, above the 1e-8 of an arc cosine near 1 that LAMMPS takes them by
ALIKE = 1e-3  # of displacement: turns of 1e-4, which only LAMMPS takes as finite

INPUT = """\
units          si
atom_style     bpm/sphere
newton         on off
boundary       f f f
special_bonds  lj 0 1 1 coul 1 1 1
comm_modify    cutoff 2.0 vel yes
read_data      lattice.data
pair_style     none
bond_style     bpm/rotational smooth no
bond_coeff     1 {bond}
neigh_modify   once yes
timestep       {dt!r}
fix            move all nve/bpm/sphere
thermo         {steps}
run            {steps}
write_dump     all custom end.txt id x y modify sort id format float %.17g
"""


class Lattice(NamedTuple):
    """Blocks of 1 m, `side` along each side; pairs that touch [bonds, 2]; velocities [bodies, 3],
    m/s and rad/s; steps."""

    side: int
    model: PlaneModel
    pairs: np.ndarray
    centres: np.ndarray
    velocity: np.ndarray
    steps: int


def bodies(side: int) -> Lattice:
    """Return the lattice, with the inertia of spheres of diameter 1 m."""
    size = {"domain.size": [float(side), float(side)]}
    system = prepared(cases.load_variant(SCENE, "", size))
    inertia = system.model.blocks.inertia.copy()
    inertia[:, 2] = inertia[:, 0] / 10
    blocks = system.model.blocks._replace(inertia=inertia, dt=0.5 * system.model.blocks.dt)
    model = system.model._replace(blocks=blocks, held=None)
    model = model._replace(form=model.form._replace(held=False))
    velocity = SPEED * np.random.default_rng(1).uniform(-1, 1, (len(inertia), 3))
    centres = system.blocks.partition.centroid
    pairs = system.blocks.links.blocks
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
    law, steps = law_of(own.model.laws, 0), own.steps
    (places, weights), stiffness = own.model.rules[0], law.normal_stiffness
    bending = stiffness * float(weights @ places**2)  # of the points of a contact
    numbers = [stiffness, law.shear_stiffness, law.shear_stiffness / 6, bending]
    numbers += [*4 * [UNBREAKABLE], *4 * [0.0]]
    bond = " ".join(repr(float(number)) for number in numbers)
    folder.mkdir(parents=True, exist_ok=True)
    text = INPUT.format(bond=bond, dt=float(own.model.blocks.dt), steps=steps)
    (folder / "in.lattice").write_text(text)
    (folder / "lattice.data").write_text(data(own))
    command = [*place.command, "-in", "in.lattice"]
    said = subprocess.run(
        command, cwd=folder, env=ONE_THREAD | place.environment, capture_output=True, text=True
    )
    if said.returncode:
        raise SystemExit(f"lammps: exit {said.returncode}: {said.stdout.splitlines()[-1:]}")
    end = np.loadtxt(folder / "end.txt", skiprows=9)[:, 1:]
    return end - own.centres, float(re.findall(r"Loop time of (\S+)", said.stdout)[-1])


def data(own: Lattice) -> str:
    """Return the data file: bodies at the blocks' centres, a bond at each joint."""
    density = float(own.model.blocks.inertia[0, 0] / (np.pi / 6))
    pairs, size = own.pairs, float(own.side)
    head = f"lattice\n\n{len(own.centres)} atoms\n{len(pairs)} bonds\n1 atom types\n1 bond types\n"
    box = f"\n0 {size!r} xlo xhi\n0 {size!r} ylo yhi\n-1 1 zlo zhi\n"
    places = [(float(x), float(y)) for x, y in own.centres]
    atoms = "".join(
        f"{i} 1 1 1.0 {density!r} {x!r} {y!r} 0\n" for i, (x, y) in enumerate(places, 1)
    )
    speeds = [tuple(map(float, row)) for row in own.velocity]
    moves = "".join(f"{i} {u!r} {v!r} 0 0 0 {w!r}\n" for i, (u, v, w) in enumerate(speeds, 1))
    bonds = "".join(f"{c} 1 {i + 1} {j + 1}\n" for c, (i, j) in enumerate(pairs.tolist(), 1))
    parts = f"\nAtoms # bpm/sphere\n\n{atoms}\nVelocities\n\n{moves}\nBonds\n\n{bonds}"
    return head + box + parts


def main() -> None:
    """Print the ratio of the rates of both for each size, and how far apart they end."""
    parser = argparse.ArgumentParser(prog="python tools/peers/lattice.py", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="turns of each run")
    parser.add_argument("--out", type=Path, default=Path("out/peers/lattice"), help="inputs")
    options = parser.parse_args()
    place = environment.lammps()
    if place.missing:
        raise SystemExit(f"missing: {place.missing}")
    on_one_core()
    print(
        "square lattice: rigid blocks in the plane over LAMMPS BPM rotational bonds, body-steps/s"
    )
    for side in SIDES:
        own, folder = bodies(side), options.out / str(side)
        ours(own)  # compiles
        turns = [(ours(own), theirs(own, place, folder)) for _ in range(options.rounds)]
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


def distance(found: np.ndarray, expected: np.ndarray) -> float:
    """Return how far apart both end, of the displacement; exit where that is not alike."""
    apart = float(np.linalg.norm(found - expected) / np.linalg.norm(expected))
    if not apart < ALIKE:
        raise SystemExit(f"{len(found)} bodies end {apart:.1e} apart: not the same motion")
    return apart


if __name__ == "__main__":
    main()
