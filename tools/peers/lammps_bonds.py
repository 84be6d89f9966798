"""The pillar in LAMMPS: points on harmonic bonds, and spheres of six freedoms on BPM bonds.

Thompson et al., Comp. Phys. Comm. 271 (2022) 108171; bonds of six freedoms are its package BPM
(Wang, Acta Geotechnica 4, 2009). Both use velocity Verlet, which starts with half a velocity step.
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
    """The LAMMPS settings of one kind of body."""

    curve: str
    solves: str
    atoms: str
    integrator: str
    ghosts: str
    newton: str
    freedoms: int
    twin: str


POINTS = Style(
    *("LAMMPS bonds", "points on springs, 3 translations each"),
    *("bond", "nve", "", "on", 3, "blocks along the axis"),
)
SPHERES = Style(
    *("LAMMPS BPM bonds", "spheres on bonds that also shear, bend and twist, 6 freedoms each"),
    *("bpm/sphere", "nve/bpm/sphere", "vel yes", "off", 6, "blocks in space"),
)

#: The beginning of every input: bodies from a data file on bonds of one kind.
BODIES = """\
units          si
atom_style     {atoms}
atom_modify    map array
newton         on {newton}
boundary       f f f
special_bonds  lj 0 1 1 coul 1 1 1
comm_modify    cutoff {cutoff!r} {ghosts}
read_data      bodies.data
pair_style     none
{bonds}
neigh_modify   once yes
timestep       {dt!r}
fix            move all {integrator}
thermo         {steps}
"""
INPUT = """\
group          loaded id 1
variable       stress equal (x[{before}]-x[{after}]+{spacing!r})*{stiffness!r}
variable       history file load.txt
variable       push equal next(history)
fix            push loaded addforce v_push 0 0
fix            record all ave/time {stride} 1 {stride} v_stress file stress.txt format " %.17g"
run            {pushed}
unfix          push
run            {rest}
"""


def jobs(scene: Scene, place: Place, root: Path) -> list[Job]:
    """Write the inputs of the runs of both kinds, and return the runs."""
    return [
        job(pillar(scene, s), style, place, root) for style in (POINTS, SPHERES) for s in STRIDES
    ]


def job(p: Pillar, style: Style, place: Place, root: Path) -> Job:
    """Write the input of one run, and return the run."""
    folder = folder_of(root, style.curve, stride=p.stride)
    (folder / "in.pillar").write_text(script(p, style))
    (folder / "bodies.data").write_text(data(p, style))
    np.savetxt(folder / "load.txt", p.verlet_load * p.area, fmt="%.17g")
    return Job(
        curve=style.curve,
        solves=style.solves,
        reference="lattice",
        settings={"stride": p.stride},
        freedoms=style.freedoms * p.blocks,
        steps=p.steps,
        samples=p.samples,
        folder=folder,
        command=[*place.command, "-in", "in.pillar"],
        read=read,
        twin=Twin(style.twin, p.stride),
        environment=place.environment,
    )


def script(p: Pillar, style: Style) -> str:
    """Return the input script.

    The load is read only while it acts. The stress is computed from the length of the recorded
    bond, since BPM outputs half the force. LAMMPS's bond energy is k r^2: k is half the stiffness.
    """
    pushed = len(p.load) - 1
    twist, bend = p.shear * p.side**2 / 6, p.normal * p.side**2 / 12
    bonds = f"bond_style     harmonic\nbond_coeff     1 {p.normal / 2!r} {p.spacing!r}"
    if style is SPHERES:
        bonds = bpm_bonds(p.normal, p.shear, twist, bend)
    return (BODIES + INPUT).format(
        **style._asdict(),
        cutoff=2 * p.spacing,
        bonds=bonds,
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


def bpm_bonds(*stiffness: float) -> str:
    """Return settings of unbreakable bonds; stiffness : normal, shear, N/m, twist, bending, N m."""
    text = " ".join(map(repr, [*stiffness, *4 * [UNBREAKABLE], *4 * [0.0]]))
    return f"bond_style     bpm/rotational smooth no\nbond_coeff     1 {text}"


def data(p: Pillar, style: Style) -> str:
    """Return the data file of bodies at the blocks' centres along x, with a bond at each joint."""
    n, d = p.blocks, p.spacing
    centres = (np.arange(n) + 0.5)[:, None] * [d, 0.0, 0.0]
    pairs = np.arange(n - 1)[:, None] + np.arange(2)
    return bodies(style, p.mass, d, centres, pairs)


def bodies(style: Style, mass: float, size: float, centres, pairs) -> str:
    """Return the data file of bodies of equal mass, kg, and diameter, m, at centres [n, 3], m, with
    bonds between pairs [bonds, 2], numbered from 0."""
    box = np.stack([centres.min(axis=0) - size, centres.max(axis=0) + size], axis=1).tolist()
    sides = "".join(f"{a!r} {b!r} {x}lo {x}hi\n" for x, (a, b) in zip("xyz", box, strict=True))
    density = float(mass / (np.pi * size**3 / 6))
    about, masses = f"{size!r} {density!r} ", ""
    if style is POINTS:
        about, masses = "", f"\nMasses\n\n1 {mass!r}\n"
    places = enumerate(centres.tolist(), 1)
    atoms = "".join(f"{i} 1 1 {about}{x!r} {y!r} {z!r}\n" for i, (x, y, z) in places)
    bonds = "".join(f"{c} 1 {i + 1} {j + 1}\n" for c, (i, j) in enumerate(pairs.tolist(), 1))
    return (
        f"bodies\n\n{len(centres)} atoms\n{len(pairs)} bonds\n1 atom types\n1 bond types\n"
        f"\n{sides}{masses}\nAtoms # {style.atoms}\n\n{atoms}\nBonds\n\n{bonds}"
    )


def read(folder: Path) -> Reading:
    """Read the samples and the seconds of stepping."""
    seconds = stepping((folder / "output.txt").read_text())
    return Reading(np.loadtxt(folder / "stress.txt")[:, 1], seconds)


def stepping(output: str) -> float:
    """Return the seconds of stepping that LAMMPS reports."""
    return sum(map(float, re.findall(r"Loop time of (\S+)", output)))
