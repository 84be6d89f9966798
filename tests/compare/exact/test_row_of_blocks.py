"""Rows of rigid blocks, exact in time, against an ODE solver on contact points and closed forms."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from closed_forms import cantilever, leapfrog
from closed_forms.square_face import face_points
from jointwave.cases.histories import Recorded
from jointwave.cases.loads import late_load, load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.compare.exact.bar import modes
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.linear import twins

ACROSS = {"direction": [1.0, 0.0, 0.0]}
OBLIQUE = [0.48, 0.6, -0.64]
SHORT = {"length": 2.0, "side": 0.5, "block": 0.5}
CENTRES = {"stress": [0.5, 1.0, 1.5], "velocity": [0.25, 0.75, 1.25, 1.75], "interval": 1e-4}
SOFT = [{"y": 1.0, "spacing_stiffness": 4.375e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
DOWN = {"direction": [0.0, 1.0, 0.0]}
RECORD = {"stress": [0.0, 1.0, 20.0, 50.0], "velocity": [0.25, 20.25, 49.75]}


def arm(x, y, z):
    """Return the motion of a point of a body by its displacements and rotations, [3, 6]."""
    return np.hstack([np.eye(3), np.cross(np.eye(3), [x, y, z]).T])


class Points:
    """Equations of motion of four blocks and two massless faces, 4 and 5, before ground, 6: every
    contact by its points."""

    def __init__(self, scene):
        p, self.scene, self.load = calibrate(scene), scene, late_load(scene)
        self.points = face_points(0.5, scene.joints.contact_points, scene.joints.point_rule)
        self.K, self.C = np.zeros((2, 36, 36))
        self.mass = np.tile(p.block_mass * np.array([1, 1, 1, *[0.5**2 / 6] * 3]), 4)
        self.alpha, self.free = p.mass_damping or 0.0, np.zeros(12, bool)
        eta, joints = p.time_constant or 0.0, p.joint_time_constant
        joints = np.zeros(3) if joints is None else joints
        laws = zip(p.stiffness, p.shear_stiffness, joints, strict=True)
        self.joints = [(self.join(j, j + 1, *law), law[2]) for j, law in enumerate(laws)]
        half, dashpot = 2 * p.regular_stiffness, (p.impedance, p.shear_impedance)
        intact = 2 * scene.rock.intact_modulus / 0.5  # of half a block
        walls = {"fixed": (intact, intact / 2.5), "matched": (half, 2 * p.regular_shear_stiffness)}
        for kind, pair, face in ((scene.ends.start, (4, 0), 4), (scene.ends.end, (3, 5), 5)):
            if kind in walls:
                self.join(*pair, *walls[kind], eta)
            if kind == "quiet":
                self.join(*(6 if body == face else body for body in pair), *dashpot)
            if kind == "matched":
                self.join(face, 6, *dashpot)
                self.free[6 * face - 24 : 6 * face - 18] = True

    def join(self, one, other, normal, shear, eta=None):
        """Add springs per unit area with a time constant, or dashpots without; return what they
        pull `one` by, [3, 36]."""
        pull = np.zeros((3, 36))
        for x, z, area in zip(*self.points, strict=True):
            relative = np.zeros((3, 42))
            for body, sign in ((one, -1), (other, 1)):
                y = -sign * 0.25 if body < 4 else 0.0
                relative[:, 6 * body : 6 * body + 6] = sign * arm(x, y, z)
            relative = relative[:, :36]
            own = area * np.diag([shear, normal, shear]) @ relative
            self.K += 0.0 if eta is None else relative.T @ own
            self.C += (1.0 if eta is None else eta) * relative.T @ own
            pull += own
        return pull

    def slope(self, t, state):
        """Return the rates of all motions [36] and of the blocks' velocities [24]."""
        (q, v), load, free = np.split(state, [36]), self.scene.load, self.free
        w, f = np.zeros(12), self.load.value(t) * np.array(load.direction)
        if load.is_motion:
            w[:3] = f
        left = self.K @ q + self.C @ np.append(v, w)
        w[free] -= np.linalg.solve(self.C[24:, 24:][np.ix_(free, free)], left[24:][free])
        force = -(self.K @ q + self.C @ np.append(v, w))[:24] - self.alpha * self.mass * v
        if load.arm:
            force[3:6] += 0.25 * load.arm * f
        elif not load.is_motion:
            force[:6] += 0.25 * arm(load.at[0], -0.25, load.at[1]).T @ f
        return np.concatenate([v, w, force / self.mass])

    def solved(self):
        """Return motions and velocities of the blocks [n, 24] at the scene's samples, by DOP853 of
        the slopes, which are linear in the state and the load."""
        times, rows, x = sample_times(self.scene), [], np.zeros(60)
        A = np.array([self.slope(-1.0, e) for e in np.eye(60)]).T
        b = self.slope(5e-4, np.zeros(60)) / self.load.value(5e-4)

        def rate(t, x):
            return A @ x + b * self.load.value(t)

        breaks = [t for t in self.load.breaks if 0 < t < times[-1]]
        for start, stop in pairwise([0.0, *breaks, times[-1]]):
            within = np.append(times[(times >= start) & (times < stop)], stop)
            tight = {"rtol": 1e-11, "atol": 1e-14}
            *part, x = solve_ivp(rate, (start, stop), x, "DOP853", within, **tight).y.T
            rows += part
        found = np.array([*rows, x])
        return found[:, :24], found[:, 36:]


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
    """The solver's 1e-11 a step gathers over some thousand of them; forces by stiff springs lose
    two digits of the motion."""
    load = {"load": {"period": 0.004} | CASES[name]["load"]}
    at = scene(pillar=SHORT, time={"duration": 0.01}, record=CENTRES, **CASES[name] | load)
    points, result = Points(at), row_of_blocks.solve(at)
    q, v = points.solved()
    pulls = [(q + eta * v) @ pull[:, :24].T for pull, eta in points.joints]
    traction, (q, v) = np.array(pulls) / -0.25, (x.reshape(-1, 4, 6).swapaxes(0, 1) for x in (q, v))
    for found, expected in (
        (result.displacement, q[..., :3]),
        (result.rotation, q[..., 3:]),
        (result.velocity, v[..., :3]),
        (result.stress, traction[..., 1]),
        (result.shear, traction[..., [0, 2]]),
    ):
        assert np.abs(found.values - expected).max() <= 1e-7 * np.abs(expected).max()


