"""The numbers that engines and referees share, each worked out by hand.

A pillar of four blocks 2 m wide and 1.5 m thick: rock of 2000 kg/m3, E_eq = 8 GPa and nu = 1/4 with
joints, 24 GPa and 1/5 without. Both engines and all solutions start from these numbers, so a
comparison of them sees no fault here.
"""

from math import exp, pi, sqrt

import numpy as np
import pytest

from closed_forms.square_face import face_points
from jointwave.cases import SceneError, load
from jointwave.cases.histories import Recorded, Ricker, Sine, Step
from jointwave.cases.loads import base_steps, load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.rock import modulus_from_speeds, speeds_from_modulus
from jointwave.cases.records import read_history
from jointwave.cases.sampling import clock, interpolation, sample_times
from jointwave.cases.schema.damping import Rayleigh
from jointwave.cases.schema.scene import Scene
from jointwave.compare.scenes import SHIPPED
from jointwave.results.subcells import linear_cells

ROCK = {
    "density": 2000.0,
    "equivalent_modulus": 8e9,
    "equivalent_poisson": 0.25,
    "intact_modulus": 2.4e10,
    "intact_poisson": 0.2,
}
RECORD = {"stress": [3.0], "energy": False}
#: y = 4.5 m comes first; K_n = 6e9 / 1.5 = 4e9, K'_n = 4e9 / (1 + 1.5 * 4e9 / 2.4e10) = 3.2e9.
SOFT = {"y": 4.5, "spacing_stiffness": 6e9, "damping_ratio": 0.05}
#: As stiff as the others, under another dashpot.
STIFF = {"y": 1.5, "damping_ratio": 0.2}


def scene(**tables):
    """Return the pillar with tables put in place of its own."""
    own = {
        "title": "by hand",
        "pillar": {"length": 6.0, "side": 2.0, "block": 1.5},
        "rock": ROCK,
        "load": {"shape": "step", "amplitude": 3.0},
        "time": {"duration": 0.01},
        "record": RECORD | {"interval": 1e-3},
    }
    return Scene.model_validate(own | tables)


def exact(value):
    """Hold a number to round-off."""
    return pytest.approx(value, rel=1e-14, abs=0)


