"""The spatial lattice against an ODE solver on contact points, the lattice, and other frames."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from closed_forms import leapfrog
from closed_forms.square_face import face_points
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.pillar import bodies, system_of
from jointwave.compare.exact.conditions import drive

ACROSS = {"direction": [1.0, 0.0, 0.0]}
OBLIQUE = [0.48, 0.6, -0.64]
SHORT = {"length": 2.0, "side": 0.5, "block": 0.5}
CENTRES = {"stress": [0.0, 0.5, 1.0, 2.0], "velocity": [0.25, 0.75, 1.25, 1.75], "interval": 1e-4}
SOFT = [{"y": 1.0, "spacing_stiffness": 4.375e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
AT_START = {"stress": [0.0], "velocity": []}


class Points:
    """Equations of motion of four blocks with two massless faces, every contact by its points."""

    def __init__(self, scene):
        p, self.scene, self.d, self.load = calibrate(scene), scene, 0.5, drive(scene)
        self.points = face_points(0.5, scene.joints.contact_points, scene.joints.point_rule)
        eta, joints = p.time_constant or 0.0, p.joint_time_constant
        joints = np.zeros(3) if joints is None else joints
        self.half = self.matrix(2 * p.regular_stiffness, 2 * p.regular_shear_stiffness), eta
        intact = 2 * scene.rock.intact_modulus / 0.5  # of half a block
        self.wall = self.matrix(intact, intact / 2.5), eta
        springs = map(self.matrix, p.stiffness, p.shear_stiffness)
        self.joints = list(zip(springs, joints, strict=True))
        self.dashpot = self.matrix(p.impedance, p.shear_impedance)
        across, along = (p.block_mass * x for x in (0.5**2 / 6, 0.5**2 / 6))
        self.mass = np.array([p.block_mass] * 3 + [across, along, across])
        self.alpha, self.ends = p.mass_damping or 0.0, (scene.ends.start, scene.ends.end)

    def resistance(self, normal, shear, rel):
        """Return F and M [6] of springs or dashpots per unit area against a relative motion."""
        out = np.zeros(6)
        for x, z, area in zip(*self.points, strict=True):
            r = np.array([x, 0.0, z])
            way = rel[:3] + np.cross(rel[3:], r)
            f = area * way * [shear, normal, shear]
            out += np.concatenate([f, np.cross(r, f)])
        return out

    def matrix(self, normal, shear):
        return np.array([self.resistance(normal, shear, e) for e in np.eye(6)]).T

    def face(self, q, h):
        return q + h * np.array([-q[5], 0, q[3], 0, 0, 0])

    def end(self, kind, q, v, face, wall):
        """Return what an end resists its block's face by, and the velocity of the end's face."""
        if kind == "free":
            return np.zeros(6), np.zeros(6)
        if kind == "quiet":
            return self.dashpot @ v, np.zeros(6)
        spring, eta = self.wall if kind == "fixed" else self.half
        if kind == "fixed":
            return spring @ (q - face + eta * (v - wall)), wall
        w = np.linalg.solve(self.dashpot + eta * spring, spring @ (q - face + eta * v))
        return self.dashpot @ w, w

    def slope(self, t, state):
        q, v, faces = np.split(state, [24, 48])
        q, v, faces, d = q.reshape(4, 6), v.reshape(4, 6), faces.reshape(2, 6), self.d
        load, wall, force = self.scene.load, np.zeros(6), np.zeros((4, 6))

        def push(i, h, f):
            force[i] += f
            force[i, 3:] += h * np.array([f[2], 0, -f[0]])  # of an arm along y

        for j, (spring, eta) in enumerate(self.joints):
            rel, rate = (self.face(x[j + 1], -d / 2) - self.face(x[j], d / 2) for x in (q, v))
            f = spring @ (rel + eta * rate)
            push(j + 1, -d / 2, -f)
            push(j, d / 2, f)
        f = self.load.value(t)
        if load.is_motion:
            wall[:3] = f * np.array(load.direction)
        elif load.arm:
            force[0, 3:] += 0.25 * f * load.arm * np.array(load.direction)
        else:
            f = 0.25 * f * np.array(load.direction)
            push(0, -d / 2, np.concatenate([f, np.cross([load.at[0], 0, load.at[1]], f)]))
        moves = []
        for kind, i, h, w in zip(self.ends, (0, 3), (-d / 2, d / 2), (wall, 0 * wall), strict=True):
            r, moved = self.end(kind, self.face(q[i], h), self.face(v[i], h), faces[i // 3], w)
            push(i, h, -r)
            moves.append(moved)
        force -= self.alpha * self.mass * v
        return np.concatenate([v.ravel(), (force / self.mass).ravel(), *moves])

    def solved(self):
        """Return the motions and velocities [4, n, 6] at the scene's samples, by DOP853."""
        times, rows, x = sample_times(self.scene), [np.zeros(60)], np.zeros(60)
        breaks = [t for t in self.load.breaks if 0 < t < times[-1]]
        for start, stop in pairwise([0.0, *breaks, times[-1]]):
            within = times[(times > start) & (times <= stop)]
            part = solve_ivp(
                self.slope, (start, stop), x, "DOP853", within, rtol=1e-11, atol=1e-14
            ).y.T
            rows, x = [*rows, *part], part[-1]
        out = np.array(rows).T.reshape(-1, 6, len(times))
        return out[:4].swapaxes(1, 2), out[4:8].swapaxes(1, 2)


