"""Runs of rock-mass scenes: against the chain, against waves, and what no scene may change."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError, StoppedError
from jointwave.cases.incident import free_field
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.dem import simulate

SINE = {"shape": "sine", "amplitude": 1e6, "period": 0.002}
PRESSURE = SINE | {"kind": "pressure", "side": "bottom"}
PERIODIC = {"left": "periodic", "right": "periodic"}


def total(result):
    """Return the sum of the ledger without what was put in, and the largest term."""
    energy = result.energy
    stored = energy.drop_sel(term="work").sum("term") - energy.sel(term="work")
    return np.abs(stored - stored[0]).values.max(), np.abs(energy).values.max()


def column(rock_mass, **changes):
    """Return 20 square blocks on each other, pressed from below, the joints 1e11 Pa/m."""
    bedding = {"name": "bedding", "dip": 0.0, "spacing": 0.5}
    law = {"normal_stiffness": 1e11, "shear_stiffness": 4e10}
    return rock_mass(
        domain={"size": [0.5, 10.0]},
        rock={"intact_poisson": 0.0},
        joint_sets=[bedding | law | changes.pop("joint", {})],
        boundaries={"left": "free", "right": "free", "bottom": "free", "top": changes.pop("top")},
        loads=changes.pop("loads", [PRESSURE]),
        numerics={"dem": {"step_fraction": changes.pop("fraction", 0.2)}},
        time=changes.pop("time", {"duration": 0.01}),
        record={"points": [[0.25, 2.25], [0.25, 7.75]], "joints": [[0.25, 5.0]], "interval": 4e-5},
        **changes,
    )


def chain(pillar, **changes):
    """Return the same as a pillar."""
    return pillar(
        pillar={"length": 10.0, "side": 0.5, "block": 0.5},
        rock={"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.0},
        joints={"normal_stiffness": 1e11, "shear_stiffness": 4e10} | changes.pop("joint", {}),
        soft_layers=[],
        load=changes.pop("load", SINE | {"direction": [0, 1, 0]}),
        ends={"start": "free", "end": changes.pop("end")},
        time=changes.pop("time", {"duration": 0.01}),
        record={"stress": [5.0], "velocity": [2.25, 7.75], "interval": 4e-5},
        **{"numerics.dem.step_fraction": changes.pop("fraction")},
        **changes,
    )


FAILS = {"tensile_strength": 2e5, "fracture_energy": 1.0, "damping_ratio": 0.02}


@pytest.mark.parametrize(
    ("end", "joint"),
    [
        ("free", {}),
        ("quiet", {}),
        ("fixed", {}),
        ("free", FAILS),
        ("quiet", FAILS),
    ],
)
def test_a_column_is_the_chain(end, joint, rock_mass, pillar):
    """Joints of 1e11 Pa/m in rock of 5e10 Pa, 0.5 m apart: K' = 5e10 Pa/m, E_eq = 2.5e10 Pa. At
    the wall of a fixed side is half a block of rock, without a joint. Both take five steps between
    samples, to the round-off of 1250. Half of the compliance is the joint's own: its
    2 zeta sqrt(m K) is 2 zeta sqrt(m K') (K'/K)^1.5 of the contact. The pulse of 1 MPa spends a
    strength of 0.2 MPa."""

    def run(scene):
        critical = simulate(scene(0.2)).critical_dt
        return simulate(scene(8e-6 / critical * 1.0001))

    found = run(lambda x: column(rock_mass, top=end, joint=joint, fraction=x))
    whole = {k: v * 0.5**1.5 if k == "damping_ratio" else v for k, v in joint.items()}
    expected = run(lambda x: chain(pillar, end=end, joint=whole, fraction=x))
    assert found.dt == pytest.approx(8e-6, rel=1e-12)
    assert expected.dt == pytest.approx(8e-6, rel=1e-12)
    for name, values in (
        ("velocity", found.velocity[:, :, 1].values),
        ("displacement", found.displacement[:, :, 1].values),
        ("stress", found.traction[:, :, 0].values),
    ):
        aim = expected[name].values
        aim = aim[..., 0] if aim.ndim == 3 else aim
        assert np.abs(values - aim).max() < 1e-12 * np.abs(aim).max(), name
    assert np.abs(found.velocity[:, :, 0]).max() == 0
    if joint is FAILS:
        energy = found.energy.isel(time=-1)
        assert energy.sel(term="viscous") > 0.01 * energy.sel(term="work")
        assert energy.sel(term="fracture") > 0.5  # J/m2, of which the joint has 1.0


SLIPS = {"friction_angle": 5.0, "cohesion": 1e4}


@pytest.mark.parametrize("law", [{}, SLIPS], ids=["elastic", "slip"])
def test_a_row_is_the_row_in_space(law, rock_mass, pillar, plain):
    """Blocks under an oblique blow beside their axis, which compresses, bends and shears them: per
    metre of thickness they are the row of square section over its side, to the round-off of 250
    steps."""
    blow = SINE | {"kind": "force", "quantity": "force", "at": [0.35, 0.0], "amplitude": 5e5}
    plane = {"loads": [blow | {"direction": [0.6, 0.8]}], "time": {"duration": 2e-3}}
    critical = simulate(column(rock_mass, top="free", joint=law, **plane)).critical_dt
    fraction = 8e-6 / critical * 1.0001
    found = simulate(column(rock_mass, top="free", joint=law, fraction=fraction, **plane))
    row = {"load": SINE | {"direction": [0.6, 0.8, 0.0], "at": [0.1, 0.0]}}
    row |= {"time": {"duration": 2e-3}, "joint": law, "end": "free"}
    expected = simulate(chain(pillar, fraction=fraction, **row))
    assert expected.dt == pytest.approx(found.dt, rel=1e-12)
    for name in ("velocity", "displacement"):
        aim, own = expected[name].values[:, :, :2], found[name].values
        assert np.abs(own - aim).max() < 1e-12 * np.abs(aim).max(), name
    if "cohesion" in law:
        energy = found.energy.isel(time=-1)
        assert energy.sel(term="friction") > 0.01 * energy.sel(term="work")


def turned(scene, angle, shift):
    """Return tables of a scene that is turned by an angle, degrees, and shifted, as an outline."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s], [s, c]])

    def place(points):
        return (np.atleast_2d(points) @ turn.T + shift).tolist()

    (joint,), (wave,) = scene.joint_sets, scene.waves
    along = turn @ wave.direction
    return turn, {
        "domain": {"size": None, "outline": place(scene.domain.corners)},
        "joint_sets": [
            joint.model_dump(exclude_none=True)
            | {"dip": joint.dip + angle, "through": place(joint.through)[0]}
        ],
        "waves": [wave.model_dump(exclude_none=True) | {"direction": along.tolist()}],
        "boundaries": None,
        "record": {"points": place(scene.record.points), "joints": place(scene.record.joints)},
    }