class TestCalibration:
    """Equations (4) to (7), inertia, speeds."""

    def test_blocks(self):
        p = calibrate(scene())
        assert (p.block_count, p.spacing, p.side, p.area) == (4, 1.5, 2.0, 4.0)
        assert p.joint_y.tolist() == [1.5, 3.0, 4.5]
        assert p.block_mass == 12000.0  # 2000 * 4 * 1.5
        assert p.inertia_across == 6250.0  # 12000 (2^2 + 1.5^2) / 12
        assert p.inertia_along == 8000.0  # 12000 * 2 * 2^2 / 12

    def test_speeds_and_impedances(self):
        p = calibrate(scene())
        assert p.shear_modulus == 3.2e9  # 8e9 / 2.5
        assert (p.bar_speed, p.impedance) == (2000.0, 4e6)
        assert p.shear_speed == exact(1264.9110640673518)  # sqrt(1.6e6)
        assert p.shear_impedance == exact(2529822.1281347036)

    def test_stiffness_of_ordinary_joints(self):
        """1 / K_n = 1.5 (1 / 8e9 - 1 / 24e9); 1 / K_s = 1.5 (1 / 3.2e9 - 1 / 10e9)."""
        p = calibrate(scene())
        assert p.stiffness == exact(np.full(3, 16e9 / 3))
        assert p.shear_stiffness == exact(np.full(3, 6.4e9 / 3))
        assert p.own_stiffness == exact(np.full(3, 8e9))
        assert p.own_shear_stiffness == pytest.approx(np.full(3, 1e9 / 0.31875), rel=1e-13)
        assert p.regular_stiffness == exact(16e9 / 3)
        assert p.regular_shear_stiffness == exact(6.4e9 / 3)
        assert p.regular_own_stiffness == exact(8e9)
        assert not p.excess_compliance.any()

    def test_stiffness_of_soft_layers_stands_at_their_own_joint(self):
        """K'_s = 3.2e9 / 2.5; 1 / K_s = 1 / 1.28e9 - 1.5 / 10e9; excess 1 / 3.2e9 - 1.5 / 8e9."""
        p = calibrate(scene(soft_layers=[SOFT, STIFF]))
        assert p.soft.tolist() == [2, 0]
        assert p.stiffness == exact(np.array([16e9 / 3, 16e9 / 3, 3.2e9]))
        assert p.shear_stiffness == exact(np.array([6.4e9 / 3, 6.4e9 / 3, 1.28e9]))
        assert p.own_stiffness == exact(np.array([8e9, 8e9, 4e9]))
        own = np.array([1e9 / 0.31875, 1e9 / 0.31875, 1e9 / 0.63125])
        assert p.own_shear_stiffness == pytest.approx(own, rel=1e-13)
        assert p.excess_compliance == pytest.approx(np.array([0, 0, 1.25e-10]), rel=1e-13)

    def test_ordinary_joints_are_known_where_all_are_soft(self):
        soft = [{"y": y, "spacing_stiffness": 7e9} for y in (1.5, 3.0, 4.5)]
        p = calibrate(scene(soft_layers=soft))
        assert p.regular_own_shear_stiffness == pytest.approx(1e9 / 0.31875, rel=1e-13)

    def test_given_stiffness_decides_the_moduli(self):
        """1 / E = 1 / 24e9 + 1 / (1.5 * 8e9) = 1 / 8e9; 1 / G = 1 / 10e9 + 1 / (1.5 * 10e9)."""
        rock, joints = ROCK | {"equivalent_modulus": 5e9}, {"normal_stiffness": 8e9}
        without = {k: v for k, v in ROCK.items() if k != "equivalent_modulus"}
        p = calibrate(scene(rock=without, joints=joints))
        assert p.modulus == exact(8e9) and p.shear_modulus == exact(3.2e9)
        assert p.stiffness == exact(np.full(3, 16e9 / 3))
        p = calibrate(scene(rock=rock, joints={"shear_stiffness": 1e10}))
        assert p.modulus == 5e9 and p.shear_modulus == exact(6e9)
        assert p.shear_stiffness == exact(np.full(3, 4e9))
        assert p.own_shear_stiffness == pytest.approx(np.full(3, 1e10), rel=1e-13)

    def test_shear_stiffness_of_a_layer_is_its_own(self):
        """K'_s = 1e10 / (1 + 1.5 * 1e10 / 1e10) = 4e9, beside K'_n of the soft layer."""
        p = calibrate(scene(soft_layers=[SOFT | {"shear_stiffness": 1e10}]))
        assert p.shear_stiffness == exact(np.array([6.4e9 / 3, 6.4e9 / 3, 4e9]))
        assert p.stiffness[2] == exact(3.2e9)

    def test_rock_as_soft_as_rock_and_joints_has_rigid_joints_in_shear(self):
        """G of the blocks is 10e9; 8e9 / (2 * 0.4) is that of the rock mass."""
        p = calibrate(scene(rock=ROCK | {"equivalent_poisson": -0.6}))
        assert p.shear_modulus == exact(1e10)
        assert np.isinf(
            calibrate(scene(rock=ROCK | {"equivalent_poisson": -0.7})).own_shear_stiffness
        ).all()

    def test_speeds_of_an_unbounded_medium(self):
        """2 : 1 is nu = 1/3, and E = 2 * 3000 * 1000^2 * 4/3."""
        assert modulus_from_speeds(2000.0, 1000.0, 3000.0) == exact((8e9, 1 / 3))
        assert speeds_from_modulus(8e9, 1 / 3, 3000.0) == exact((2000.0, 1000.0))

    def test_tension_is_barred_joint_by_joint(self):
        layers = [SOFT | {"tension": True}, STIFF]
        p = calibrate(scene(joints={"tension": False}, soft_layers=layers))
        assert p.tension.tolist() == [False, False, True]
        p = calibrate(scene(soft_layers=[SOFT | {"tension": False}, STIFF]))
        assert p.tension.tolist() == [True, True, False]


