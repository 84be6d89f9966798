"""Rock of a constant quality factor: its modes under the steps, stability, energy, static states,
exact waves, and what it does not go with."""

import numpy as np
import pytest
from scipy.linalg import eigh

from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.cases.material.constant_q import fitted, mechanisms_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import applies, names, solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.continuum.problem import problem_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.memory import memory_of
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.static import settled
from jointwave.continuum.validity import applies as reason_against
from jointwave.results.dataset import energy_residual
from jointwave.results.snapshots import snapshots_of
from tests.cases.material.test_constant_q import roots
from tests.continuum.bodies import PUSH
from tests.continuum.stacked import readings, stack

ROCK = {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2, "quality_factor": 10.0}
ELASTIC = {name: value for name, value in ROCK.items() if name != "quality_factor"}
slow = pytest.mark.slow
SPEED = np.sqrt(2.0)  # of the bar of `stack`
Q = {"rock__quality_factor": 10.0}
LAYER = {"y": 5.0, "spacing_stiffness": 4.375e8}
DAMPED_LAYER = LAYER | {"y": 8.0, "damping_ratio": 1e-3}
BAR = {"y": [4.0, 6.0], "joints": False, "intact_modulus": 2e11}


@pytest.mark.parametrize(("dim", "number"), [(2, 4), pytest.param(3, 20, marks=slow)])
def test_a_mode_rings_and_decays_as_the_root_of_leapfrog_says(dim, number):
    """Rock of one quality factor, here in the band of its modes, has the modes of elastic rock."""
    body = stack(dim, 1, 4 if dim < 3 else 2, 1)
    found = fitted(10.0, SPEED / 2, SPEED / 20, SPEED * 5)
    own = Problem(body, readings(body), mechanisms=found)
    dt = 0.5 * own.critical_step()
    steps = Leapfrog(own, dt, 1)
    square, shapes = eigh(body.stiffness.toarray(), np.diag(body.mass))
    mode = np.zeros(steps.product.size)
    mode[steps.product.place] = shapes[:, number]
    memory, state = memory_of(own.mechanisms, dt), steps.state
    every = roots(memory, square[number] * dt**2, dt)
    z = every[np.argmax(every.imag)]
    state.u[:] = mode
    state.v[:] = state.v_before[:] = mode * (1 - 1 / z).real / dt
    for k, (gain, decay) in enumerate(zip(memory.gain, memory.decay, strict=True)):
        state.elongation[k] = mode * (gain / dt * (z - 1) / (z - decay)).real
    steps.take(0, 400, 1000)
    assert abs(z) < 1 - 1e-5
    assert np.abs(state.u - mode * (z**400).real).max() < 1e-9 * np.abs(mode).max()


@pytest.mark.parametrize("quality", [5.0, 500.0])
@pytest.mark.parametrize("rate", [1e-3, 1.0, 1e3])
def test_no_motion_grows_up_to_the_critical_step_of_the_unrelaxed_rock(quality, rate):
    """rate : steps over the period of the fastest mechanism. Beyond the critical step motion grows
    where nothing relaxes within a step; else the rock is a little softer there."""
    found = fitted(quality, 100.0, 10.0, 1000.0)
    dt = rate / found.frequency.max()
    memory = memory_of(found, dt)
    for x in np.linspace(0.01, 4, 60).tolist():
        assert np.abs(roots(memory, x, dt)).max() <= 1 + 1e-9
    slow = memory_of(found, 1e-6 / found.frequency.max())
    assert np.abs(roots(slow, 4.01, 1e-6 / found.frequency.max())).max() > 1.05


@pytest.mark.parametrize(
    ("dim", "scheme"),
    [(1, "implicit"), (1, "explicit"), pytest.param(3, "explicit", marks=slow)],
)
def test_the_ledger_closes_and_mechanisms_only_lose(dim, scheme, short, plain):
    """Joints damped apart, ends, mass damping."""
    own = {"scheme": scheme, "spectral_radius": 1.0}
    scene = short(
        own,
        **Q,
        load__period=1e-3,
        joints__damping_ratio=0.05,
        damping__mass_proportional=50.0,
        ends={"start": "quiet", "end": "matched"},
        prestress={"normal": 1e5},
    )
    result = simulate(scene, "jointed", dim=dim)
    assert energy_residual(result) < (1e-11 if scheme == "explicit" else 1e-10)
    lost = result["energy"].sel(term="viscous").values
    assert lost[-1] > 0 and np.diff(lost).min() >= -1e-10 * np.abs(lost).max()


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_weight_at_rest_stays_at_rest_on_relaxed_rock(rock_mass, scheme):
    tables = {
        "boundaries": {"bottom": "fixed", "left": "roller", "right": "roller"},
        "loads": [PUSH | {"amplitude": 1e-6}],
        "gravity": {},
        "continuum": {"scheme": scheme},
    }
    scene, elastic = (rock_mass(rock=one, **tables) for one in (ROCK, ELASTIC))
    result = simulate(scene)
    assert float(np.abs(result["velocity"]).max()) < 1e-12
    u = [settled(one, problem_of(one, body_of(one, "jointed"))).u for one in (scene, elastic)]
    found = mechanisms_of(scene, "jointed")
    known = u[1] / (found.unrelaxed * found.relaxed)
    np.testing.assert_allclose(u[0], known, rtol=0, atol=1e-12 * np.abs(known).max())


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_snapshots_have_the_stress_that_receivers_record(rock_mass, scheme):
    """A receiver in the middle of a linear element of the only two in the rock reads its stress."""
    scene = rock_mass(
        rock=ROCK, loads=[PUSH], boundaries={"bottom": "fixed"},
        domain={"size": [6.0, 4.0]}, continuum={"scheme": scheme, "size": 4.0},
        record={"points": [[1.5, 2.0]], "interval": 2e-5, "fields": 4e-5},
    )  # fmt: skip
    result = simulate(scene)
    s = snapshots_of(result)
    every = round(4e-5 / 2e-5)
    known = result["stress"].values[0, ::every]
    away = s.points[s.cells].mean(axis=1)[:, :2] - [1.5, 2.0]
    cell = int(np.linalg.norm(away, axis=1).argmin())
    np.testing.assert_allclose(s.stress[:, cell], known, rtol=0, atol=1e-9 * np.abs(known).max())


