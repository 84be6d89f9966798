"""Rock of a constant quality factor: modes of leapfrog in closed form, stability, energy, exact
waves, the quality factor that receivers see, and what it does not go with."""

from dataclasses import replace

import numpy as np
import pytest

from closed_forms.constant_q import ConstantQ
from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import fitted
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import applies, names, solve
from jointwave.compare.exact.bar import laplace
from jointwave.compare.exact.bar.bars import bar_of
from jointwave.compare.misfit.metrics import misfit, relative_l2
from jointwave.compare.readings.attenuation import quality_factor
from jointwave.continuum import applies as reason_against
from jointwave.continuum import simulate
from jointwave.continuum.build import operators
from jointwave.continuum.model import memory_of
from jointwave.results.dataset import energy_residual
from tests.cases.material.test_constant_q import roots
from tests.continuum.test_modes import STILL, free_mode

Q = {"rock__quality_factor": 10.0}


@pytest.mark.parametrize(("dim", "number"), [(1, 1), (1, 5), (2, 4), (3, 6), (3, 20)])
def test_mode_rings_and_decays_as_the_root_of_leapfrog_says(dim, number, short, ready):
    """400 steps at half of the critical one, to 1e-9 of the start in every freedom; rock of one
    quality factor has the modes of elastic rock."""
    load = STILL["load"] | {"period": None}
    rock = {**Q, "rock__reference_frequency": 800.0}
    run = ready(short(load=load, **rock), "equivalent", dim, samples=401)
    omega, mode = free_mode(run.discrete, number)
    z, expected = started(run.state, run.model.rock.memory, omega, mode, run.time.dt)
    run.take(0, 400)
    assert abs(z) < 1 - 1e-5
    assert np.abs(run.state.u - expected(400)).max() < 1e-9 * np.abs(mode).max()


def started(state, memory, omega, mode, dt):
    """Set a mode ringing; return its z, and what u is after n steps."""
    every = roots(memory, (omega * dt) ** 2, dt)
    z = every[np.argmax(every.imag)]
    state.u[:] = mode
    state.v[:] = state.v_before[:] = mode * (1 - 1 / z).real / dt
    for k, (gain, decay) in enumerate(zip(memory.gain, memory.decay, strict=True)):
        state.elongation[k] = mode * (gain / dt * (z - 1) / (z - decay)).real
    return z, lambda n: mode * (z**n).real


@pytest.mark.parametrize("quality", [5.0, 20.0, 500.0])
@pytest.mark.parametrize("rate", [1e-3, 0.1, 1.0, 10.0, 1e3])
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


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_energy_stays_bounded_at_the_critical_step(model, short, ready):
    """Random motion, 5000 steps at 0.9999 of the critical step."""
    load = STILL["load"] | {"period": None}
    scene = short(load=load, **Q, rock__reference_frequency=800.0)
    run = ready(scene, model, fraction=0.9999, samples=5001)
    rng = np.random.default_rng(0)
    moves = operators(run.discrete)[0].diagonal() > 0
    run.state.v[:] = run.state.v_before[:] = moves * rng.standard_normal(run.state.v.size)
    start = np.abs(run.state.v).max()
    run.take(0, 5000)
    assert np.abs(run.state.v).max() < start