@pytest.mark.parametrize(
    "n, rule", [(None, "vertices"), (1, "midpoint"), (2, "midpoint"), (3, "gauss")]
)
def test_springs_push_as_the_sum_over_the_points_of_any_rule(scene, n, rule):
    """Round-off: some hundred terms, each known to 1e-16."""
    rules = {"contact_points": n, "point_rule": rule}
    at = scene(pillar=SHORT, load=ACROSS, soft_layers=SOFT, joints=rules, record=CENTRES)
    q = np.random.default_rng(3).standard_normal(24)
    expected, found = Points(at).K[:24, :24] @ q, system_of(at).stiffness @ q
    assert np.abs(found - expected).max() < 1e-13 * np.abs(expected).max()


@pytest.mark.parametrize(
    "start, end", [("free", "matched"), ("quiet", "fixed"), ("matched", "quiet")]
)
def test_its_axial_part_is_the_axial_row(scene, misfit, start, end):
    """Two assemblies, one propagator: round-off."""
    common = {
        "pillar": {"length": 20.0},
        "ends": {"start": start, "end": end},
        "joints": {"damping_ratio": 0.05},
        "soft_layers": [SOFT[0] | {"y": 5.0}],
        "damping": {"mass_proportional": 10.0},
        "prestress": {"normal": 3e5},
        "time": {"duration": 0.04},
        "record": {"stress": [0.0, 5.0, 20.0], "velocity": [0.0, 5.0, 17.0]},
    }
    spatial = row_of_blocks.solve(scene(**common, load={"direction": [0.6, 0.8, 0.0]}))
    axial = row_of_blocks.solve(scene(**common, load={"amplitude": 0.8e6}))
    assert misfit(spatial.stress, axial.stress) < 1e-11
    assert (spatial.stress_error < 1e-9 * 1e6).all()  # the prestress is no error
    for variable in ("velocity", "displacement"):
        assert misfit(spatial[variable][..., 1], axial[variable][..., 0]) < 1e-11