def test_a_scene_that_is_turned_and_shifted_records_the_same(rock_mass, wave, joint):
    """To 1e-12: the round-off of coordinates near 100 m over blocks of 1 m, and of some 300 steps.
    Joints that slip, so that the whole law turns; all sides quiet, which an outline's sides are."""
    slips = joint(friction_angle=20.0, cohesion=1e4, damping_ratio=0.02)
    own = rock_mass(joint_sets=[slips], waves=[wave(direction=[0.6, 0.8])])
    turn, tables = turned(own, 25.0, [70.0, -30.0])
    tables["boundaries"] = dict.fromkeys(("left", "right", "bottom", "top"), None) | {
        "outline": "quiet"
    }
    one, other = simulate(own), simulate(rock_mass(**tables))
    assert np.abs(one.slip).max() > 1e-6
    for name in ("velocity", "displacement"):
        values = other[name].values @ turn
        assert np.abs(values - one[name].values).max() < 1e-12 * np.abs(one[name].values).max()
    for name in ("traction", "gap", "slip"):
        off = np.abs(other[name].values - one[name].values).max()
        assert off < 1e-12 * np.abs(one[name].values).max()


@pytest.mark.parametrize("exact", [False, True], ids=["free field", "exact field"])
def test_the_ledger_of_waves_and_quiet_sides_closes(exact, rock_mass, wave):
    """What waves put in is stored or leaves through the sides, to round-off."""
    own = rock_mass(waves=[wave(direction=[0.6, 0.8]), wave(kind="S", direction=[0.0, -1.0])])
    result = simulate(own, incident=field_of(own) if exact else free_field(own))
    off, largest = total(result)
    assert off < 1e-12 * largest
    assert result.energy.sel(term="boundary")[-1] > 0.1 * largest


