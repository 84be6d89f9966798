"""The chain of rigid blocks in continuous time, which `lattice` and `no_tension` integrate.

Blocks of mass m, joints k_j and dashpots c_j between them, gap g_j = u_{j+1} - u_j:

    m v_j' = F_{j-1} - F_j (+ load on block 1),   F_j = P - k_j g_j - c_j g_j'

and in a joint without tension F_j = max(F_j, 0), 0 while P < k_j g_j (Guo & Li 2002, equation
10). F_0 and F_N are P and the reactions of the ends: none (free), dashpot Z A on the block (quiet,
equation 9), dashpot Z A on a massless face behind the half-block spring 2k (matched), or half a
block of rock to a wall (fixed), moved by a load that is a motion. Each block is also subject to its
weight and the damping -alpha m v_j. Quiet and matched ends that bear the weight exert, beside, what
they would if they were fixed. Displacements are measured from the prestressed state.

A state is an array whose last axis holds w u of the N blocks (m/s), their N velocities (m/s) and
w times the displacement of the two faces; w = 2 sqrt(k/m) makes its parts of equal magnitude.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import sqrt
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.conditions import static_stress


class EndOfChain(NamedTuple):
    """The support of an end: its kind; the spring (N/m) and dashpot (N s/m) in front of it;
    the dashpot Z A of a quiet or matched one, N s/m."""

    kind: str
    stiffness: float
    viscosity: float
    dashpot: float


@dataclass(frozen=True)
class Chain:
    """Coefficients of the equations of motion, in forces (N), not tractions.

    Attributes
    ----------
    mass : of one block, kg; or [N], of each.
    area : of the section, m2.
    contact_y, centre_y : float arrays [N + 1] and [N], faces and centres of the blocks, m.
    stiffness, viscosity : float arrays [N - 1], N/m and N s/m.
    tension : bool array [N - 1], whether a joint carries tension.
    regular : stiffness of an ordinary joint, N/m; the largest of the two ends' rock.
    start, end : supports of the ends.
    prestress : N, compression positive.
    gravity : its component along y, m/s2. borne : what start and end bear of it beside their
        dashpots, N.
    mass_damping : alpha, 1/s.
    shaken : whether the drive is the velocity of the fixed start's wall (m/s), else a force (N).
    gain : ratio of the drive to the scene's `drive` signal: the area (m2) or 1, along y.
    """

    mass: float | np.ndarray
    area: float
    contact_y: np.ndarray
    centre_y: np.ndarray
    stiffness: np.ndarray
    viscosity: np.ndarray
    tension: np.ndarray
    regular: float
    start: EndOfChain
    end: EndOfChain
    prestress: float
    gravity: float
    borne: tuple[float, float]
    mass_damping: float
    shaken: bool
    gain: float

    @cached_property
    def block_count(self) -> int:
        """Number of blocks N."""
        return len(self.stiffness) + 1

    @cached_property
    def rate(self) -> float:
        """2 sqrt(k/m) of an ordinary joint, rad/s: the largest frequency of a long chain."""
        return 2 * sqrt(self.regular / np.min(self.mass))

    @property
    def size(self) -> int:
        """Length of a state."""
        return 2 * self.block_count + 2


def chain(scene: Scene) -> Chain:
    """Return the scene's chain of rigid blocks."""
    p, gravity = calibrate(scene), scene.gravity
    masses, contacts = p.masses, p.contact_y
    etas = p.joint_time_constant
    found = Chain(
        mass=p.block_mass if masses is None else masses,
        area=p.area,
        contact_y=contacts,
        centre_y=p.spacing * (np.arange(p.block_count) + 0.5) if masses is None else p.centre_y,
        stiffness=p.stiffness * p.area,
        viscosity=np.zeros_like(p.stiffness) if etas is None else p.stiffness * p.area * etas,
        tension=p.tension,
        regular=max(p.at_start.regular_stiffness, p.at_end.regular_stiffness) * p.area,
        start=_end(scene.ends.start, p.at_start),
        end=_end(scene.ends.end, p.at_end),
        prestress=static_stress(scene) * p.area,
        gravity=gravity.acceleration * gravity.direction[1] if gravity else 0.0,
        borne=(0.0, 0.0),
        mass_damping=p.mass_damping or 0.0,
        shaken=scene.shakes_base,
        gain=scene.load.direction[1] * (1.0 if scene.shakes_base else p.area),
    )
    if not any(scene.bears):
        return found
    forces, _ = contact_forces(*standing(scene, found))
    start, end = (
        float(f) - found.prestress if bears else 0.0
        for f, bears in zip(forces[[0, -1]], scene.bears, strict=True)
    )
    return replace(found, borne=(start, end))