DAMPED = {"damping_ratio": 0.05}


@pytest.mark.parametrize(
    "tables, axis, bound",
    [
        ({}, 1, 1e-9),
        ({"joints": DAMPED | {"tension": False}}, 1, 1e-6),  # 1e-9 a step, gathered
        ({"motion": {"rotation": "none"}}, 0, 1e-9),
        ({"motion": {"rotation": "small"}}, 0, 1e-9),
    ],
)
def test_an_accelerated_base_is_gravity_in_its_own_frame(scene, misfit, tables, axis, bound):
    """A base that accelerates by a from t = 0 strains the row as a sudden weight of -m a, which
    presses its joints until the echo of the free end is back, at L/c = 7.4 ms; the blocks move
    a t^2/2 further. Differences of displacements cost some digits."""
    common = {
        "pillar": {"length": 10.0},
        "joints": DAMPED,
        "ends": {"start": "fixed"},
        "time": {"duration": 0.007},
        "record": {"stress": [1.0, 3.0], "velocity": [0.25, 9.75], "interval": 1e-4},
    }
    way, step = np.eye(3)[axis], {"shape": "step", "period": None}
    motion = step | {"quantity": "acceleration", "amplitude": 7.0, "direction": way.tolist()}
    weight = {"direction": (-way).tolist(), "acceleration": 7.0, "static": False}
    shaken = row_of_blocks.solve(scene(**common | tables, load=motion))
    linear = {key: table for key, table in tables.items() if key != "joints"}
    heavy = row_of_blocks.solve(
        scene(**common | linear, load=step | {"amplitude": 0.0}, gravity=weight)
    )
    further = np.zeros_like(heavy.displacement.values)
    further[..., list(heavy.axis.values).index("xyz"[axis])] = 7.0 * heavy.time.values**2 / 2
    assert misfit(shaken.displacement, heavy.displacement + further) < bound
    for variable in ("stress",) if axis else ("shear", "rotation"):
        if heavy[variable].values.any():
            assert misfit(shaken[variable], heavy[variable]) < bound


def test_the_modes_of_a_chain_under_a_sine_agree(scene, misfit):
    """u_j = sum_n phi_n(j) phi_n(1) q_n A / m_n with q_n in closed form; round-off of 100 modes."""
    record = {"velocity": [0.25 + 0.5 * j for j in (0, 39, 99)]}
    at = scene(joints={"damping_ratio": 0.02}, record=record)
    p, load, times = calibrate(at), load_history(at), sample_times(at)
    omega = leapfrog.frequencies(p.regular_stiffness * p.area, p.block_mass, 100)
    shapes = np.cos(np.outer(np.arange(100) + 0.5, np.arange(100)) * np.pi / 100)
    q, _ = modes.sums(np.eye(99), omega[1:], p.time_constant, load, times)
    q = np.array([load.double_impulse(times), *q])
    weights = p.area * shapes[0] / (p.block_mass * (shapes**2).sum(axis=0))
    expected = shapes[[0, 39, 99]] @ (weights[:, None] * q)
    assert misfit(row_of_blocks.solve(at).displacement.values[..., 0], expected) < 1e-10


STILL = {"load": {"amplitude": 0.0}, "time": {"duration": 0.01}, "record": RECORD}