@pytest.mark.parametrize("kind", ["P", "S"])
def test_waves_across_a_lattice_are_those_of_the_rock(kind, rock_mass, wave):
    """Rock with nu = 0.25 in periodic squares, the wave along a direction of them, against the free
    field: speed and impedance of the lattice are the rock's, so that halving the blocks leaves a
    quarter of the error, and what quiet sides reflect falls alike."""
    axis, errors = "PS".index(kind), []
    for block in (0.5, 0.25):
        own = rock_mass(
            domain={"size": [block, 20.0]},
            joint_sets=None,
            boundaries=PERIODIC,
            waves=[wave(kind=kind)],
            record={"points": [[block / 2, 5.1], [block / 2, 16.3]], "joints": None},
            numerics={"dem": {"block": block, "step_fraction": 0.5}},
            time={"duration": 0.03},
        )
        found, places = simulate(own), np.array(own.record.points)
        exact = free_field(own)(places, found.time.values).velocity[:, 1 - axis]
        off = found.velocity[:, :, 1 - axis].values - exact
        errors.append(np.abs(off).max() / np.abs(exact).max())
    assert errors[0] < 0.05
    assert 3 < errors[0] / errors[1] < 5.5


PRESSED = {"xx": 2e6, "yy": 5e6, "xy": -1e6}


@pytest.mark.parametrize("side", ["quiet", "fixed", "free"])
def test_a_prestressed_rock_mass_stays_still(side, rock_mass, joint):
    """The traction of the tensor on all contacts and sides is in equilibrium at once, to the
    round-off of 5 MPa times a block's side."""
    strong = joint(friction_angle=60.0, tension=False)
    held = dict.fromkeys(("left", "right", "bottom", "top"), side)
    result = simulate(rock_mass(joint_sets=[strong], boundaries=held, prestress=PRESSED))
    assert result.static_steps == 0
    assert np.abs(result.velocity).max() < 1e-12  # m/s; 5 MPa make 0.4 m/s of a P wave
    n = np.array([-0.5, np.sqrt(3) / 2])
    tensor = np.array([[2e6, -1e6], [-1e6, 5e6]])
    aim = [n @ tensor @ n, np.array([-n[1], n[0]]) @ tensor @ n]
    assert result.traction.values[0] == pytest.approx(np.tile(aim, (101, 1)), rel=1e-9)
    for name, value in zip(("xx", "yy", "xy"), PRESSED.values(), strict=True):
        found = result.stress.sel(stress_component=name)
        assert np.abs(found - value).max() < 1e-9 * 5e6
    assert np.abs(result.gap).max() < 1e-15 and np.abs(result.slip).max() < 1e-15


@pytest.mark.parametrize(
    ("law", "what"),
    [({"tension": False}, "opens"), ({"friction_angle": 20.0, "cohesion": 1e5}, "slides")],
)
def test_a_prestress_that_joints_cannot_carry_is_refused_in_one_line(law, what, rock_mass, joint):
    pressed = {"xx": -1e6, "yy": -1e6} if what == "opens" else {"xx": 1e6, "yy": 4e6}
    weak = rock_mass(joint_sets=[joint(**law)], prestress=pressed)
    with pytest.raises(SceneError, match=f"prestress: exceeds.*'joint' {what} under it") as caught:
        simulate(weak)
    assert "\n" not in str(caught.value)


