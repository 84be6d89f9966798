"""The wave that enters is the one that `explain` prints: stress, velocity, length and energy.

A load on a start that absorbs enters at half its amplitude, since the dashpot takes the other half;
users found their waves twice too weak. Peak stress, peak velocity and energy are those of a plane
wave, sigma = rho c v and sigma^2 / (rho c) integrated over time, by both engines."""

import numpy as np
import pytest
import xarray as xr

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.cases.warnings import warnings
from jointwave.compare.cli.scene_files import starter
from jointwave.compare.readings.entering_wave import entering_waves
from tests.field_cases.scenes import ENGINES, P_SPEED, S_SPEED, mass

DENSITY, MODULUS, NU = 2400.0, 2400.0 * 1350.0**2, 0.4238281
PRESSURE = {"shape": "half-sine", "amplitude": 1e6, "period": 0.02}
INCIDENT = PRESSURE | {"quantity": "incident-stress"}
MOTION = PRESSURE | {"quantity": "velocity", "amplitude": 0.1}
ACROSS = {"direction": [1.0, 0.0, 0.0]}
#: Start, load, and the stress that enters, Pa: rho c v of a velocity.
ENTERS = [
    ("free", PRESSURE, 1e6),
    ("quiet", PRESSURE, 5e5),
    ("matched", PRESSURE, 5e5),
    ("quiet", INCIDENT, 1e6),
    ("matched", INCIDENT, 1e6),
    ("quiet", MOTION, 0.1 * DENSITY * 1350.0),
    ("fixed", MOTION, 0.1 * DENSITY * 1350.0),
    ("free", PRESSURE | ACROSS, 1e6),
    ("matched", INCIDENT | ACROSS, 1e6),
]


def pillar(start, load):
    """Return rock of 1350 m/s, and 800 m/s in shear, with a load on a start, whose wave passes a
    receiver at 10 m."""
    return {
        "title": "what enters",
        "pillar": {"length": 40.0, "side": 0.5, "block": 0.25},
        "rock": {"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": NU},
        "motion": {"rotation": "none"},
        "load": load,
        "ends": {"start": start, "end": "quiet"},
        "time": {"duration": 0.024},
        "record": {"stress": [10.0], "velocity": [10.125]},
    }


@pytest.mark.parametrize(
    ("start", "shape", "final"), [("quiet", "half-sine", 2.0), ("fixed", "sine", 0.0)]
)
def test_what_a_base_keeps_moving_at_enters_to_the_end_of_the_scene(start, shape, final):
    """Half a sine of acceleration a leaves the velocity a T / pi, a whole one none: of (1 - cos)
    the energy is 3/2 of the square of a T / 2 pi over the pulse, and 4 of it from then on."""
    load = PRESSURE | {"quantity": "acceleration", "amplitude": 8.0, "shape": shape}
    (wave,) = entering_waves(jw.load(pillar(start, load)))
    unit, pulse = 8.0 * 0.02 / (2 * np.pi), 0.01 if final else 0.02
    lasts = 0.024 if final else pulse
    energy = DENSITY * 1350.0 * unit**2 * (1.5 * pulse + final**2 * (lasts - pulse))
    assert wave.velocity == pytest.approx(2 * unit, rel=1e-6)
    assert (wave.length, wave.energy) == pytest.approx((1350.0 * lasts, energy), rel=1e-3)


