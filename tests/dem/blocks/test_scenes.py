"""Runs of rock-mass scenes: against the chain, against waves, and what no scene may change."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.incident import free_field
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.dem import simulate
from jointwave.dem.run import plan
from jointwave.results.dataset import energy_residual

SINE = {"shape": "sine", "amplitude": 1e6, "period": 0.002}
PRESSURE = SINE | {"kind": "pressure", "side": "bottom"}


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
        soft_layers=changes.pop("layers", []),
        load=changes.pop("load", SINE | {"direction": [0, 1, 0]}),
        ends={"start": "free", "end": changes.pop("end")},
        time=changes.pop("time", {"duration": 0.01}),
        record={"stress": [5.0], "velocity": [2.25, 7.75], "interval": 4e-5},
        **{"numerics.dem.step_fraction": changes.pop("fraction")},
        **changes,
    )


DAMPED = {"damping_ratio": 0.02}
FAILS = {"tensile_strength": 2e5, "fracture_energy": 1.0}


@pytest.mark.parametrize(("end", "joint"), [("quiet", {}), ("fixed", DAMPED), ("fixed", FAILS)])
def test_a_column_is_the_chain(end, joint, rock_mass, pillar):
    """Joints of 1e11 Pa/m in rock of 5e10 Pa, 0.5 m apart: K' = 5e10 Pa/m, E_eq = 2.5e10 Pa. At
    the wall of a fixed side is half a block of rock, without a joint. Both take five steps between
    samples, to the round-off of 1250. Half of the compliance is the joint's own: its
    2 zeta sqrt(m K) is 2 zeta sqrt(m K') (K'/K)^1.5 of the contact; rock at the wall has none. The
    pulse of 1 MPa spends a strength of 0.2 MPa."""

    def run(scene):
        critical = plan(scene(0.2)).critical
        return simulate(scene(8e-6 / critical * 1.0001))

    found = run(lambda x: column(rock_mass, top=end, joint=joint, fraction=x))
    whole = {"joint": joint}
    if joint is DAMPED:
        each = np.arange(0.5, 10.0, 0.5).tolist()
        whole = {"layers": [{"y": y, "damping_ratio": 0.02 * 0.5**1.5} for y in each]}
    expected = run(lambda x: chain(pillar, end=end, fraction=x, **whole))
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
    energy = found.energy.isel(time=-1)
    assert (energy.sel(term="viscous") > 0.01 * energy.sel(term="work")) == (joint is DAMPED)
    assert joint is not FAILS or energy.sel(term="fracture") > 0.5  # J/m2, a joint has 1.0


SLIPS = {"friction_angle": 5.0, "cohesion": 1e4}


@pytest.mark.parametrize("law", [{}, SLIPS], ids=["elastic", "slip"])
def test_a_row_is_the_row_in_space(law, rock_mass, pillar, plain):
    """Blocks under an oblique blow beside their axis, which compresses, bends and shears them: per
    metre of thickness they are the row of square section over its side, to round-off."""
    blow = SINE | {"kind": "force", "quantity": "force", "at": [0.35, 0.0], "amplitude": 5e5}
    plane = {"loads": [blow | {"direction": [0.6, 0.8]}], "time": {"duration": 2e-3}}
    critical = plan(column(rock_mass, top="free", joint=law, **plane)).critical
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


@pytest.mark.parametrize("exact", [False, True], ids=["free field", "exact field"])
def test_the_ledger_of_waves_and_quiet_sides_closes(exact, rock_mass, wave):
    """What waves put in is stored or leaves through the sides, to round-off."""
    own = rock_mass(waves=[wave(direction=[0.6, 0.8]), wave(kind="S", direction=[0.0, -1.0])])
    result = simulate(own, incident=field_of(own) if exact else free_field(own))
    assert energy_residual(result) < 1e-12
    assert result.energy.sel(term="boundary")[-1] > 0.1 * np.abs(result.energy).max()


PRESSED = {"xx": 2e6, "yy": 5e6, "xy": -1e6}


@pytest.mark.parametrize(
    ("side", "law"),
    [("quiet", {}), ("fixed", {}), ("free", {}), ("free", {"maximum_closure": 1e-4})],
)
def test_a_prestressed_rock_mass_stays_still(side, law, rock_mass, joint, request):
    """The traction of the tensor on all contacts and sides is in equilibrium at once, to the
    round-off of 5 MPa times a block's side, on joints that it has closed as well."""
    strong = joint(friction_angle=60.0, tension=False, **law)
    held = dict.fromkeys(("left", "right", "bottom"), side) | {"top": "quiet"}
    tables = {"joint_sets": [strong], "boundaries": held, "prestress": PRESSED}
    if law:
        request.getfixturevalue("plain")
        tables["time"] = {"duration": 1e-3}
    result = simulate(rock_mass(**tables))
    assert result.static_steps == 0
    assert np.abs(result.velocity).max() < 1e-12  # m/s; 5 MPa make 0.4 m/s of a P wave
    n = np.array([-0.5, np.sqrt(3) / 2])
    tensor = np.array([[2e6, -1e6], [-1e6, 5e6]])
    aim = [n @ tensor @ n, np.array([-n[1], n[0]]) @ tensor @ n]
    assert result.traction.values[0] == pytest.approx(np.tile(aim, (len(result.time), 1)), rel=1e-9)
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


