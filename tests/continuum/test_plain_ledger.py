"""The ledger of explicit steps, as plain Python, where few effects act or all of them."""

import numpy as np
import pytest

from jointwave.continuum.state import TERMS

LAYER = [{"y": 1.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
SHAKEN = {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"}
SMALL = {"numerics__continuum__order": 2, "numerics__continuum__elements_across": 1}
CASES = {
    "nothing": (1, {}),
    "one damped joint in rock without dashpots": (1, {"soft_layers": LAYER}),
    "quiet, matched": (
        1,
        {"ends": {"start": "quiet", "end": "matched"}, "joints__damping_ratio": 0.05},
    ),
    "shaken base": (1, {"ends__start": "fixed", "load": SHAKEN}),
    "shaken base, weight, mass damping, layer": (
        1,
        {
            "soft_layers": LAYER,
            "damping__mass_proportional": 50.0,
            "ends": {"start": "fixed", "end": "quiet"},
            "gravity": {"direction": [0, 1, 0], "static": False},
            "load": SHAKEN,
        },
    ),
    "prestressed, across": (
        2,
        {
            **SMALL,
            "soft_layers": LAYER,
            "prestress": {"normal": 1e5},
            "load__direction": [0.6, 0.8, 0.0],
        },
    ),
    "sliding": (
        2,
        {
            **SMALL,
            "joints": {"cohesion": 1e2, "friction_angle": 5.0},
            "load__direction": [0.6, 0.8, 0.0],
        },
    ),
}


@pytest.mark.parametrize("dim, changes", CASES.values(), ids=CASES)
def test_what_is_put_in_is_found_in_the_other_terms(plain, short, ready, dim, changes):
    """To round-off of the largest term, at every step."""
    run = ready(short(**changes), dim=dim).to_the_end()
    energy = dict(zip(TERMS, run.samples.energy, strict=True))
    found = sum(values for term, values in energy.items() if term != "work")
    most = max(np.abs(values - values[0]).max() for values in energy.values())
    assert energy["work"][-1] > 0
    assert np.abs(found - found[0] - energy["work"]).max() < 1e-12 * most
    assert energy["gravity"][0] == 0.0
    if "soft_layers" in changes:
        assert run.state.drags is not None and energy["viscous"][-1] > 0
    if "joints" in changes and "cohesion" in changes["joints"]:
        assert energy["friction"][-1] > 1e-5 * energy["work"][-1]


@pytest.mark.parametrize("dim, changes", CASES.values(), ids=CASES)
def test_a_ledger_changes_no_bit(plain, short, ready, dim, changes):
    with_it, without = (
        ready(short(**changes, record={"energy": kept}), dim=dim, samples=21).to_the_end()
        for kept in (True, False)
    )
    assert without.samples.energy is None and with_it.samples.waves.any()
    assert (with_it.samples.waves == without.samples.waves).all()


@pytest.mark.parametrize("changes", [{"soft_layers": LAYER}, {"joints__damping_ratio": 0.05}])
def test_what_nothing_loads_stays_at_rest(plain, short, ready, changes):
    """Dashpots of one joint in rock without any, and of all."""
    scene = short(**changes, load__amplitude=0.0, ends={"start": "quiet", "end": "matched"})
    run = ready(scene, dim=1, samples=5).to_the_end()
    assert run.state.drags is not None
    assert (run.model.rock.viscosity is None) == ("soft_layers" in changes)
    assert not run.samples.waves.any() and not run.samples.energy.any()


@pytest.mark.parametrize("ends", [("free", "free"), ("quiet", "matched"), ("free", "fixed")])
@pytest.mark.parametrize("dim", [1, 2])
def test_prestressed_rock_carries_its_prestress(plain, short, ready, dim, ends):
    """On joints, between them and at the ends, and nothing moves."""
    scene = short(
        **SMALL,
        load__amplitude=0.0,
        prestress={"normal": 1e5},
        ends=dict(zip(("start", "end"), ends, strict=True)),
        record={"stress": [0.0, 0.7, 1.0, 1.9]},
    )
    run = ready(scene, dim=dim, samples=5).to_the_end()
    assert np.abs(run.waves["stress"] / 1e5 - 1).max() < 1e-12
    assert np.abs(run.waves["velocity"]).max() < 1e-12