@pytest.mark.parametrize("engine", ["dem", "continuum-equivalent"])
@pytest.mark.parametrize(("start", "load", "stress"), ENTERS)
def test_what_explain_says_enters_a_pillar_enters(start, load, stress, engine):
    """Closed form of half a sine: length c T / 2, energy sigma^2 T / (4 rho c). The chain of 0.25 m
    blocks adds ripples of some (k d)^2 to the kinks of the pulse, 1 % in shear, where k d = 0.1."""
    scene = jw.load(pillar(start, load))
    (wave,) = entering_waves(scene)
    across = "direction" in load
    speed, within = (800.0, 0.012) if across else (1350.0, 2e-3)
    impedance = DENSITY * speed
    assert wave[1:] == pytest.approx(
        (stress, stress / impedance, speed * 0.01, stress**2 * 0.005 / impedance), rel=1e-4
    )
    run = jw.simulate(scene, engine)
    peak = np.abs(run["shear" if across else "stress"]).max()
    assert peak == pytest.approx(wave.stress, within)
    assert np.abs(run.velocity).max() == pytest.approx(wave.velocity, within)
    moving = run.energy.sel(term=["kinetic", "elastic"]).sum("term").max() / scene.pillar.area
    assert moving == pytest.approx(wave.energy, 2 * within)


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
@pytest.mark.parametrize("start", ["quiet", "matched"])
def test_small_waves_enter_and_leave_joints_that_a_prestress_has_closed(start, engine):
    """Rock of K_n (1 + s / (K_n d_m))^2, here of 3.6 times its speed without stress: with the
    impedance of joints without stress 57 % of a wave came back, and 1.57 times of it entered."""
    own, closes, rest, intact, block = 1e10, 1e-4, 5e6, 8.64e10, 0.25
    stiffer = own * (1 + rest / (own * closes)) ** 2
    speed = np.sqrt(1 / (1 / intact + 1 / (block * stiffer)) / DENSITY)
    load = {"shape": "ricker", "amplitude": 0.01, "period": 0.02, "quantity": "velocity"}
    tables = pillar(start, load) | {
        "rock": {"density": DENSITY, "intact_modulus": intact},
        "joints": {"normal_stiffness": own, "maximum_closure": closes},
        "prestress": {"normal": rest},
        "gravity": {"direction": [0.0, 1.0, 0.0], "acceleration": 1e-3},
        "motion": {},
        "ends": {"start": start, "end": "matched"},
        "time": {"duration": 0.09},
    }
    stress = DENSITY * speed * 0.01
    if start == "matched":
        tables["load"] = load | {"quantity": "incident-stress", "amplitude": stress}
    scene = jw.load(tables)
    assert not warnings(scene)
    (wave,) = entering_waves(scene)
    assert wave.stress == pytest.approx(stress) and wave.velocity == pytest.approx(0.01)
    run = jw.simulate(scene, engine)
    moved = run.stress.values[0] - rest
    assert moved.max() == pytest.approx(stress, rel=0.02)
    assert run.velocity.values.max() == pytest.approx(0.01, rel=0.02)
    assert np.abs(moved[run.time.values > 0.07]).max() < 0.01 * stress  # nothing comes back
    heavy = jw.load(tables, changes={"load.amplitude": 100 * tables["load"]["amplitude"]})
    assert sum("joints that close under" in line for line in warnings(heavy)) == 2


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
def test_a_small_wave_leaves_a_pillar_whose_joints_its_weight_has_closed(engine):
    """At the end they are 163 times as stiff as without stress; most of the wave came back."""
    tables = pillar("free", {"shape": "ricker", "amplitude": 1e3, "period": 0.01}) | {
        "rock": {"density": DENSITY, "intact_modulus": 8.64e10},
        "joints": {"normal_stiffness": 4e9, "maximum_closure": 2e-5},
        "gravity": {"direction": [0.0, 1.0, 0.0]},
        "prestress": {"normal": 0.0},
        "motion": {},
        "ends": {"end": "matched"},
        "time": {"duration": 0.1},
    }
    scene = jw.load(tables)
    assert not warnings(scene)
    run = jw.simulate(scene, engine)
    moved = np.abs(run.stress.values[0] - run.stress.values[0, 0])
    assert moved[run.time.values > 0.07].max() < 0.01 * moved.max()


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
@pytest.mark.parametrize("crossed", [False, True])
def test_quiet_sides_pass_small_waves_through_joints_that_a_prestress_has_closed(engine, crossed):
    """The dashpots of beds without stress took 0.55 of the wave of a base. Into crossing sets the
    wave of their medium enters: that of open joints was 0.64 of it."""
    bed = {"name": "bed", "dip": 0.0, "spacing": 0.5, "normal_stiffness": 1e10}
    bed |= {"shear_stiffness": 5e9, "maximum_closure": 1e-4}
    wave = {"shape": "ricker", "amplitude": 0.01, "period": 0.02, "quantity": "velocity"}
    way = {"direction": [0.0, 1.0]}
    enters = {"loads": [wave | way | {"kind": "base", "side": "bottom"}]}
    if crossed:
        enters = {"waves": [wave | way | {"kind": "P"}]}
    tables = {
        "title": "beds under stress",
        "domain": {"size": [1.0, 20.0]},
        "rock": {"density": DENSITY, "intact_modulus": 8.64e10, "intact_poisson": 0.0},
        "joint_sets": [bed, *[bed | {"name": "cross", "dip": 90.0}] * crossed],
        "prestress": {"xx": 0.0, "yy": 5e6},
        "gravity": {"acceleration": 1e-3},
        "boundaries": dict.fromkeys(("left", "right"), "periodic")
        | dict.fromkeys(("bottom", "top"), "quiet"),
        "time": {"duration": 0.07},
        "record": {"points": [[0.5, 10.2]]},
    } | enters
    moved = jw.simulate(jw.load(tables), engine).velocity.values
    assert np.abs(moved).max() == pytest.approx(0.01, rel=0.02)
    for key in enters:  # 10 m/s: a wave that closes joints further
        lines = warnings(jw.load(tables, changes={f"{key}.0.amplitude": 10.0}))
        assert sum("joints that close under" in line for line in lines) == 2