class TestDamping:
    """Time constants: eta = 2 zeta sqrt(m / k), m = 2000 * 1.5 kg/m2."""

    def test_each_joint_by_its_own_ratio_and_its_own_stiffness(self):
        """0.06 sqrt(3000 / (16e9 / 3)) = 4.5e-5; 0.4 of the same root; 0.1 sqrt(3000 / 3.2e9)."""
        p = calibrate(scene(joints={"damping_ratio": 0.03}, soft_layers=[SOFT, STIFF]))
        assert p.time_constant == exact(4.5e-5)
        assert p.joint_time_constant == exact(np.array([3e-4, 4.5e-5, 9.682458365518543e-5]))
        assert p.damps_alone.tolist() == [True, False, False]

    def test_a_layer_without_a_ratio_takes_that_of_the_joints_at_its_own_stiffness(self):
        layer = {"y": 4.5, "spacing_stiffness": 6e9}
        p = calibrate(scene(joints={"damping_ratio": 0.03}, soft_layers=[layer]))
        expected = [4.5e-5, 4.5e-5, 5.809475019311125e-5]  # 0.06 sqrt(3000 / 3.2e9)
        assert p.joint_time_constant == exact(np.array(expected))

    @pytest.mark.parametrize("layers", [[SOFT], [SOFT, {"y": 1.5}]])
    def test_a_layer_alone_leaves_the_rock_undamped(self, layers):
        p = calibrate(scene(soft_layers=layers))
        assert p.time_constant is None
        assert p.joint_time_constant == exact(np.array([0, 0, 9.682458365518543e-5]))
        assert not p.damps_alone.any()

    def test_a_stiff_joint_damped_alone(self):
        p = calibrate(scene(soft_layers=[STIFF]))
        assert p.joint_time_constant == exact(np.array([3e-4, 0, 0]))
        assert p.damps_alone.tolist() == [True, False, False]
        assert not calibrate(scene(soft_layers=[{"y": 1.5}])).damps_alone.any()

    def test_an_undamped_layer_among_damped_joints(self):
        layer = SOFT | {"damping_ratio": 0.0}
        p = calibrate(scene(joints={"damping_ratio": 0.03}, soft_layers=[layer]))
        assert p.joint_time_constant == exact(np.array([4.5e-5, 4.5e-5, 0]))

    def test_rayleigh(self):
        """0.6 / 20 + 0.004 * 10 / 2 = 0.05 at 10 rad/s; 0.6 / 60 + 0.004 * 30 / 2 = 0.07 at 30."""
        frequencies, ratios = [10 / (2 * pi), 30 / (2 * pi)], [0.05, 0.07]
        law = Rayleigh(frequencies=frequencies, ratios=ratios)
        assert law.coefficients == pytest.approx((0.6, 0.004), rel=1e-13)
        tables = {"rayleigh": {"frequencies": frequencies, "ratios": ratios}}
        p = calibrate(scene(damping=tables, soft_layers=[{"y": 4.5, "spacing_stiffness": 6e9}]))
        assert p.mass_damping == pytest.approx(0.6, rel=1e-13)
        assert p.time_constant == pytest.approx(0.004, rel=1e-13)
        assert p.joint_time_constant == pytest.approx(np.full(3, 0.004), rel=1e-13)

    def test_rayleigh_without_the_round_off_of_one_that_is_zero(self):
        """Ratios proportional to frequencies, or to their inverse, except for the last digit."""
        frequencies = [1000.0, 7000.0]
        alpha, beta = Rayleigh(frequencies=frequencies, ratios=[0.017, 0.119]).coefficients
        assert alpha == 0 and beta == pytest.approx(0.017 / (1000 * pi), rel=1e-12)
        alpha, beta = Rayleigh(frequencies=frequencies, ratios=[0.119, 0.017]).coefficients
        assert beta == 0 and alpha == pytest.approx(0.119 * 4000 * pi, rel=1e-12)