SHAKEN = {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"}
APART = "joints damped apart, ends, mass damping"
LEDGERS = {
    "rock alone": {},
    APART: {
        "joints__damping_ratio": 0.05,
        "damping__mass_proportional": 50.0,
        "ends": {"start": "quiet", "end": "matched"},
        "prestress": {"normal": 1e5},
    },
    "shaken base, weight": {
        "ends": {"start": "fixed", "end": "quiet"},
        "gravity": {"direction": [0, 1, 0], "static": False},
        "load": SHAKEN,
    },
    "weight at rest": {
        "ends": {"start": "free", "end": "fixed"},
        "gravity": {"direction": [0, 1, 0], "static": True},
    },
}


@pytest.mark.parametrize(
    ("kind", "dim"), [*((kind, 1) for kind in LEDGERS), (APART, 2), (APART, 3)]
)
def test_ledger_closes_and_mechanisms_only_lose(kind, dim, short):
    result = simulate(short(**Q, **{"load__period": 1e-3} | LEDGERS[kind]), "jointed", dim)
    assert energy_residual(result) < 1e-11
    lost = result["energy"].sel(term="viscous").values
    assert lost[-1] > 0 and np.diff(lost).min() >= -1e-12 * np.abs(lost).max()


@pytest.mark.parametrize("kind", LEDGERS)
def test_ledger_of_implicit_steps_closes(kind, short):
    implicit = {"scheme": "implicit", "spectral_radius": 1.0, "elements_per_block": 1}
    changes = {"load__period": 1e-3, "numerics__continuum": implicit} | LEDGERS[kind]
    result = simulate(short(**Q, **changes), "jointed")
    assert energy_residual(result) < 1e-10
    lost = result["energy"].sel(term="viscous").values
    assert np.diff(lost).min() >= -1e-10 * np.abs(lost).max()


def test_weight_at_rest_stays_at_rest(short):
    """The static state is that of the relaxed rock, where nothing is left to relax."""
    rest = LEDGERS["weight at rest"] | {"load__amplitude": 1e-9, "load__period": 1e-3}
    result = simulate(short(**Q, **rest), "jointed")
    assert float(np.abs(result["velocity"]).max()) < 1e-12


def smooth(pillar, **changes):
    """Return 10 m of pillar that a Ricker pulse of 250 Hz runs through."""
    record = {"stress": [3.0, 7.0], "velocity": [5.25], "interval": 1e-4}
    table = {
        "pillar__length": 10.0,
        "load": {"shape": "ricker", "amplitude": 1e6, "period": 4e-3},
        "ends__end": "quiet",
        "record": record,
        "time__duration": 0.02,
        "soft_layers": [],
    }
    return pillar(**table | Q | changes)


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("jointed", {}),
        ("jointed", {"joints__damping_ratio": 0.02}),
        ("equivalent", {"soft_layers": [{"y": 5.0, "spacing_stiffness": 4.375e8}]}),
        (
            "jointed",
            {
                "segments": [{"y": [4.0, 6.0], "joints": False, "intact_modulus": 2e11}],
                "joints__damping_ratio": 0.01,
            },
        ),
    ],
    ids=["jointed", "joints damped apart", "a soft layer", "segments"],
)
def test_waves_come_to_the_exact_ones_at_second_order(pillar, model, changes):
    """Elements of order 4 leave the error of the steps alone."""
    elements = {"order": 4, "elements_per_block": 1, "scheme": "explicit"}
    exact, found = None, []
    for fraction in (1.0, 0.5):
        numerics = {"numerics__continuum": elements | {"step_fraction": fraction}}
        scene = smooth(pillar, **changes, **numerics)
        exact = exact if exact is not None else solve(f"{model}-bar", scene)
        found.append(misfit(simulate(scene, model), exact))
    assert found[1] < 2e-3 and 3.5 < found[0] / found[1] < 4.6


def test_dashpots_of_homogenised_joints_come_to_the_exact_waves(pillar):
    """Their relaxation is faster than a step, which sees it half a step late: first order."""
    found = []
    for fraction in (1.0, 0.5, 0.25):
        numerics = {"order": 4, "elements_per_block": 1, "step_fraction": fraction}
        scene = smooth(pillar, joints__damping_ratio=0.02, numerics__continuum=numerics)
        found.append(misfit(simulate(scene, "equivalent"), solve("equivalent-bar", scene)))
    assert found[0] < 3e-3 and found[1] < 0.55 * found[0] and found[2] < 0.55 * found[1]


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_implicit_steps_come_to_the_exact_waves_at_second_order(pillar, model):
    found = []
    for steps in (200, 400):
        numerics = {"scheme": "implicit", "steps_per_period": steps, "spectral_radius": 0.9}
        scene = smooth(pillar, numerics__continuum=numerics)
        found.append(misfit(simulate(scene, model), solve(f"{model}-bar", scene)))
    assert found[1] < 2e-3 and 3.5 < found[0] / found[1] < 4.6


