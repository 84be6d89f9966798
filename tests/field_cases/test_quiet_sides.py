"""Quiet sides beside joints that are not linear, beside a free top and beside layers.

A joint whose strength is never reached, and a wave that is hardly turned (Miller 1978, 3DEC's
verification, at any angle): all sides receive one field, so that neither changes anything."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jointwave as jw
from closed_forms.slipping_joint import slipping_joint
from jointwave.cases.errors import SceneError
from jointwave.compare.exact.rock_mass.side_error import side_error
from jointwave.compare.scenes import shipped_files
from jointwave.compare.solvers.incident import incident, side_warnings
from tests.field_cases.scenes import ENGINES, JOINT, P_SPEED, S_SPEED, SIDES, mass, wave

NEVER = {"friction_angle": 30.0, "cohesion": 1e9, "tension": False}
HELD = {"xx": 5e7, "yy": 5e7}  # Pa: no joint opens either
STIFF = {"normal_stiffness": 1e15, "shear_stiffness": 1e15}  # Pa/m


def rock(joints=(), kind="S", direction=(0.0, 1.0), **tables):
    """Return the tables of a wave in 8 m by 16 m between quiet sides, joints through the middle."""
    own = {
        "joint_sets": [JOINT | {"dip": 0.0, "through": [4.0, 8.0]} | one for one in joints],
        "waves": [wave(kind, direction)],
        "time": {"duration": 0.016},
        "numerics": {"dem": {"block": 2.0}, "continuum": {"size": 2.0}},
        "record": {"points": [[4.3, 12.4], [1.1, 5.2]]},
    }
    return mass(8.0, 16.0, **own | tables)


def scene(*joints, **tables):
    return jw.load(rock(*joints, **tables))


def apart(one, other):
    """Return the largest difference of two waveforms over the largest value."""
    return np.abs(np.asarray(one) - np.asarray(other)).max() / np.abs(np.asarray(other)).max()


@pytest.mark.parametrize("engine", ENGINES)
def test_neither_a_turn_of_1e_8_nor_an_unreached_strength_changes_anything(engine):
    """One field for all scenes; a side that takes a wave along it to 1e-9 for one in intact rock
    receives 1.0 of it, or 0.5 when turned."""
    found = jw.simulate(scene([{}]), engine)
    linear = found.velocity.values
    for x, within in ((0.0, 1e-9), (1e-8, 1e-6), (-1e-8, 1e-6)):
        turned = jw.simulate(scene([NEVER], prestress=HELD, direction=(x, 1.0)), engine)
        assert apart(turned.velocity.values, linear) < within
    exact = incident(scene([{}]))(np.array([[4.3, 12.4]]), found.time.values).velocity[0].T
    assert apart(linear[0], exact) < 0.05  # of elements and blocks of 2 m, 7 a wavelength


@settings(max_examples=12)
@given(
    dip=st.floats(-80, 80),
    off=st.floats(5, 60),
    kind=st.sampled_from("PS"),
    turn=st.sampled_from([-1e-8, 1e-8]),
    angle=st.floats(5, 85),
    fails=st.booleans(),
)
def test_the_field_is_continuous(dip, off, kind, turn, angle, fails):
    """A law that is linear at first changes no bit. A turn of the wave or of one of two joints by
    1e-8, and corners of a turned domain that are rounded in the sixth decimal, move arrivals by
    some 1e-7 m, 1e-8 of a wavelength."""
    a = np.radians(off) * np.sign(dip or 1.0)
    up = np.array([-np.sin(np.radians(dip) + a), np.cos(np.radians(dip) + a)])
    joints = [{"dip": dip}, {"name": "other", "dip": dip, "through": [4.0, 9.0]}]
    places = np.array([[0, 3], [8, 11], [3, 0], [5, 15.9], [8, 2], [0.1, 14]])
    times = np.linspace(0, 0.016, 161)
    before = incident(scene(joints, kind, up))(places, times)
    failing = incident(scene([one | NEVER for one in joints], kind, up))(places, times)
    assert np.array_equal(failing.velocity, before.velocity)
    turned = incident(scene(joints, kind, up + turn * np.array([-up[1], up[0]])))(places, times)
    hardly = [joints[0], joints[1] | {"dip": dip + np.degrees(turn)}]
    for found in (turned, incident(scene(hardly, kind, up))(places, times)):
        assert apart(found.velocity, before.velocity) < 1e-6
        assert apart(found.stress, before.stress) < 1e-6
    r = np.radians(angle)
    R = np.array([[np.cos(r), -np.sin(r)], [np.sin(r), np.cos(r)]])
    one, other = (
        incident(turned_domain(R, digits, kind, fails))(places @ R.T, times).velocity
        for digits in (15, 6)
    )
    assert apart(one, other) < 1e-6


def turned_domain(R, digits, kind, fails):
    """Return a joint across a turned domain, which has sides of one condition only: "outline"."""
    outline = np.array([[0, 0], [8, 0], [8, 16], [0, 16]]) @ R.T
    dip = np.degrees(np.arctan2(R[1, 0], R[0, 0]))
    middle = (R @ [4.0, 8.0]).tolist()
    return scene(
        [{"dip": float(dip), "through": middle} | (NEVER if fails else {})],
        domain={"outline": outline.round(digits).tolist()},
        boundaries={"outline": "quiet"},
        waves=[wave(kind, (R @ [0.0, 1.0]).tolist())],
        record={"points": [middle]},
    )


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", ["P", "S"])
def test_a_free_top_sends_an_oblique_wave_back(engine, kind):
    """20 degrees in rock without joints: coefficients of a free face of Aki & Richards (2002),
    equations (5.27) to (5.31); the top moves by the sum of three waves, without traction."""
    a, b = P_SPEED, S_SPEED
    p = np.sin(np.radians(20)) / (a if kind == "P" else b)
    xi, eta = np.sqrt(1 / a**2 - p**2), np.sqrt(1 / b**2 - p**2)
    double, both = 1 / b**2 - 2 * p**2, 4 * p**2 * xi * eta
    i, j = np.array([a * p, a * xi]), np.array([b * p, b * eta])  # sines and cosines
    if kind == "P":
        PP = (both - double**2) / (both + double**2)
        PS = 4 * (a / b) * p * xi * double / (both + double**2)
        along, up = i[0] * (1 + PP) + j[1] * PS, i[1] * (1 - PP) + j[0] * PS
    else:
        SS = (double**2 - both) / (double**2 + both)
        SP = 4 * (b / a) * p * eta * double / (double**2 + both)
        along, up = j[1] * (1 + SS) + i[0] * SP, j[0] * (-1 + SS) - i[1] * SP
    n = [np.sin(np.radians(20)), np.cos(np.radians(20))]
    open_top = scene(
        kind=kind,
        direction=n,
        boundaries=dict.fromkeys(SIDES[:3], "quiet") | {"top": "free"},
        numerics={"dem": {"block": 0.8}, "continuum": {"size": 2.0}},
        record={"points": [[4.0, 16.0]]},
        time={"duration": 0.02},
    )
    found = jw.simulate(open_top, engine)
    moved = found.velocity.values[0]
    pulled = np.abs(found.stress.sel(stress_component=["yy", "xy"])).max()
    assert pulled < 0.06e6
    size = 1e6 / (2600 * (a if kind == "P" else b))
    peak = moved[np.abs(moved).max(axis=1).argmax()] / size
    sign = 1 if kind == "P" else -1  # particles of S move to the left of its direction
    aim = sign * np.array([along, up])
    assert np.abs(peak - aim).max() < (0.05 if engine == "dem" else 0.01) * np.abs(aim).max()
    assert jw.solvers(open_top)["parallel-joints"] == ""


def test_homogenised_rock_has_the_waves_of_its_medium_at_a_free_top():
    """Crossing sets: P and S waves that the top sends back leave through all quiet sides."""
    crossing = scene(
        [{"name": str(dip), "dip": dip, "spacing": 2.0} for dip in (25.0, -50.0)],
        direction=(0.28, 0.96),
        boundaries=dict.fromkeys(SIDES[:3], "quiet") | {"top": "free"},
        numerics={"continuum": {"size": 1.0}},
    )
    found, exact = (
        jw.simulate(crossing, name).velocity.values
        for name in ("continuum-equivalent", "effective-medium")
    )
    assert apart(found, exact) < 0.02


def test_p_waves_that_decay_from_a_free_top_of_crossing_sets_are_said():
    """An S wave at joints as stiff as rock makes the P wave of a free face in intact rock, which
    decays beyond 35.3 degrees, but none at 45: its velocity at the face, within a third, since the
    field's own S wave is off with it."""
    k, sets = S_SPEED / P_SPEED, [{"dip": dip, "spacing": 2.0} | STIFF for dip in (25.0, -65.0)]
    sides = dict.fromkeys(SIDES[:3], "quiet") | {"top": "free"}
    named = [one | {"name": f"dip {one['dip']}"} for one in sets]
    for angle in (30.0, 40.0, 45.0, 60.0):
        s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        found = side_error(scene(named, direction=(s, c), boundaries=sides))
        xi, double = np.sqrt(k**2 - s**2 + 0j), 1 - 2 * s**2
        wave_of_p = abs(4 * s * c * double / (double**2 + 4 * s**2 * xi * c)) * np.hypot(s, abs(xi))
        if angle in (30.0, 45.0):
            assert found is None
        else:
            assert "decays from the free side" in found.words
            assert found.part == pytest.approx(wave_of_p, rel=1 / 3)