def test_the_ledger_of_a_shaken_base_closes(rock_mass):
    """With the work of the base, which takes blocks along slowly, and what a quiet top takes."""
    base = {"kind": "base", "side": "bottom", "direction": [0.8, 0.6], "shape": "sine"}
    base |= {"quantity": "velocity", "amplitude": 0.1, "period": 0.2, "cycles": 1}
    own = rock_mass(
        domain={"size": [3.0, 4.0]},
        joint_sets=None,
        boundaries={"left": "free", "right": "free", "bottom": "fixed", "top": "quiet"},
        loads=[base],
        record={"points": [[1.5, 3.5]], "joints": None, "interval": 1e-3},
        time={"duration": 0.1},
    )
    result = simulate(own)
    assert energy_residual(result) < 1e-12
    moved = 0.1 * 0.2 / np.pi * np.array([0.8, 0.6])  # half a cycle
    assert result.displacement.values[0, -1] == pytest.approx(moved, rel=0.02)


@pytest.mark.parametrize("right", ["free", "fixed"])
def test_rock_that_stays_one_block_is_refused_unless_a_wall_holds_it(right, rock_mass):
    """Before a fixed side it rests on confined rock from there to its centroid, 60 GPa / 6 m."""
    push = {"kind": "pressure", "side": "left", "shape": "half-sine", "amplitude": 1e6}
    scene = rock_mass(
        joint_sets=[],
        loads=[push | {"period": 1.0}],
        boundaries={"left": "free", "right": right, "bottom": "free", "top": "free"},
        record={"points": [[6.0, 5.0]], "joints": None},
        numerics={"dem": {"block": 50.0}},
        time={"duration": 0.25},
    )
    if right == "free":
        with pytest.raises(SceneError, match=r"block = 50.*: leaves one block without a joint"):
            simulate(scene)
    else:
        moved = simulate(scene).displacement.sel(axis="x").values[0, -1]
        assert moved == pytest.approx(1e6 * 6 / 6e10, rel=0.02)


def test_joints_and_snapshots_are_recorded_without_points(rock_mass):
    loads, fields = [PRESSURE | {"side": "left"}], {"fields": 1e-3}
    one, other = (
        simulate(rock_mass(loads=loads, record=keys | fields)) for keys in ({}, {"points": None})
    )
    assert "velocity" in one and "velocity" not in other and np.abs(one.gap).max() > 0
    for key in ("gap", "slip", "traction", "field_velocity", "field_stress"):
        assert other[key].equals(one[key]), key


def test_a_rigid_motion_meets_no_resistance(rock_mass, joint, plain):
    """Free sides, gravity from t = 0 on: all blocks fall, and joints carry nothing."""
    own = rock_mass(
        domain={"size": [4.0, 3.0]},
        boundaries=dict.fromkeys(("left", "right", "bottom", "top"), "free"),
        joint_sets=[joint(friction_angle=20.0, through=[2.0, 1.5])],
        record={"points": [[1.3, 0.6]], "joints": [[2.0, 1.5]]},
        time={"duration": 4e-3},
        gravity={"direction": [0.6, -0.8], "acceleration": 10.0, "static": False},
    )
    result = simulate(own)
    fall = 10.0 * result.time.values[:, None] * np.array([0.6, -0.8])
    assert np.abs(result.velocity.values - fall).max() < 1e-13
    # The last digit of a fall of 0.5 mm is 1e-19 m, of which 1e10 Pa/m makes 1e-9 Pa.
    assert np.abs(result.traction).max() < 1e-6