def smooth(pillar, **changes):
    """Return 10 m of pillar that a Ricker pulse of 250 Hz runs through."""
    table = {
        "pillar__length": 10.0,
        "load": {"shape": "ricker", "amplitude": 1e6, "period": 4e-3},
        "ends__end": "quiet",
        "record": {"stress": [3.0, 7.0], "velocity": [5.25], "interval": 1e-4},
        "time__duration": 0.02,
        "soft_layers": [],
    }
    return pillar(**table | Q | changes)


QUARTIC = {"order": 4, "elements_per_block": 1, "scheme": "explicit"}
EXPLICIT = [QUARTIC | {"step_fraction": fraction} for fraction in (1.0, 0.5, 0.25)]
IMPLICIT = [
    {"scheme": "implicit", "steps_per_period": steps, "spectral_radius": 0.9}
    for steps in (200, 400)
]


@pytest.mark.parametrize(
    ("model", "changes", "numerics"),
    [
        pytest.param("jointed", {"joints__damping_ratio": 0.02}, EXPLICIT[:2], marks=slow),
        ("equivalent", {"soft_layers": [LAYER, DAMPED_LAYER]}, EXPLICIT[:2]),
        ("jointed", {"segments": [BAR], "joints__damping_ratio": 0.01}, EXPLICIT[:2]),
        ("jointed", {}, IMPLICIT),
        ("equivalent", {}, IMPLICIT),
    ],
    ids=["joints damped apart", "soft layers", "segments", "implicit", "implicit, homogenised"],
)
def test_waves_come_to_the_exact_ones_at_second_order(pillar, model, changes, numerics):
    """Elements of order 4 leave the error of the steps alone."""
    exact, found = solve(f"{model}-bar", smooth(pillar, **changes)), []
    for one in numerics:
        scene = smooth(pillar, **changes, numerics__continuum=one)
        found.append(misfit(simulate(scene, model), exact))
    assert found[1] < 2e-3 and 3.5 < found[0] / found[1] < 4.6


def test_dashpots_of_homogenised_joints_come_to_the_exact_waves(pillar):
    """Their relaxation is faster than a step, which sees it half a step late: first order."""
    damped = {"joints__damping_ratio": 0.02, "soft_layers": [DAMPED_LAYER]}  # of others' kernel
    exact, found = solve("equivalent-bar", smooth(pillar, **damped)), []
    for one in EXPLICIT:
        scene = smooth(pillar, **damped, numerics__continuum=one)
        found.append(misfit(simulate(scene, "equivalent"), exact))
    assert found[0] < 3e-3 and found[1] < 0.55 * found[0] and found[2] < 0.55 * found[1]


def test_what_has_no_quality_factor_says_so(pillar, one_joint):
    scene = pillar(**Q)
    holding = {name for name in names(scene.kind) if applies(name, scene)}
    engines = {"continuum-jointed", "continuum-equivalent"}
    assert holding == {"jointed-bar", "equivalent-bar", *engines}
    thick = pillar(**Q, soft_layers=[LAYER | {"thickness": 0.05}])
    assert "thickness has no" in reason_against(thick, "jointed")
    parts = pillar(**Q, segments=[{"y": [4.0, 6.0], "density": 2600.0}])
    assert "no common" in reason_against(parts, "equivalent")
    assert "no common" in applies("equivalent-bar", parts).reason
    rock = {"density": 2600.0, "intact_modulus": 5e10, "quality_factor": 20.0}
    mass = RockMass(**one_joint(rock=rock))
    assert "[[waves]] do not support" in reason_against(mass, "jointed")
    assert not any(applies(name, mass) for name in names(mass.kind))
    for one in (scene, mass):
        with pytest.raises(SceneError, match=r"quality_factor = .* the exact bars support it"):
            dem.simulate(one)
        assert "rock.quality_factor is not supported by rigid blocks" in applies("dem", one).reason
    sets = [{"name": "a", "dip": 0.0, "spacing": 5.0, "normal_stiffness": 1e10}]
    sets[0]["shear_stiffness"] = 4e9
    rock["reference_frequency"] = 100.0
    mass = RockMass(**one_joint(rock=rock, joint_sets=sets, waves=[]))
    assert reason_against(mass, "jointed") == ""
    assert "effective medium has no" in reason_against(mass, "equivalent")