SIDE = {"shape": "half-sine", "amplitude": 1e6, "period": 0.004}
MOVED = SIDE | {"quantity": "velocity", "amplitude": 0.1}
OBLIQUE = {"direction": [0.6, 0.8]}
WAVE, BASE = {"direction": [0.0, 1.0]}, {"kind": "base", "side": "bottom"}
PUSH = SIDE | {"kind": "pressure", "side": "bottom"}
#: What acts at the bottom, and the stress that enters, Pa: rho c v of a velocity.
ON_SIDES = [
    ("quiet", "waves", SIDE | WAVE | {"kind": "P"}, {"P": 1e6}),
    ("quiet", "waves", MOVED | WAVE | {"kind": "S"}, {"S": 260 * S_SPEED}),
    ("free", "loads", PUSH, {"P": 1e6}),
    ("quiet", "loads", PUSH, {"P": 5e5}),
    ("quiet", "loads", MOVED | BASE | OBLIQUE, {"P": 208 * P_SPEED, "S": 156 * S_SPEED}),
    ("fixed", "loads", MOVED | BASE | {"direction": [1.0, 0.0]}, {"S": 260 * S_SPEED}),
]


def rock_mass(bottom, key, one):
    """Return rock between periodic sides, cut by all but rigid joints, and what acts below."""
    rigid = {"normal_stiffness": 3e14, "shear_stiffness": 3e14}
    tables = mass(
        *(2.0, 20.0),
        joint_sets=[
            rigid | {"name": "across", "dip": 0.0, "through": [1.0, 16.0]},
            rigid | {"name": "sides", "dip": 90.0, "spacing": 1.0},
        ],
        boundaries={"left": "periodic", "right": "periodic", "bottom": bottom, "top": "quiet"},
        time={"duration": 0.006},
        record={"points": [[0.75, 6.25]]},
        numerics={"dem": {"block": 0.5}, "continuum": {"size": 0.5}},
    )
    return tables | {key: [one]}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("bottom", "key", "one", "stresses"), ON_SIDES)
def test_what_explain_says_enters_a_rock_mass_enters(bottom, key, one, stresses, engine):
    """Blocks of half a metre, some (k d)^2 = 0.01 where S is 22 blocks a quarter wave."""
    scene = jw.load(rock_mass(bottom, key, one))
    waves, run = entering_waves(scene), jw.simulate(scene, engine)
    assert [wave.source[-1] for wave in waves] == list(stresses)
    for wave in waves:
        speed = P_SPEED if wave.source.endswith("P") else S_SPEED
        stress = stresses[wave.source[-1]]
        expected = (stress, stress / (2600 * speed), speed * 0.002)
        assert wave[1:4] == pytest.approx(expected, rel=1e-4)
        component, axis = ("yy", "y") if wave.source.endswith("P") else ("xy", "x")
        peak = np.abs(run.stress.sel(stress_component=component)).max()
        assert peak == pytest.approx(wave.stress, 0.01)
        assert np.abs(run.velocity.sel(axis=axis)).max() == pytest.approx(wave.velocity, 0.01)
    energy = 2.0 * sum(wave.energy for wave in waves)
    assert 2 * run.energy.sel(term="kinetic").max() == pytest.approx(energy, 0.01)