def test_gravity_at_rest_is_the_weight_above(rock_mass):
    """A column of rock, nu = 0: sigma_yy = rho g (h - y) in the middle of each block."""
    own = rock_mass(
        domain={"size": [2.0, 6.0]},
        rock={"intact_poisson": 0.0},
        joint_sets=None,
        boundaries={"left": "free", "right": "free", "bottom": "fixed", "top": "free"},
        gravity={"direction": [0.0, -1.0]},
        record={"points": [[0.5, 0.5], [1.5, 3.5]], "joints": None},
    )
    result = simulate(own)
    weight = 2600 * 9.81 * (6 - np.array([0.5, 3.5]))
    assert result.stress.values[:, :, 1] == pytest.approx(np.tile(weight[:, None], 101), rel=1e-6)
    assert np.abs(result.velocity).max() < 1e-7 * 9.81 * 0.01
    assert result.starts == "at rest under gravity"


def test_a_shaken_base_moves_all_like_a_force_of_inertia(rock_mass):
    """Slowly shaken, blocks on a base follow it; the ledger closes with the work of the base."""
    own = rock_mass(
        domain={"size": [3.0, 4.0]},
        joint_sets=None,
        boundaries={"left": "free", "right": "free", "bottom": "fixed", "top": "free"},
        loads=[
            {
                "kind": "base", "side": "bottom", "direction": [0.8, 0.6], "shape": "sine",
                "quantity": "velocity", "amplitude": 0.1, "period": 0.2, "cycles": 1,
            }
        ],
        record={"points": [[1.5, 3.5]], "joints": None, "interval": 1e-3},
        time={"duration": 0.1},
    )  # fmt: skip
    result = simulate(own)
    off, largest = total(result)
    assert off < 1e-12 * largest
    along = np.array([0.8, 0.6])
    base = 0.1 * np.sin(2 * np.pi * result.time.values / 0.2)[:, None] * along
    # The top lags by up to a h / b of the acceleration a that the base begins with, then swings.
    lag = 0.1 * 2 * np.pi / 0.2 * 4.0 / 2774
    assert np.abs(result.velocity.values[0] - base).max() < 2 * lag < 0.1 * 0.1
    moved = 0.1 * 0.2 / np.pi * along  # half a cycle
    assert result.displacement.values[0, -1] == pytest.approx(moved, rel=0.02)


def test_a_rigid_motion_meets_no_resistance(rock_mass, joint):
    """Free sides, gravity from t = 0 on: all blocks fall, and joints carry nothing."""
    own = rock_mass(
        boundaries=dict.fromkeys(("left", "right", "bottom", "top"), "free"),
        joint_sets=[joint(friction_angle=20.0)],
        gravity={"direction": [0.6, -0.8], "acceleration": 10.0, "static": False},
    )
    result = simulate(own)
    fall = 10.0 * result.time.values[:, None] * np.array([0.6, -0.8])
    assert np.abs(result.velocity.values - fall).max() < 1e-13
    # The last digit of a fall of 0.5 mm is 1e-19 m, of which 1e10 Pa/m makes 1e-9 Pa.
    assert np.abs(result.traction).max() < 1e-6


def test_an_unstable_run_is_stopped_with_what_is_sound(rock_mass, wave):
    """Three times the critical step: the monitor ends the run in one line."""
    own = rock_mass(
        waves=[wave()],
        numerics={"dem": {"block": 1.0, "step_fraction": 3.0, "allow_unstable": True}},
        time={"duration": 0.2},
        record={"interval": 1e-3},
    )
    with pytest.raises(StoppedError, match=r"fastest at \[") as caught:
        simulate(own)
    assert "\n" not in str(caught.value)