CASES = {
    "oblique": {"load": {"direction": OBLIQUE, "at": [0.1, -0.2]}},
    "couple": {"load": {"direction": OBLIQUE, "arm": 0.3}, "ends": {"end": "fixed"}},
    "matched": {
        "load": {"direction": OBLIQUE, "at": [0.1, -0.2]},
        "ends": {"start": "quiet", "end": "matched"},
        "joints": {"damping_ratio": 0.05},
        "damping": {"mass_proportional": 20.0},
    },
    "both": {"load": ACROSS, "ends": {"start": "matched", "end": "quiet"}, "soft_layers": SOFT},
    "shaken": {
        "load": {"direction": OBLIQUE, "quantity": "velocity", "amplitude": 0.1},
        "ends": {"start": "fixed", "end": "matched"},
        "joints": {"damping_ratio": 0.05},
        "soft_layers": SOFT,
    },
}


@pytest.mark.parametrize("name", CASES)
def test_the_sum_over_points_by_a_tight_ode_solver_agrees(scene, name):
    """The solver's 1e-11 a step gathers over some thousand of them."""
    tables = CASES[name]
    tables = tables | {"load": {"period": 0.004} | tables["load"]}
    at = scene(pillar=SHORT, time={"duration": 0.01}, record=CENTRES, **tables)
    q, v = Points(at).solved()
    result = row_of_blocks.solve(at)
    for variable, expected in (
        ("displacement", q[..., :3]),
        ("rotation", q[..., 3:]),
        ("velocity", v[..., :3]),
    ):
        off = np.abs(result[variable].values - expected).max()
        assert off <= 1e-7 * np.abs(expected).max()


@pytest.mark.parametrize("start, end", [("free", "matched"), ("quiet", "fixed")])
def test_its_axial_part_is_the_lattice_s(scene, misfit, start, end):
    """Two assemblies, one propagator: round-off."""
    common = {
        "pillar": {"length": 20.0},
        "ends": {"start": start, "end": end},
        "joints": {"damping_ratio": 0.05},
        "damping": {"mass_proportional": 10.0},
        "prestress": {"normal": 3e5},
        "time": {"duration": 0.04},
        "record": {"stress": [0.0, 5.0, 20.0], "velocity": [0.0, 5.0, 17.0]},
    }
    spatial_one = row_of_blocks.solve(scene(**common, load={"direction": [0.6, 0.8, 0.0]}))
    axial = row_of_blocks.solve(scene(**common, load={"amplitude": 0.8e6}))
    assert misfit(spatial_one.stress, axial.stress) < 1e-11
    assert (spatial_one.stress_error < 1e-9 * 1e6).all()  # the prestress is no error
    for variable in ("velocity", "displacement"):
        assert misfit(spatial_one[variable][..., 1], axial[variable][..., 0]) < 1e-11