def test_a_column_carries_its_own_weight(scene):
    """rho g y and the prestress in every section; a block sinks by what the joints below it close,
    and the half block of intact rock at the wall: g rho S^2 (sum_{j = i}^{N - 1} j / E_eq +
    N / 2 E). Two solves, condition 1e4: 1e-11."""
    at = scene(**STILL, gravity=DOWN, prestress={"normal": 2e5}, ends={"end": "fixed"})
    p, result = calibrate(at), row_of_blocks.solve(at)
    weight = 2400 * 9.81 * np.array(RECORD["stress"])
    assert np.allclose(result.stress.values, 2e5 + weight[:, None], rtol=1e-11)
    below = np.array([sum(range(i, 100)) for i in (1, 41, 100)])
    sunk = 9.81 * 2400 * 0.25 * (below / p.modulus + 50 / 8.64e10)
    assert np.allclose(result.displacement.values[..., 0], sunk[:, None], rtol=1e-11)


@pytest.mark.parametrize("ends", [("free", "fixed"), ("fixed", "quiet"), ("free", "matched")])
def test_a_prestressed_row_stands_still_where_displacement_counts_from(scene, ends):
    """Its own state is the origin of displacement, and its stress is the prestress."""
    at = scene(**STILL, prestress={"normal": 2e5}, ends={"start": ends[0], "end": ends[1]})
    result = row_of_blocks.solve(at)
    assert not result.displacement.any()
    assert np.allclose(result.stress, 2e5, rtol=1e-12)


@pytest.mark.parametrize("axis, turns, sign", [(0, 2, 1), (2, 0, -1)])
@pytest.mark.parametrize("rule, share", [("vertices", 1.0), ("midpoint", 0.75)])
def test_the_cantilever_hangs_as_the_explicit_sum(scene, axis, turns, sign, rule, share):
    """A solve of a matrix whose condition grows as N^4, here 1e4: twelve digits. Towards the free
    start a block moves by theta_z l along x, and by -theta_x l along z."""
    velocity = [0.25 + 0.5 * i for i in range(6)]
    at = scene(
        pillar={"length": 3.0, "side": 0.7, "block": 0.5},
        record={"stress": [0.0, 1.0, 3.0], "velocity": velocity, "interval": 1e-4},
        rock={"intact_modulus": None},  # half a joint at the wall
        load={"amplitude": 0.0},
        joints={"point_rule": rule},
        gravity={"direction": np.eye(3)[axis].tolist()},
        ends={"end": "fixed"},
        time={"duration": 1e-3},
    )
    p, result = calibrate(at), row_of_blocks.solve(at)
    slides, bends = (K * p.area for K in (p.regular_shear_stiffness, p.regular_stiffness))
    weight = 9.81 * p.block_mass
    u, theta = cantilever.deflection(6, 0.5, weight, slides, bends * share * 0.7**2 / 12)
    assert np.allclose(result.displacement.values[:, -1, axis], u, rtol=1e-11)
    assert np.allclose(result.rotation.values[:, -1, turns], sign * theta, rtol=1e-11)
    shear = result.shear.values[:, -1, [0, 2].index(axis)]
    assert np.allclose(shear, 2400 * 9.81 * np.array([0.0, 1.0, 3.0]), rtol=1e-11, atol=1e-6)
    assert np.abs(result.velocity.values).max() == 0


def test_breaks_of_the_load_between_samples_are_integrated_exactly():
    """lsim is exact where the load is linear between its samples, here at sixths of ours."""
    A, B = np.array([[0.0, 3.0], [-3.0, -0.4]]), np.array([0.5, 1.0])
    times, fine = np.linspace(0, 12, 61), np.linspace(0, 12, 361)
    breaks = np.array([0.1, 1.0, 1.1, 1.1 + 1 / 30, 7.0])
    load = Recorded(breaks, np.array([0.0, 3.0, -1.0, 2.0, 0]))
    _, expected, _ = lsim((A, B[:, None], np.eye(2), np.zeros((2, 1))), load.value(fine), fine)
    assert np.abs(twins(A, B, load, times)[0] - expected[::6]).max() < 1e-12
