"""The stress on the loaded end of a pillar, by its force and its moment."""

import numpy as np
import ufl

from jointwave.cases.schema.pulse import Load
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.space import compat
from jointwave.continuum.space.fenicsx import dolfinx
from jointwave.continuum.space.model import Body, directions, forces_on

mesh = dolfinx.mesh
NEAR = 1e-9  # of the pillar: what is at an end


def end_force(scene: Scene, body: Body, load: Load) -> np.ndarray:
    """Return the force on every freedom of an end stress of 1 Pa, N."""
    facets, axes = body.sides[load.side], directions(body)
    force, moment = force_and_moment(load)
    share = forces_on(body, facets, np.tile(force[axes], (len(facets.node), 1)))
    if not moment.any() or body.mesh.geometry.dim == 1 or body.tied is not None:
        return share
    # Tractions that are linear between nodes are forces by the form of u . v over the end.
    domain, y = body.mesh, float(facets.place[0, 1])
    near, dim = NEAR * float(np.ptp(body.x[:, 1])), domain.topology.dim - 1
    own = mesh.locate_entities_boundary(domain, dim, lambda x: np.abs(x[1] - y) <= near)
    tags = mesh.meshtags(domain, dim, np.sort(own), np.ones(len(own), np.int32))
    ds = ufl.Measure("ds", domain=domain, subdomain_data=tags, subdomain_id=1)
    on_end = ufl.inner(ufl.TrialFunction(body.space), ufl.TestFunction(body.space)) * ds
    bent = spread(scene.pillar.side, moment, body.x)[:, axes]
    return share + compat.matrix(on_end) @ bent.ravel()


def force_and_moment(load: Load) -> tuple[np.ndarray, np.ndarray]:
    """Return force (over that of 1 Pa) and moment about the axis (m, of 1 Pa over the area) of a
    unit end stress, along x, y, z."""
    direction = np.array(load.direction, dtype=float)
    if load.arm is not None:
        return np.zeros(3), load.arm * direction
    return direction, np.cross([load.at[0], 0.0, load.at[1]], direction)


def spread(side: float, moment: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the tractions [n, 3] of a moment at points [n, d], as in a long column: linear in x
    and z (Navier), and in torsion along circles about the axis."""
    across = np.zeros((len(x), 2))
    across[:, : x.shape[1] - 1] = x[:, [0, 2][: x.shape[1] - 1]]
    bent, twisted = 12 / side**2, 6 / side**2
    along = bent * (moment[2] * across[:, 0] - moment[0] * across[:, 1])
    around = twisted * moment[1] * across
    return np.column_stack([around[:, 1], along, -around[:, 0]])