@pytest.mark.parametrize("rotation", ["none", "small"])
def test_an_accelerated_base_is_gravity_in_its_own_frame(scene, misfit, rotation):
    """A base that accelerates by a from t = 0 strains the row as a weight of -m a, and the blocks
    move a t^2/2 further. Differences of displacements cost some digits: 1e-9."""
    common = {
        "pillar": {"length": 5.0},
        "motion": {"rotation": rotation},
        "joints": {"damping_ratio": 0.05},
        "ends": {"start": "fixed"},
        "time": {"duration": 0.02},
        "record": {"stress": [1.0, 3.0], "velocity": [0.25, 4.75], "interval": 2e-4},
    }
    step = {"shape": "step", "period": None}
    shaken = row_of_blocks.solve(
        scene(**common, load=step | {"quantity": "acceleration", "amplitude": 7.0} | ACROSS)
    )
    heavy = row_of_blocks.solve(
        scene(
            **common,
            load=step | {"amplitude": 0.0},
            gravity={"direction": [-1.0, 0.0, 0.0], "acceleration": 7.0, "static": False},
        )
    )
    way = np.zeros_like(heavy.displacement.values)
    way[..., 0] = 7.0 * heavy.time.values**2 / 2
    assert misfit(shaken.shear, heavy.shear) < 1e-9
    assert misfit(shaken.displacement, heavy.displacement + way) < 1e-9
    if rotation == "small":
        assert misfit(shaken.rotation, heavy.rotation) < 1e-9


def test_sudden_gravity_settles_at_the_static_state(scene, misfit):
    """Every mode, the slowest of 139 rad/s, decays as e^{-alpha t/2}: e^{-40} at the end."""
    common = {
        "pillar": {"length": 2.0},
        "ends": {"end": "fixed"},
        "load": {"amplitude": 0.0},
        "damping": {"mass_proportional": 200.0},
        "time": {"duration": 0.4},
        "record": {"stress": [1.0], "velocity": [0.25], "interval": 2e-3},
    }
    direction = {"direction": [0.6, 0.8, 0.0]}
    sudden = row_of_blocks.solve(scene(**common, gravity=direction | {"static": False}))
    static = row_of_blocks.solve(scene(**common, gravity=direction))
    for variable in ("stress", "shear", "displacement", "rotation"):
        assert misfit(sudden[variable][:, -1], static[variable][:, -1]) < 1e-9


@pytest.mark.parametrize("end", ["free", "fixed"])
def test_leapfrog_in_closed_form_is_leapfrog(scene, end):
    """Round-off: a phase of 2e3 steps is known to 2e3 eps, times the condition of the modes."""
    tables = {"gravity": {"direction": [1.0, 0.0, 0.0], "static": False}, "load": ACROSS}
    at = scene(**tables, pillar={"length": 5.0}, ends={"end": end}, record=AT_START)
    one, rng = system_of(at), np.random.default_rng(1)
    modes = leapfrog.modes_of_blocks(*bodies(at))
    dt, place = 0.9 * 2 / modes.omega.max(), rng.standard_normal(len(one.mass))
    force, steps = rng.standard_normal(2000), np.array([1, 2, 17, 1000, 2000])
    u, v, seen = 0 * place, 0 * place, []
    for n, f in enumerate(force, 1):
        v += dt / one.mass * (f * place - one.stiffness @ u)
        u = u + dt * v
        if n in steps:
            seen.append(u)
    found = leapfrog.of_modes(modes, place, force, steps, dt)
    assert np.linalg.norm(found - np.array(seen).T) / np.linalg.norm(found) < 1e-10


def test_leapfrog_converges_to_the_lattice_at_order_two(scene):
    at = scene(
        pillar={"length": 5.0},
        load=ACROSS | {"period": 0.005},
        time={"duration": 0.02},
        record={"stress": [], "velocity": [0.25, 2.75], "interval": 2.5e-3},
    )
    modes, place = leapfrog.modes_of_blocks(*bodies(at)), np.zeros(60)
    place[[0, 5]] = 0.25, 0.25 * 0.25  # an end stress of 1 Pa, and its lever of half a block
    exact = row_of_blocks.solve(at)
    expected = np.concatenate([exact.displacement[..., 0], exact.rotation[..., 2]])
    errors = []
    for count in (2000, 4000, 8000):
        dt, steps = 0.02 / count, np.arange(9) * count // 8
        force = step_means(load_history(at), dt, count)
        u = leapfrog.of_modes(modes, place, force, steps, dt)
        errors.append(np.linalg.norm(u[[0, 30, 5, 35]] - expected))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.02)
