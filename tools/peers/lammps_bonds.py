"""The pillar in LAMMPS: points on harmonic bonds, and spheres of six freedoms on BPM bonds.

Thompson et al., Comp. Phys. Comm. 271 (2022) 108171; the bonds of six freedoms are its package BPM
(Wang, Acta Geotechnica 4, 2009). Both step by velocity Verlet, which begins with half a kick.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from environment import Place
from job import Job, Reading, Twin, folder_of
from pillar import Pillar, pillar

from jointwave.cases.schema.scene import Scene

STRIDES = (1, 2, 4, 16)
UNBREAKABLE = 1e30  # N and N m


class Style(NamedTuple):
    """How LAMMPS is asked for one kind of body."""

    curve: str
    solves: str
    atoms: str
    integrator: str
    ghosts: str
    newton: str
    freedoms: int
    twin: str


POINTS = Style(
    "LAMMPS bonds",
    "points on springs, 3 translations each",
    "bond",
    "nve",
    "",
    "on",
    3,
    "blocks along the axis",
)
SPHERES = Style(
    "LAMMPS BPM bonds",
    "spheres on bonds that also shear, bend and twist, 6 freedoms each",
    "bpm/sphere",
    "nve/bpm/sphere",
    "vel yes",
    "off",
    6,
    "blocks in space",
)

INPUT = """\
units          si
atom_style     {atoms}
atom_modify    map array
newton         on {newton}
boundary       f f f
special_bonds  lj 0 1 1 coul 1 1 1
comm_modify    cutoff {cutoff!r} {ghosts}
read_data      pillar.data
pair_style     none
{bonds}
neigh_modify   once yes
timestep       {dt!r}

group          loaded id 1
variable       stress equal (x[{before}]-x[{after}]+{spacing!r})*{stiffness!r}
variable       history file load.txt
variable       push equal next(history)
fix            move all {integrator}
fix            push loaded addforce v_push 0 0
fix            record all ave/time {stride} 1 {stride} v_stress file stress.txt format " %.17g"
thermo         {steps}
run            {pushed}
unfix          push
run            {rest}
"""


def jobs(scene: Scene, place: Place, root: Path) -> list[Job]:
    """Return the runs of both kinds, inputs written."""
    return [
        job(pillar(scene, s), style, place, root) for style in (POINTS, SPHERES) for s in STRIDES
    ]


def job(p: Pillar, style: Style, place: Place, root: Path) -> Job:
    """Write the input of one run and return it."""
    folder = folder_of(root, style.curve, stride=p.stride)
    (folder / "in.pillar").write_text(script(p, style))
    (folder / "pillar.data").write_text(data(p, style))
    np.savetxt(folder / "load.txt", p.verlet_load * p.area, fmt="%.17g")
    return Job(
        curve=style.curve,
        method="velocity Verlet",
        solves=style.solves,
        reference="lattice",
        settings={"stride": p.stride},
        freedoms=style.freedoms * p.blocks,
        steps=p.steps,
        work=p.blocks * p.steps,
        samples=p.samples,
        folder=folder,
        command=[*place.command, "-in", "in.pillar"],
        read=read,
        twin=Twin(style.twin, p.stride),
        environment=place.environment,
    )


def script(p: Pillar, style: Style) -> str:
    """Return the input script.

    The load is read as long as it acts; reading zeros would be work that nobody asks for. The
    stress is that of the recorded bond by its length: BPM's own output of it is half the force.
    """
    pushed = len(p.load) - 1
    return INPUT.format(
        **style._asdict(),
        cutoff=2 * p.spacing,
        bonds=bonds(p, style),
        dt=p.dt,
        before=p.joint,
        after=p.joint + 1,
        spacing=p.spacing,
        stiffness=p.normal / p.area,
        stride=p.stride,
        steps=p.steps,
        pushed=pushed,
        rest=p.steps - pushed,
    )


def bonds(p: Pillar, style: Style) -> str:
    """Return the bonds' style and coefficients; LAMMPS leaves out the half of k/2 r^2."""
    if style is POINTS:
        return f"bond_style     harmonic\nbond_coeff     1 {p.normal / 2!r} {p.spacing!r}"
    twist, bend = p.shear * p.side**2 / 6, p.normal * p.side**2 / 12
    numbers = [p.normal, p.shear, twist, bend, *4 * [UNBREAKABLE], *4 * [0.0]]
    text = " ".join(map(repr, numbers))
    return f"bond_style     bpm/rotational smooth no\nbond_coeff     1 {text}"


def data(p: Pillar, style: Style) -> str:
    """Return the data file: bodies at the blocks' centres along x, a bond at each joint."""
    n, d = p.blocks, p.spacing
    density = p.mass / (np.pi * d**3 / 6)
    about = "" if style is POINTS else f"{d!r} {float(density)!r} "
    head = f"the pillar\n\n{n} atoms\n{n - 1} bonds\n1 atom types\n1 bond types\n"
    box = f"\n0 {n * d!r} xlo xhi\n{-d!r} {d!r} ylo yhi\n{-d!r} {d!r} zlo zhi\n"
    masses = f"\nMasses\n\n1 {p.mass!r}\n" if style is POINTS else ""
    atoms = "".join(f"{i + 1} 1 1 {about}{(i + 0.5) * d!r} 0 0\n" for i in range(n))
    joints = "".join(f"{i} 1 {i} {i + 1}\n" for i in range(1, n))
    return f"{head}{box}{masses}\nAtoms # {style.atoms}\n\n{atoms}\nBonds\n\n{joints}"


def read(folder: Path) -> Reading:
    """Read the samples, and the loop times that LAMMPS reports."""
    times = re.findall(r"Loop time of (\S+)", (folder / "output.txt").read_text())
    return Reading(np.loadtxt(folder / "stress.txt")[:, 1], sum(map(float, times)))