class TestStrength:
    """Joint 2 under its own law, beside the others'."""

    def test_friction_cohesion_and_what_slip_leaves(self):
        joints = {"friction_angle": 45.0, "cohesion": 2e5}
        layer = {"y": 3.0, "friction_angle": 30.0, "cohesion": 1e5, "residual_cohesion": 4e4}
        p = calibrate(scene(joints=joints, soft_layers=[layer]))
        assert p.friction == exact(np.array([1.0, 1 / sqrt(3), 1.0]))
        assert p.cohesion.tolist() == [2e5, 1e5, 2e5]
        assert p.residual_cohesion.tolist() == [2e5, 4e4, 2e5]
        assert p.tensile_strength is None and p.critical_opening is None

    def test_all_of_it(self):
        joints = {"friction_angle": 45.0, "cohesion": 2e5, "residual_cohesion": 1e5}
        joints |= {"tensile_strength": 1e5, "fracture_energy": 30.0}
        p = calibrate(scene(joints=joints))
        assert p.friction == exact(np.ones(3)) and p.critical_opening == exact(np.full(3, 6e-4))
        assert p.cohesion.tolist() == [2e5] * 3 and p.residual_cohesion.tolist() == [1e5] * 3
        assert p.tensile_strength.tolist() == [1e5] * 3

    def test_softening_spends_the_triangle(self):
        """w_c = 2 * 30 / 1e5 of all, 2 * 50 / 4e5 of joint 2."""
        layer = {"y": 3.0, "tensile_strength": 4e5, "fracture_energy": 50.0}
        joints = {"tensile_strength": 1e5, "fracture_energy": 30.0}
        p = calibrate(scene(joints=joints, soft_layers=[layer]))
        assert p.tensile_strength.tolist() == [1e5, 4e5, 1e5]
        assert p.critical_opening == exact(np.array([6e-4, 2.5e-4, 6e-4]))
        assert p.friction is None and p.cohesion is None and p.residual_cohesion is None


class TestSampling:
    """When and where a run is recorded."""

    @pytest.mark.parametrize(
        ("duration", "interval", "count"),
        [
            (0.3, 0.1, 4),
            (0.7, 0.1, 8),
            (0.35, 0.1, 4),
            (0.29, 0.1, 3),
            (0.1, 0.1, 2),
        ],
    )
    def test_the_last_sample_is_there(self, duration, interval, count):
        """0.3 / 0.1 and 0.7 / 0.1 are below 3 and 7 in the last digit."""
        times = sample_times(
            scene(time={"duration": duration}, record=RECORD | {"interval": interval})
        )
        assert times == pytest.approx(0.1 * np.arange(count), rel=1e-15)

    @pytest.mark.parametrize("interval", [0.1, 1e-3, 5e-5, 3e-4, 1.0 / 3.0])
    def test_whole_multiples_of_the_interval_end_on_a_sample(self, interval):
        for n in range(1, 400):
            asked = scene(time={"duration": n * interval}, record=RECORD | {"interval": interval})
            times = sample_times(asked)
            assert len(times) == n + 1 and times[-1] == exact(n * interval)

    def test_default_interval(self):
        sine = {"shape": "sine", "amplitude": 1.0, "period": 0.02}
        assert scene(load=sine, record=RECORD).interval == 1e-4  # 0.02 / 200
        assert scene(record=RECORD).interval == 5e-6  # 0.01 / 2000
        assert scene(load=sine).interval == 1e-3

    def test_clock(self):
        """Half of 4e-4 s divides 1e-3 s by five; 0.3 ms does not, and a quarter is taken."""
        time = clock(scene(), 4e-4, 0.5, False, "dem")
        assert (time.dt, time.stride, time.samples, time.steps) == (exact(2e-4), 5, 11, 50)
        assert time.times == pytest.approx(1e-3 * np.arange(11), rel=1e-14)
        assert clock(scene(), 6e-4, 0.5, False, "dem")[:2] == (exact(2.5e-4), 4)
        assert clock(scene(), 1.0, 1.0, False, "dem")[:2] == (1e-3, 1)

    @pytest.mark.parametrize("parts", [3, 7, 49, 111])
    def test_a_step_that_fits_but_for_round_off_is_taken(self, parts):
        for critical in (1e-3 / parts, np.nextafter(1e-3 / parts, 0)):
            assert clock(scene(), critical, 1.0, False, "dem").stride == parts

    def test_step_above_the_critical_one(self):
        """1.5 * 4e-4 s lies nearer to a half of 1e-3 s; 1.9 * 4e-4 s to the whole of it."""
        assert clock(scene(), 4e-4, 1.5, True, "dem")[:2] == (5e-4, 2)
        assert clock(scene(), 4e-4, 1.9, True, "dem")[:2] == (1e-3, 1)
        with pytest.raises(SceneError, match=r"record\.interval.*0\.0012 s"):
            clock(scene(), 8e-4, 1.5, True, "dem")

    def test_interpolation(self):
        nodes = np.array([0.0, 1.0, 3.0])
        left, right, weight = interpolation(nodes, [-1.0, 0.25, 1.0, 1.5, 2.0, 3.0, 5.0])
        assert ((1 - weight) * nodes[left] + weight * nodes[right]).tolist() == [
            0.0, 0.25, 1.0, 1.5, 2.0, 3.0, 3.0,
        ]  # fmt: skip
        assert left.tolist() == [0, 0, 0, 1, 1, 1, 1]
        assert weight.tolist() == [0.0, 0.25, 1.0, 0.25, 0.5, 1.0, 1.0]

    def test_one_node_holds_everywhere(self):
        left, right, weight = interpolation(np.array([2.0]), [0.0, 2.0, 3.0])
        assert left.tolist() == right.tolist() == [0, 0, 0] and np.isfinite(weight).all()


