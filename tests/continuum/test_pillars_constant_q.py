"""Pillars of a constant quality factor: exact waves, energy, and what it does not go with."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import applies, names, solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.continuum.run import simulate
from jointwave.continuum.validity import applies as reason_against
from jointwave.results.dataset import energy_residual

Q = {"rock__quality_factor": 10.0}
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
    ("kind", "dim", "scheme"),
    [
        *((kind, 1, scheme) for kind in LEDGERS for scheme in ("explicit", "implicit")),
        (APART, 3, "explicit"),
    ],
)
def test_the_ledger_closes_and_mechanisms_only_lose(kind, dim, scheme, short):
    own = {"scheme": scheme, "spectral_radius": 1.0, "elements_per_block": 1}
    scene = short(own, load__period=1e-3, **Q | LEDGERS[kind])
    result = simulate(scene, "jointed", dim=dim)
    assert energy_residual(result) < (1e-11 if scheme == "explicit" else 1e-10)
    lost = result["energy"].sel(term="viscous").values
    assert lost[-1] > 0 and np.diff(lost).min() >= -1e-10 * np.abs(lost).max()


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
    ids=["joints damped apart", "a soft layer", "segments"],
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