def standing(scene: Scene, chain: Chain) -> tuple[Chain, np.ndarray]:
    """Return the chain whose ends are held where they bear the weight, and its state [size] at
    rest; faces without an equation of motion stay at zero.

    Every joint is taken to carry tension.
    """
    p, ends = calibrate(scene), (chain.start, chain.end)
    start, end = (
        _end("fixed" if bears or own.kind == "fixed" else "free", rock)
        for own, bears, rock in zip(ends, scene.bears, (p.at_start, p.at_end), strict=True)
    )
    carrying = np.ones_like(chain.tension)
    held = replace(chain, start=start, end=end, borne=(0.0, 0.0), tension=carrying)
    state = np.zeros(chain.size)
    still = rates(held, state)
    matrix = (rates(held, np.eye(chain.size)) - still).T
    moves = matrix.any(axis=1)
    state[moves] = np.linalg.solve(matrix[np.ix_(moves, moves)], -still[moves])
    return held, state


def _end(kind: str, p: Properties) -> EndOfChain:
    stiffness = p.wall_stiffness if kind == "fixed" else 2 * p.regular_stiffness
    spring = stiffness * p.area
    return EndOfChain(kind, spring, spring * (p.time_constant or 0.0), p.impedance * p.area)


def rates(chain: Chain, state: np.ndarray, drive: float = 0.0) -> np.ndarray:
    """Return the time derivative of states [..., size] under a drive (N, or m/s if shaken)."""
    n, w = chain.block_count, chain.rate
    forces, faces = contact_forces(chain, state, drive)
    v = state[..., n : 2 * n]
    slope = np.empty_like(state)
    slope[..., :n] = w * v
    slope[..., n : 2 * n] = (forces[..., :-1] - forces[..., 1:]) / chain.mass
    slope[..., n : 2 * n] += chain.gravity - chain.mass_damping * v
    slope[..., -2], slope[..., -1] = w * faces[0], w * faces[1]
    return slope


def split(chain: Chain, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return displacements (m), velocities (m/s) of the blocks and displacements of the faces."""
    n, w = chain.block_count, chain.rate
    return state[..., :n] / w, state[..., n : 2 * n], state[..., 2 * n :] / w


def contact_forces(
    chain: Chain, state: np.ndarray, drive: np.ndarray | float = 0.0
) -> tuple[np.ndarray, tuple]:
    """Return the forces [..., N + 1] (N, compression positive) of the start, the joints and the
    end, and the velocities [...] of the start's and the end's face.

    The drive [...] is an end force (N), part of the start's force, or the velocity of the start's
    wall (m/s).
    """
    push, wall = (0.0, drive) if chain.shaken else (drive, 0.0)
    u, v, faces = split(chain, state)
    forces = np.empty((*state.shape[:-1], chain.block_count + 1))
    gap, rate = u[..., 1:] - u[..., :-1], v[..., 1:] - v[..., :-1]
    spring = chain.prestress - chain.stiffness * gap
    force = spring - chain.viscosity * rate
    if not chain.tension.all():
        force[~chain.tension & ((spring < 0) | (force < 0))] = 0.0
    forces[..., 1:-1] = force
    start, first = reaction(chain.start, u[..., 0], v[..., 0], faces[..., 0], wall)
    end, last = reaction(chain.end, u[..., -1], v[..., -1], faces[..., 1])
    forces[..., 0] = chain.prestress + chain.borne[0] + push - start
    forces[..., -1] = chain.prestress + chain.borne[1] + end
    return forces, (first, last)


def reaction(end: EndOfChain, u, v, face, wall=0.0):
    """Return the force that an end exerts on its block (N) and the velocity of its face (m/s)."""
    if end.kind == "free":
        return 0.0, 0.0
    if end.kind == "quiet":
        return end.dashpot * v, 0.0
    spring = end.stiffness * (u - face) + end.viscosity * (v - wall)
    if end.kind == "fixed":
        return spring, wall
    rate = spring / (end.dashpot + end.viscosity)
    return end.dashpot * rate, rate


def receivers(
    scene: Scene, chain: Chain, state: np.ndarray, drive: np.ndarray | float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return stress (Pa), velocity (m/s) and displacement (m), each [..., receivers].

    Stress is interpolated between the start, the contacts and the end; velocity and displacement
    between the block centres.
    """
    u, v, _ = split(chain, state)
    forces, _ = contact_forces(chain, state, drive)

    def read(values: np.ndarray, nodes: np.ndarray, places: list[float]) -> np.ndarray:
        left, right, weight = interpolation(nodes, places)
        return (1 - weight) * values[..., left] + weight * values[..., right]

    centres, points = chain.centre_y, scene.record.velocity
    stress = read(forces / chain.area, chain.contact_y, scene.record.stress)
    return stress, read(v, centres, points), read(u, centres, points)