INTACT = {
    "rock__intact_modulus": 8.64e10,
    "segments": [{"y": [0.0, 60.0], "joints": False, "intact_modulus": 4.375e9}],
}


@pytest.mark.parametrize("quality", [10.0, 20.0, 50.0, 100.0])
def test_receivers_see_the_quality_factor_in_the_whole_band(pillar, quality):
    """Within 3 % over the two decades of the band, between receivers on a bar without joints, by a
    pulse with all of these frequencies: 2.5 % are the four mechanisms', 0.2 % the records'. These
    hold the wave's tail, two periods of 10 Hz, and forty samples a period of 1000 Hz: a tail cut
    off at 0.08 s is 5 % at 12 Hz, aliasing at ten samples 10 % at 1000 Hz and Q = 100.
    Waves lose exp(-omega x / (2 Q c)) of their amplitude."""
    scene = pillar(
        rock__intact_modulus=INTACT["rock__intact_modulus"],
        pillar__length=150.0,
        segments=[INTACT["segments"][0] | {"y": [0.0, 150.0]}],
        rock__quality_factor=quality,
        rock__reference_frequency=100.0,
        load={"shape": "triangle", "amplitude": 1e6, "rise": 2e-4, "decay": 2e-4},
        ends__end="quiet",
        record={"stress": [2.0, 10.0], "velocity": [2.25, 10.25], "interval": 2.5e-5},
        time__duration=0.2,
        soft_layers=[],
    )
    result = solve("jointed-bar", scene)
    band = quality_factor(result, quantity="stress").sel(frequency=slice(10.0, 1000.0))
    assert len(band.frequency) > 190
    assert float(np.abs(band.quality / quality - 1).max()) < 0.03
    theory = ConstantQ(quality, 100.0).attenuation(band.frequency, calibrate(scene).bar_speed)
    assert np.allclose(band.attenuation, theory, rtol=0.06)


@pytest.mark.parametrize(("quality", "bound"), [(10.0, 2e-2), (20.0, 1e-2), (100.0, 2e-3)])
def test_four_mechanisms_stand_for_a_constant_quality_factor(pillar, quality, bound):
    """The pulse against that of Kjartansson's rock: a modelling error, of the fit."""
    parts = {"segments": [{"y": [0.0, 10.0], "joints": False, "intact_modulus": 4.375e9}]}
    scene = smooth(pillar, **parts, rock__quality_factor=quality)
    bar, times = bar_of(scene, resolved=True), np.arange(0, 0.02, 1e-4)

    def stress(relaxation):
        asked = load_history(scene), times, [7.0], [5.25], 4e-3
        rocks = tuple(rock._replace(relaxation=relaxation) for rock in bar.rocks)
        return laplace.bounded(replace(bar, rocks=rocks), *asked)[0][0][0]

    ideal = stress(ConstantQ(quality, 250.0))
    assert relative_l2(stress(bar.rocks[0].relaxation), ideal) < bound
    assert relative_l2(stress(None), ideal) > 10 * bound


def test_what_has_no_quality_factor_says_so(pillar, one_joint):
    scene = pillar(**Q)
    holding = {name for name in names(scene.kind) if applies(name, scene)}
    engines = {"continuum-jointed", "continuum-equivalent"}
    assert holding == {"jointed-bar", "equivalent-bar", *engines}
    layer = [{"y": 20.0, "spacing_stiffness": 4.375e8, "thickness": 0.05}]
    assert "thickness has no" in reason_against(pillar(**Q, soft_layers=layer), "jointed")
    parts = {"segments": [{"y": [4.0, 6.0], "density": 2600.0}]}
    assert "no common" in reason_against(pillar(**Q, **parts), "equivalent")
    assert "no common" in applies("equivalent-bar", pillar(**Q, **parts)).reason
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
    mass = RockMass(
        **one_joint(rock=rock | {"reference_frequency": 100.0}, joint_sets=sets, waves=[])
    )
    assert reason_against(mass, "jointed") == ""
    assert "effective medium has no" in reason_against(mass, "equivalent")