class TestLoads:
    """Value, time integral and breaks of every shape."""

    def test_sine(self):
        """3 sin(2 pi t / 0.4), two cycles; half a cycle holds 3 * 0.4 / pi."""
        load = Sine(3.0, 0.4, 2)
        t = np.array([-0.1, 0.0, 0.4 / 12, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9])
        assert load.value(t) == pytest.approx([0, 0, 1.5, 3, -3, 3, -3, 0, 0], abs=1e-14)
        t = np.array([-0.1, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 0.9])
        half = 1.2 / pi
        expected = [0, half / 2, half, half / 2, 0, half, 0, 0]
        assert load.impulse(t) == pytest.approx(expected, abs=1e-15)
        assert load.value(np.array(load.end)) == 0  # to the last bit
        assert load.end == 0.8 and load.breaks == [0.0, 0.8]
        assert Sine(3.0, 0.4).end == 0.4

    def test_ricker(self):
        """Zero where a = 1/2, trough -4 e^-1.5 where a = 3/2; impulse 2 s e^-a from the middle."""
        load = Ricker(2.0, 0.1)
        zero, trough = 0.1 / (pi * sqrt(2)), 0.1 * sqrt(1.5) / pi
        t = 0.15 + np.array([-trough, -zero, 0, zero, trough])
        dip = -4 * exp(-1.5)
        assert load.value(t) == pytest.approx([dip, 0, 2, 0, dip], abs=1e-13)
        before = 0.3 * exp(-((1.5 * pi) ** 2))  # of the part that is cut off before t = 0
        peak = 2 * zero * exp(-0.5)
        expected = np.array([-peak, 0, peak]) + before
        assert load.impulse(0.15 + np.array([-zero, 0, zero])) == pytest.approx(expected, rel=1e-12)
        assert (
            load.impulse(np.array([-1.0, 0.0])).tolist()
            == [0, 0]
            == load.value(np.array([-1.0, 0.0])).tolist()
        )
        assert load.breaks == [0.0]

    def test_step(self):
        load = Step(3.0)
        assert load.value(np.array([-1.0, 0.0, 1e-9, 7.0])).tolist() == [0, 1.5, 3, 3]
        assert load.impulse(np.array([-1.0, 0.0, 2.0])).tolist() == [0, 0, 6]
        assert load.breaks == [0.0]

    def test_recorded(self):
        """0, 6, 2 Pa at 1, 2, 4 s: 3 Pa s in the first piece, 8 in the second, nothing beyond."""
        load = Recorded(np.array([1.0, 2.0, 4.0]), np.array([0.0, 6.0, 2.0]))
        t = np.array([0.9, 1.0, 1.5, 2.0, 3.0, 4.0, 4.1])
        assert load.value(t).tolist() == [0, 0, 3, 6, 4, 2, 0]
        t = np.array([0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0])
        assert load.impulse(t).tolist() == [0, 0, 0.75, 3, 8, 11, 11]
        assert load.breaks == [1.0, 2.0, 4.0]

    def test_step_means(self):
        """Half of a step's first mean lies before it; 0.75, 5.75, 9.75, 11 Pa s at 1.5 s ..."""
        assert step_means(Step(3.0), 0.1, 4) == exact(np.array([1.5, 3, 3, 3]))
        load = Recorded(np.array([1.0, 2.0, 4.0]), np.array([0.0, 6.0, 2.0]))
        assert step_means(load, 1.0, 6) == exact(np.array([0, 0.75, 5.0, 4.0, 1.25, 0]))

    def test_load_of_a_scene(self, tmp_path):
        assert load_history(scene()) == Step(3.0)
        sine = {"shape": "sine", "amplitude": 2.0, "period": 0.1}
        assert load_history(scene(load=sine)) == Sine(2.0, 0.1, 1)
        assert load_history(scene(load=sine | {"cycles": 3})) == Sine(2.0, 0.1, 3)
        assert load_history(scene(load=sine | {"shape": "ricker"})) == Ricker(2.0, 0.1)
        (tmp_path / "a.csv").write_text("# a blast\ntime,load\n0.5,4\n1,6\n")
        history, _ = read_history(tmp_path, "a.csv", "stress")
        assert history.time.tolist() == [0.5, 1.0] and history.stress.tolist() == [4.0, 6.0]

    def test_a_shaken_base(self):
        """v = 3 m/s: 0.3 m a step of 0.1 s. a = 3 m/s2: 3 t at the half steps, times 0.1 s."""
        base = {"ends": {"start": "fixed"}}
        load = {"shape": "step", "amplitude": 3.0, "quantity": "velocity"}
        assert base_steps(scene(load=load, **base).load, 0.1, 3) == exact(np.array([0.3, 0.3, 0.3]))
        load |= {"quantity": "acceleration"}
        steps = base_steps(scene(load=load, **base).load, 0.1, 3)
        assert steps == exact(np.array([0.015, 0.045, 0.075]))


