"""The ends of a pillar: their loads and dashpots.

Absorbing ends carry dashpots: rho c along the pillar of the bar, whose sides are free, and across
it of the S wave, of jointed rock as a whole. In jointed rock a matched end has half a joint in
front of them, as the rock beyond would have (`joints.ends`).
"""

from math import isfinite
from typing import Any

import numpy as np
import ufl

from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.loads.forces import Push, forces_on
from jointwave.continuum.loads.sides import ENDS, facets_on
from jointwave.continuum.space import compat
from jointwave.continuum.space.fenicsx import dolfinx
from jointwave.continuum.space.model import Body, directions
from jointwave.continuum.stepping.problem import Dashpots, Springs
from jointwave.joints.ends import HalfSpring, half_spring

NEAR = 1e-9  # of the pillar: what is at an end


def load_on(scene: Scene, body: Body) -> list[Push]:
    """Return the end stress as forces on the start; none where the base is shaken."""
    if scene.shakes_base or not scene.load.amplitude:
        return []
    force, moment = force_and_moment(scene)
    facets = facets_on(body, ["start"])
    share = forces_on(body, facets, np.tile(force[directions(body)], (len(facets.node), 1)))
    if moment.any() and body.mesh.geometry.dim > 1 and body.tied is None:
        bent = spread(scene, moment, body.x)[:, directions(body)]
        share = share + compat.matrix(on_start(body)) @ bent.ravel()
    return [Push(share, load_history(scene))]


def on_start(body: Body) -> Any:
    """Return the form of u . v over the start, by which tractions that are linear between its nodes
    are forces."""
    domain, y = body.mesh, float(body.sides["start"].place[0, 1])
    near, dim = NEAR * float(np.ptp(body.x[:, 1])), domain.topology.dim - 1
    facets = dolfinx.mesh.locate_entities_boundary(domain, dim, lambda x: np.abs(x[1] - y) <= near)
    tags = dolfinx.mesh.meshtags(domain, dim, np.sort(facets), np.ones(len(facets), np.int32))
    ds = ufl.Measure("ds", domain=domain, subdomain_data=tags, subdomain_id=1)
    return ufl.inner(ufl.TrialFunction(body.space), ufl.TestFunction(body.space)) * ds


def force_and_moment(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return force (over that of 1 Pa) and moment about the axis (m, of 1 Pa over the area) of a
    unit end stress, along x, y, z."""
    load, direction = scene.load, np.array(scene.load.direction, dtype=float)
    if load.arm is not None:
        return np.zeros(3), load.arm * direction
    return direction, np.cross([load.at[0], 0.0, load.at[1]], direction)


def spread(scene: Scene, moment: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the tractions [n, 3] of a moment at points [n, d], as in a long column: linear in x
    and z (Navier), and in torsion along circles about the axis."""
    across = np.zeros((len(x), 2))
    across[:, : x.shape[1] - 1] = x[:, [0, 2][: x.shape[1] - 1]]
    bent, twisted = 12 / scene.pillar.side**2, 6 / scene.pillar.side**2
    along = bent * (moment[2] * across[:, 0] - moment[0] * across[:, 1])
    around = twisted * moment[1] * across
    return np.column_stack([around[:, 1], along, -around[:, 0]])


def quiet_ends(scene: Scene, body: Body, model: str) -> Dashpots | None:
    """Return the dashpots of absorbing ends; None without any."""
    p, dim = calibrate(scene), body.components
    node, area, every = [], [], []
    for place, own in zip(ENDS, (p.at_start, p.at_end), strict=True):
        kind = getattr(scene.ends, place)
        if kind in ("quiet", "matched"):
            facets = facets_on(body, [place])
            own_nodes, which = np.unique(facets.node, return_inverse=True)
            node.append(own_nodes)
            area.append(np.bincount(which.reshape(-1), facets.weight))
            every += len(own_nodes) * [(own, kind == "matched" and model == "jointed")]
    if not node:
        return None
    weight = np.concatenate(area)[:, None]

    def half(dt: float) -> list[np.ndarray]:
        found = np.array([half_springs(*one, dim, dt) for one in every])
        return [found[:, :, k] for k in range(found.shape[2])]

    def springs(dt: float) -> Springs:
        stiffness, _, decay, gain, critical = half(dt)
        return Springs(weight * stiffness, decay, gain, weight * critical)

    viscosity = weight[:, :, None] * half(0.0)[1][:, :, None] * np.eye(dim)
    sprung = springs if springs(0.0).stiffness.any() else None
    return Dashpots(np.concatenate(node), viscosity, sprung)


def half_springs(p: JointedRock, sprung: bool, components: int, dt: float) -> list[HalfSpring]:
    """Return what absorbs each component per unit area, by half a joint or a dashpot alone."""
    along = [1] if components == 1 else [0, 1, 0][:components]
    z = [(p.shear_impedance, p.impedance)[k] for k in along]
    if not (sprung and isfinite(p.regular_own_stiffness)):
        return [HalfSpring(0.0, one, 0.0, 0.0, 0.0) for one in z]
    stiffness, eta = (
        (p.regular_own_shear_stiffness, p.regular_own_stiffness),
        p.time_constant or 0.0,
    )
    return [half_spring(2 * stiffness[k], eta, one, dt) for k, one in zip(along, z, strict=True)]
