"""A circular tunnel in rock under stress against Kirsch's solution, and where a joint beside it
begins to slip by Coulomb's criterion.

Sides carry the in-situ stress, which a finite domain makes an error of (a/L)^2: here they carry
what Kirsch's solution adds to it there, too."""

import numpy as np
import pytest

from closed_forms.kirsch import Kirsch
from jointwave.cases.read import load
from jointwave.continuum.loads.sides import facets_on
from jointwave.continuum.mesh.session import gmsh_session
from jointwave.continuum.plan import plan_of
from jointwave.continuum.space.model import forces_on
from jointwave.continuum.stepping.static import settled
from jointwave.continuum.stepping.tractions import SLIDE, history_at_rest
from tests.continuum.drawing import crossed, grouped

HOLE = Kirsch(radius=1.0, stress=(10e6, 4e6), modulus=5e10, poisson=0.25)
HALF = 4.0  # m, of the domain's width
SIZE = 0.25  # m, of triangles
PLACES = [[1.9, 0.2], [0.1, 1.4], [-1.2, 1.3]]
SCENE = f"""
title = "a tunnel"
domain = {{ mesh = "rock.msh" }}
rock = {{ density = 2600.0, intact_modulus = 5e10, intact_poisson = 0.25 }}
prestress = {{ xx = 10e6, yy = 4e6 }}
boundaries = {{ left = "quiet", right = "quiet", bottom = "quiet", top = "quiet" }}
time = {{ duration = 1e-3 }}
record = {{ points = {PLACES} }}
"""
FAULT = """
[[joint_sets]]
name = "fault"
dip = 30.0
normal_stiffness = 1e13
shear_stiffness = 1e13
"""


def rings(path, n):
    """Let gmsh mesh a square with a hole by quadrilaterals, n along an eighth of the hole."""
    with gmsh_session() as gmsh:
        geo, angle = gmsh.model.geo, np.arange(8) * np.pi / 4
        around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        centre = geo.addPoint(0, 0, 0)
        near = [geo.addPoint(*at, 0) for at in HOLE.radius * around]
        far = [geo.addPoint(*at, 0) for at in HALF * around / np.abs(around).max(axis=1)[:, None]]
        arcs = [geo.addCircleArc(near[k], centre, near[k - 7]) for k in range(8)]
        edges = [geo.addLine(far[k], far[k - 7]) for k in range(8)]
        rays = [geo.addLine(near[k], far[k]) for k in range(8)]
        for k in range(8):
            loop = geo.addCurveLoop([rays[k], edges[k], -rays[k - 7], -arcs[k]])
            surface = geo.addPlaneSurface([loop])
            geo.mesh.setTransfiniteSurface(surface)
            geo.mesh.setRecombine(2, surface)
        for line in (*arcs, *edges):
            geo.mesh.setTransfiniteCurve(line, n + 1)
        for line in rays:
            growth = (HALF / HOLE.radius) ** (0.5 / n)
            geo.mesh.setTransfiniteCurve(line, 2 * n + 1, "Progression", growth)
        geo.synchronize()
        grouped(gmsh, 2, "rock", [tag for _, tag in gmsh.model.getEntities(2)])
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))


def excavated(folder, text):
    """Return the problem of a scene, with what Kirsch's solution adds to the in-situ stress at the
    sides, and its state at rest around the hole."""
    (folder / "scene.toml").write_text(text)
    (scene,) = load(folder / "scene.toml")
    problem = plan_of(scene).problem
    sides = facets_on(problem.body, ["left", "right", "bottom", "top"])
    added = np.diag(HOLE.stress) - HOLE.stress_at(sides.place)
    beyond = forces_on(problem.body, sides, np.einsum("nij,nj->ni", added, sides.normal))
    problem = problem._replace(steady=problem.steady + beyond)
    return problem, settled(scene, problem)


def errors(problem, rest):
    """Return how far displacement and stress are off, over the largest of the displacement and the
    larger in-situ stress; displacement but for a rigid motion."""
    x, read = problem.body.x, problem.readings
    exact = HOLE.displacement_at(x)
    one, none = np.ones(len(x)), np.zeros(len(x))
    rigid = np.stack([[one, none], [none, one], [-x[:, 1], x[:, 0]]]).transpose(2, 1, 0)
    rigid, off = rigid.reshape(-1, 3), rest.u - exact.ravel()
    off -= rigid @ np.linalg.lstsq(rigid, off, rcond=None)[0]
    tensor = HOLE.stress_at(np.array(PLACES))
    aim = np.stack([tensor[:, 0, 0], tensor[:, 1, 1], tensor[:, 0, 1]], axis=1).ravel()
    stress = read.stress @ rest.u + read.constant
    return np.array([np.abs(off).max() / np.abs(exact).max(), np.abs(stress - aim).max() / 10e6])


@pytest.mark.parametrize(("order", "coarse"), [(1, 16), (2, 8)])
def test_displacement_and_stress_around_a_tunnel_are_those_of_kirsch(order, coarse, tmp_path):
    """At order 2 in the size of the elements, whatever theirs: the hole is a polygon with a corner
    at each of them, whose area is off by (h/a)^2 / 6, and stress at points takes displacements to
    one order less, recovered."""
    off = []
    for n in (coarse, 2 * coarse):
        rings(tmp_path / "rock.msh", n)
        off.append(errors(*excavated(tmp_path, SCENE + f"numerics.continuum.order = {order}\n")))
    assert (np.log2(off[0] / off[1]) > 1.9).all()
    assert off[1].max() < 2e-3


def test_a_joint_beside_a_tunnel_slips_where_coulombs_criterion_says(tmp_path):
    """A stiff joint carries what the rock would, so Kirsch's tractions say which friction holds it
    everywhere, and where it gives way first: where |t_s| > tan(phi) t_n. With 4 % less friction
    than the most that is called for, all points where it is called for slip, and hand on to one at
    either end what they no longer bear; with 4 % more nothing slips."""
    normal = np.array([-0.5, np.sqrt(0.75)])
    x = np.linspace(-HALF, HALF, 4001)
    line = np.stack([x, 1.6 + np.tan(np.pi / 6) * x], axis=1)
    joints = {"joint fault": line[[0, -1]]}
    crossed(tmp_path / "rock.msh", joints, -HALF, HALF, hole=(0.0, 0.0), size=SIZE)

    def called_for(places):
        tractions = HOLE.stress_at(places) @ normal
        return np.abs(tractions @ [normal[1], -normal[0]]) / (tractions @ normal)

    most = called_for(line).max()
    for share in (1.04, 0.96):
        angle = np.degrees(np.arctan(share * most))
        problem, rest = excavated(tmp_path, SCENE + FAULT + f"friction_angle = {angle}\n")
        places = problem.body.joints.place
        at_first = history_at_rest(problem.points(), problem.parts, 2)
        slid, over = rest.history[SLIDE] != at_first[SLIDE], called_for(places) > share * most
        assert slid[over].all() and over.any() == (share < 1)
        assert slid.sum() <= over.sum() + 2
        apart = np.hypot(*(places[slid][:, None] - places[over]).T)
        assert (apart.min(axis=0, initial=np.inf) < SIZE).all()