class TestFaces:
    """Contact points and their areas, and linear cells of a face."""

    def test_midpoints(self):
        """The paper's are 2 x 2, (2)."""
        paper = load(SHIPPED / "guo-li-2002" / "fig-03.toml")[0]
        assert (paper.joints.contact_points, paper.joints.point_rule) == (None, "midpoint")
        assert face_points(3.0, None, "midpoint")[2] == exact(np.full(4, 2.25))
        x, z, area = face_points(3.0, 3, "midpoint")
        assert x == pytest.approx([-1, -1, -1, 0, 0, 0, 1, 1, 1], abs=1e-15)
        assert z == pytest.approx([-1, 0, 1] * 3, abs=1e-15)
        assert area == exact(np.ones(9))

    def test_vertices(self):
        """The default: twelfths of the area at the corners, two thirds in the middle."""
        assert (scene().joints.contact_points, scene().joints.point_rule) == (None, "vertices")
        x, z, area = face_points(3.0, None, "vertices")
        assert x == exact(1.5 * np.array([-1, -1, 1, 1, 0]))
        assert z == exact(1.5 * np.array([-1, 1, -1, 1, 0]))
        assert area == exact(np.array([0.75, 0.75, 0.75, 0.75, 6.0]))

    def test_gauss_points(self):
        """Side 2: points sqrt(3/5) of weights 5/9, 8/9, 5/9."""
        x, z, area = face_points(2.0, 3, "gauss")
        at = sqrt(0.6)
        assert x == pytest.approx([-at] * 3 + [0] * 3 + [at] * 3, abs=1e-15)
        assert z == pytest.approx([-at, 0, at] * 3, abs=1e-15)
        assert area == pytest.approx(np.array([25, 40, 25, 40, 64, 40, 25, 40, 25]) / 81, rel=1e-14)

    @pytest.mark.parametrize(("n", "moment"), [(1, 0.0), (2, 1.0), (4, 1.25)])
    def test_bending_stiffness_of_midpoints(self, n, moment):
        """1 - 1/n^2 of 2^4 / 12 m4."""
        x, _, area = face_points(2.0, n, "midpoint")
        assert area @ x**2 == pytest.approx(moment, rel=1e-14, abs=0)

    def test_linear_cells_of_a_face_of_order_two(self):
        """Nodes row by row: 0 1 2 / 3 4 5 / 6 7 8, each cell counterclockwise."""
        nodes = np.array([(x, y) for y in (0, 0.5, 1) for x in (0, 0.5, 1)])
        cells = sorted(linear_cells("quadrilateral", nodes).tolist())
        assert cells == [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]

    def test_a_hexahedron_is_as_vtk_counts_it(self):
        """Around the lower face, then around the upper: (x, y, z) of eight nodes in turn."""
        nodes = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
        assert linear_cells("hexahedron", nodes).tolist() == [[0, 4, 6, 2, 1, 5, 7, 3]]
        assert linear_cells("interval", np.array([[1.0], [0.0], [0.5]])).tolist() == [
            [1, 2],
            [2, 0],
        ]