SLIPS = {"dip": 30.0, "friction_angle": 0.0, "cohesion": 1e5}


def said(*joints, **tables):
    """Return what is said of the sides in one line, "" for nothing."""
    lines = side_warnings(scene(*joints, **tables))
    assert len(lines) <= 1
    return "".join(lines)


def test_one_warning_names_what_slips_and_how_far_to_stay(jointwave, tmp_path, in_toml):
    line = said([SLIPS], kind="P")
    assert "joint set 'joint' slips" in line and "24 m (a wavelength of P)" in line
    slipping = side_error(scene([SLIPS | {"cohesion": 3e5}]))
    assert 0.05 < slipping.part < side_error(scene([SLIPS])).part < 1
    assert slipping.near == {"points": [(4.3, 12.4), (1.1, 5.2)]}
    (file := tmp_path / "slips.toml").write_text(in_toml(rock([SLIPS], "P")))
    warned = jointwave("compare", file, "--all").err
    assert warned.count("boundaries: joint set 'joint' slips") == 1
    assert jw.simulate(jw.load(file), "dem").attrs["warnings"].count("leave out") == 1
    assert jointwave("explain", file, "--strict", code=2).err.count("leave out") == 1


LEVEL = SLIPS | {"dip": 0.0}
SEAM = JOINT | {"name": "seam", "dip": 90.0, "spacing": 4.0, "through": [0.0, 0.0]}
ABOVE = LEVEL | {"name": "above", "through": [4.0, 10.0]}
PERIODIC = dict.fromkeys(SIDES[:2], "periodic") | dict.fromkeys(SIDES[2:], "quiet")
WIDE = {"domain": {"size": [600.0, 16.0]}, "record": {"points": [[300.0, 12.0]]}}
#: Straight on between periodic sides dashpots absorb all, and what one joint that slips sends back
#: is known; what starts at a side 300 m away comes after the end.
OF_SIDES = {
    "strength unreached": ([NEVER], {"prestress": HELD}, ""),
    "periodic": ([LEVEL, SEAM], {"boundaries": PERIODIC}, ""),
    "one that slips": ([LEVEL], {}, ""),
    "two that slip": ([LEVEL, ABOVE], {}, "slip"),
    "far sides": ([LEVEL, ABOVE], WIDE, ""),
    "free": ([{}], {"boundaries": dict.fromkeys(SIDES[1:], "quiet")}, "the left is free"),
    "damped": ([{}], {"damping": {"mass_proportional": 100.0}}, "damped"),
    "crossing": ([{"dip": 30.0}, {"name": "other", "dip": -40.0}], {}, "not parallel"),
    "along": ([{"dip": 90.0}], {}, "lies along a wave"),
    "closing": ([{"dip": 30.0, "maximum_closure": 1e-4}], {}, "stiffens"),
    "hardly closing": ([{"dip": 30.0, "maximum_closure": 1.0}], {}, ""),
}


