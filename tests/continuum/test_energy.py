"""The energy ledger closes: to round-off where every force is linear, and where joints slide."""

import numpy as np
import pytest

from jointwave.continuum import simulate
from jointwave.results.dataset import energy_residual
from tests.continuum.bodies import blow, oblique

LAYER = {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8}]}
DAMPED = {"joints__damping_ratio": 0.05}
LINEAR = {
    "undamped": {},
    "soft layer": LAYER,
    "damped, matched": {**DAMPED, "ends__start": "matched", "ends__end": "quiet"},
    "damped soft layer, quiet": {**DAMPED, **LAYER, "ends__end": "quiet"},
    "fixed": {"ends__end": "fixed"},
}


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
@pytest.mark.parametrize("kind", LINEAR)
def test_ledger_of_the_bar_closes_to_round_off(pillar, kind, model):
    result = simulate(pillar(time__duration=0.06, **LINEAR[kind]), model)
    assert energy_residual(result) < 1e-11


SOFT = [{"y": 1.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
EVERYTHING = {
    "damped, quiet and matched": {
        "damping__mass_proportional": 50.0,
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
        "prestress": {"normal": 1e5},
    },
    "damped, shaken base, weight": {
        "soft_layers": SOFT,
        "joints__damping_ratio": 0.02,
        "damping__mass_proportional": 50.0,
        "ends": {"start": "fixed", "end": "quiet"},
        "gravity": {"static": False},
        "load": {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"},
    },
}


def in_space(short, dim: int, changes: dict, **more):
    """Return a scene of a blow with these changes, all its directions made those of `dim`."""
    given = dict(changes)
    for key in {"load", "gravity"} & given.keys():
        given[key] = given[key] | {"direction": oblique(dim)}
    return short(**({"load": blow(dim)} | given | more))


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("kind", EVERYTHING)
def test_ledger_closes_to_round_off_in_all_dimensions(short, dim, kind):
    scene = in_space(short, dim, EVERYTHING[kind])
    result = simulate(scene, "jointed", dim=dim)
    assert energy_residual(result) < 1e-11
    never_falls(result["energy"].sel(term="viscous").values)
    terms = set(result["term"].values)
    assert ("gravity" in terms) == ("gravity" in EVERYTHING[kind]) and "friction" not in terms


@pytest.mark.parametrize("cell", ["hexahedron", "simplex"])
def test_ledger_closes_to_round_off_for_every_kind_of_element(short, cell):
    numerics = {"cell": cell, "scheme": "explicit", "order": 1, "elements_per_block": 1}
    scene = in_space(
        short, 3, EVERYTHING["damped, quiet and matched"], numerics__continuum=numerics
    )
    assert energy_residual(simulate(scene, "jointed", dim=3)) < 1e-11


def never_falls(energy):
    assert energy[-1] > 0 and np.diff(energy).min() >= -1e-12 * np.abs(energy).max()


SLIP = {"friction_angle": 20.0, "cohesion": 1e4}


@pytest.mark.parametrize("damping", [{}, {"damping_ratio": 0.05}], ids=["elastic", "damped"])
def test_ledger_closes_to_round_off_while_joints_slide(short, damping):
    """Friction books the mean of the spring force before and after the step, which closes. With a
    dashpot beside it that force may still point against the slide where the motion turns."""
    scene = in_space(short, 3, {"joints": {**SLIP, **damping}, "prestress": {"normal": 1e5}})
    result = simulate(scene, "jointed", dim=3)
    assert energy_residual(result) < 1e-11
    friction = result["energy"].sel(term="friction").values
    if not damping:
        never_falls(friction)
    assert friction[-1] > 1e-3 * float(result["energy"].sel(term="work").max())


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_quiet_end_takes_what_the_load_put_in(pillar, model):
    """Once the pulse has left, all of the work is in the boundary. The quiet end is matched to
    the homogenised bar; the jointed one reflects a little, by its dispersion."""
    result = simulate(pillar(ends__end="quiet"), model)
    last = result["energy"].isel(time=-1)
    share = float(last.sel(term="boundary") / last.sel(term="work"))
    assert share == pytest.approx(1.0, abs=1e-3 if model == "equivalent" else 1e-2)


def test_dissipated_energy_never_falls(pillar):
    result = simulate(pillar(ends__end="quiet", **DAMPED))
    work = float(result["energy"].sel(term="work").max())
    for term in ("viscous", "boundary"):
        assert float(result["energy"].sel(term=term).diff("time").min()) > -1e-9 * work
    assert float(result["energy"].sel(term="viscous").max()) > 0.01 * work


@pytest.mark.parametrize("zeta", [None, 0.02])
def test_no_tension_joints_never_pull_and_lose_no_energy(pillar, zeta):
    """Opening and closing between steps costs order dt^2, below 1e-3 at the default step."""
    damping = {} if zeta is None else {"joints__damping_ratio": zeta}
    places = np.arange(0.5, 50.0, 0.5).tolist()
    result = simulate(
        pillar(joints__tension=False, record__stress=places, record__velocity=[25.0], **damping)
    )
    peak = float(result["stress"].max())
    assert float(result["stress"].min()) > -1e-10 * peak
    assert energy_residual(result) < 1e-3
    assert 0.5e6 < peak < 1.1e6