@pytest.mark.parametrize("start", ["quiet", "matched"])
def test_a_load_that_a_dashpot_halves_is_warned_of(start):
    def lines(load, start=start):
        return [line for line in warnings(jw.load(pillar(start, load))) if "takes half" in line]

    (line,) = lines(PRESSURE)
    assert "takes half: 500000 enters" in line and "'incident-stress'" in line
    for good in (INCIDENT, PRESSURE | {"amplitude": 0.0}):
        assert not lines(good)
    assert not lines(PRESSURE, "free")
    for bottom in ("quiet", "free"):
        found = warnings(jw.load(rock_mass(bottom, "loads", PUSH)))
        said = ["500000 enters" in line for line in found if "loads[0].amplitude" in line]
        assert said == ([True] if bottom == "quiet" else [])


@pytest.mark.parametrize("start", ["free", "fixed"])
def test_an_incident_wave_needs_a_start_that_lets_it_in(start):
    said = r"load.quantity = 'incident-stress': .*'matched' or 'quiet'"
    with pytest.raises(SceneError, match=said):
        jw.load(pillar(start, INCIDENT))


def test_explain_prints_what_enters(tmp_path, jointwave):
    (path := tmp_path / "new.toml").write_text(starter("new.toml", "pillar"))
    assert "load, along the axis  1e+06        0.3086" in jointwave("explain", path).out


STIFF = {"normal_stiffness": 1e10, "shear_stiffness": 5e9}
JOINTS = {"name": "joints", "spacing": 2.0, "through": [1.0, 1.0, 1.0], **STIFF}
SETS = {"across": {"dip": 90.0, "dip_direction": 90.0}, "along": {"dip": 0.0}}


@pytest.mark.parametrize(
    ("joints", "direction", "speed"),
    [
        ("across", [0.0, 1.0, 0.0], 2774.0),
        ("across", [1.0, 0.0, 0.0], 1601.0),
        ("along", [0.6, 0.8, 0.0], 1601.0),
    ],
)
@pytest.mark.parametrize("engine", ENGINES)
def test_a_shear_wave_enters_jointed_rock_in_space_as_it_is_given(engine, joints, direction, speed):
    """Joints across the quiet base soften one of both polarisations, joints along it both, to
    1 / (rho b^2) = 1 / 20e9 + 1 / (2 m x 5e9), b = 1601 m/s; the other has 2774 m/s. The wave that
    comes up has the velocity of the base, as long as it is, and its own speed."""
    pulse = {"shape": "ricker", "period": 0.03, "amplitude": 0.1, "quantity": "velocity"}
    sides = dict.fromkeys(["left", "right", "front", "back"], "periodic")
    tables = mass(
        *(2.0, 2.0),
        domain={"size": [2.0, 2.0, 24.0]},
        joint_sets=[JOINTS | SETS[joints]],
        loads=[BASE | {"direction": direction, **pulse}],
        boundaries={"bottom": "quiet", "top": "quiet", **sides},
        time={"duration": 0.09},
        numerics={"dem": {"block": 1.0}, "continuum": {"size": 2.0}},
        record={"points": [[0.7, 0.7, 3.9], [0.7, 0.7, 15.9]], "interval": 1e-4},
    )
    scene = jw.load(tables)
    moved = jw.simulate(scene, engine).velocity @ xr.DataArray(direction, dims="axis")
    assert moved.max("time").values == pytest.approx([0.1, 0.1], rel=0.03)
    below, above = moved.idxmax("time").values
    assert 12.0 / (above - below) == pytest.approx(speed, rel=0.03)