@pytest.mark.parametrize(("joints", "tables", "words"), OF_SIDES.values(), ids=OF_SIDES)
def test_what_the_field_leaves_out_is_said(joints, tables, words):
    line = said(joints, **tables)
    assert words in line if words else line == ""


def test_a_load_beside_quiet_sides_is_said_within_half_a_wavelength_and_before_the_end():
    """Of P, 12 m; what meets a whole side straight on is absorbed. Back from the side the wave
    comes from the image of the load, 62 m from the point, and is felt from 0.646 T on."""
    force = {"kind": "force", "quantity": "force", "at": [50.0, 50.0], "direction": [0.6, 0.8]}
    force |= {"shape": "ricker", "amplitude": 1e6, "period": 0.005}
    base = force | {"kind": "base", "side": "left", "quantity": "velocity", "direction": [1.0, 0.0]}
    del base["at"]
    wide = {"domain": {"size": [100.0, 100.0]}, "waves": []}
    back = np.hypot(61.9, 0.5) / P_SPEED + 0.6456 * 0.005
    for load, away, end, count in (
        (force, 11.9, 1.01 * back, 1), (force, 12.1, 0.1, 0), (force, 11.9, 0.99 * back, 0),
        (force | {"amplitude": 0.0}, 11.9, 0.1, 0), (base, 11.9, 0.1, 0),
    ):  # fmt: skip
        own = {"loads": [load], "time": {"duration": end}, "record": {"points": [[away, 50.5]]}}
        assert said(**wide, **own).count("loads[0]: [11.9, 50.5] of [record]") == count


def in_space(tables, east, kind):
    """Return a scene of the plane as one in space, whose x is `east` there: unit vector (x, y)."""
    (dip,), x = (one["dip"] for one in tables["joint_sets"]), np.array([*east, 0.0])
    towards = {"dip_direction": float(np.degrees(np.arctan2(-x[0], -x[1])) % 360)}
    motion = {"direction": [0.0, 0.0, 1.0]} | ({"polarisation": x.tolist()} if kind == "S" else {})
    middle, joint = [4.0, 4.0, 8.0], tables["joint_sets"][0]
    return tables | {
        "domain": {"size": [8.0, 8.0, 16.0]},
        "joint_sets": [joint | towards | {"dip": dip, "through": middle}],
        "waves": [tables["waves"][0] | motion],
        "boundaries": dict.fromkeys(("left", "right", "front", "back", *SIDES[2:]), "quiet"),
        "record": {"points": [middle]},
    }


@pytest.mark.parametrize("kind", ["P", "S"])
@pytest.mark.parametrize("east", [(1.0, 0.0), (0.6, -0.8)])
def test_the_same_is_said_in_space(kind, east):
    """The error is that of the section along the dip, whichever way the joint dips."""
    tables = rock([SLIPS], kind)
    found = side_error(jw.load(in_space(tables, east, kind)))
    assert found.part == pytest.approx(side_error(jw.load(tables)).part, rel=1e-12)
    assert "joint set 'joint' slips" in found.words and "[4, 4, 8]" in found.words
    assert "an error of up to 100 % of the wave" in found._replace(part=1.0).words


def test_shipped_scenes_have_exact_sides_but_one_and_those_beside_loads():
    warned = {
        (path.stem, one.name)
        for path in shipped_files()
        if path.parent.name == "rock-mass"
        for one in jw.load_variants(path)
        if side_warnings(one)
    }
    loaded = {("blast-hole", ""), ("blast-in-space", ""), ("line-force", "")}
    assert warned == {("in-situ-stress", ""), *loaded}  # its bedding slips: 11 % of the wave


def test_explain_says_that_waves_in_unlike_layers_cannot_run(jointwave, tmp_path, in_toml):
    beds = [
        {"name": str(dip), "through": [0, 5 + dip], "intact_modulus": 2e10, "dip": dip}
        for dip in (0, 9)
    ]
    with pytest.raises(SceneError, match="field is not known: joints are not parallel"):
        incident(scene(regions=beds))
    (file := tmp_path / "beds.toml").write_text(in_toml(rock([{}], regions=beds)))
    assert "field is not known" in jointwave("explain", file, code=2).err
    assert "field is not known" in jw.solvers(file)["continuum-jointed"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["P", "S"])
def test_the_error_beside_a_slipping_joint_is_what_is_said(kind):
    """A joint at 30 degrees that slips at 0.1 MPa in 40 m by 40 m, against its own exact motion: at
    1 m from a side the error is at most the part that is said, in the middle less than half; it is
    less than that of linear joints everywhere. Of elements of 2 m 0.01 are theirs."""
    x = np.array([1.0, 5.0, 20.0, 39.0])
    points = np.stack([x, np.full(4, 36.0)], axis=1)
    beside = scene(
        [SLIPS | {"through": [20.0, 20.0]}],
        kind,
        domain={"size": [40.0, 40.0]},
        record={"points": points.tolist()},
        time={"duration": 0.032},
    )
    found = jw.simulate(beside, "continuum-jointed").velocity
    exact = slipping_joint(beside, points, found.time.values)
    peak = np.abs(incident(beside)(points, found.time.values).velocity).max()
    off = np.abs(found.values - exact).max(axis=(1, 2)) / peak
    part = side_error(beside).part
    assert off[0] < part and off[2] < part / 2 + 0.01
    assert off[2] < off[0] and off[2] < off[3]
