"""Which exact solution answers yes to which scene, and the reason of every no."""

import numpy as np
import pytest

from cases import SceneError
from compare.engines import solve
from compare.exact.catalogue import CATALOGUE

BARRED, DAMPED = {"joints": {"tension": False}}, {"joints": {"damping_ratio": 0.02}}
LAYER = [{"y": 20.0, "spacing_stiffness": 4.375e8}]
STIFF = [{"y": 20.0, "spacing_stiffness": 4.375e10}]
QUIET = {"ends": {"start": "quiet", "end": "quiet"}}
STEP = {
    "load": {"shape": "step", "period": None},
    "time": {"duration": 0.02},
    "record": {"interval": 1e-4},
}
LONG = {"pillar": {"length": 1500.0}}

YES = [
    ("lattice", DAMPED | QUIET | {"soft_layers": LAYER}),
    ("no-tension-chain", BARRED),
    ("jointed-bar", DAMPED | QUIET | {"soft_layers": LAYER}),
    ("equivalent-bar", DAMPED | QUIET | {"soft_layers": LAYER}),
    ("images", STEP),
    ("images", QUIET),
    ("series", {}),
    ("kelvin-voigt", DAMPED),
    ("one-joint", QUIET | {"soft_layers": LAYER}),
]
NO = [
    ("lattice", BARRED, "a joint bars tension"),
    ("lattice", LONG, "more than 2,000 blocks: the matrix exponential is dense"),
    ("no-tension-chain", {}, "every joint carries tension: see lattice"),
    ("no-tension-chain", BARRED | LONG, "more than 2,000 blocks: too many for a tight ODE solver"),
    ("jointed-bar", {"rock": {"intact_modulus": None}}, "rock.intact_modulus is not given"),
    ("jointed-bar", BARRED, "a joint bars tension"),
    ("jointed-bar", {"ends": {"start": "fixed"}}, "the loaded end is fixed"),
    ("equivalent-bar", BARRED, "a joint bars tension"),
    (
        "equivalent-bar",
        {"soft_layers": STIFF, "rock": {"intact_modulus": None}},
        "a soft layer is stiffer than the ordinary joints",
    ),
    ("equivalent-bar", {"ends": {"start": "fixed"}}, "the loaded end is fixed"),
    ("images", BARRED, "a joint bars tension"),
    ("images", DAMPED, "the joints are damped"),
    ("images", {"soft_layers": LAYER}, "a soft layer reflects within the bar"),
    ("images", {"ends": {"start": "fixed"}}, "the loaded end is fixed"),
    ("series", DAMPED, "the joints are damped"),
    ("series", QUIET, "an end is not free"),
    ("series", STEP, "the load is not a sine"),
    ("series", {"record": {"stress": [0.0, 20.0]}}, "every term is zero at the loaded end"),
    ("kelvin-voigt", BARRED, "a joint bars tension"),
    ("kelvin-voigt", {}, "the rock is not damped"),
    ("kelvin-voigt", DAMPED | {"soft_layers": LAYER}, "a soft layer reflects within the bar"),
    ("kelvin-voigt", DAMPED | QUIET, "an end is not free"),
    ("kelvin-voigt", DAMPED | STEP, "the load is not a sine"),
    ("one-joint", BARRED, "a joint bars tension"),
    ("one-joint", DAMPED, "the rock is damped"),
    ("one-joint", QUIET, "not exactly one joint differs in stiffness"),
    (
        "one-joint",
        QUIET | {"soft_layers": STIFF, "rock": {"intact_modulus": None}},
        "the layer is stiffer than the ordinary joints",
    ),
    ("one-joint", {"soft_layers": LAYER}, "the far end reflects"),
    (
        "one-joint",
        {"soft_layers": LAYER, "ends": {"start": "fixed", "end": "quiet"}},
        "the loaded end is fixed",
    ),
    (
        "one-joint",
        {"soft_layers": LAYER, "ends": {"end": "quiet"}},
        "the free start sends the reflection back, to a receiver at 0.02963 s",
    ),
]


@pytest.mark.parametrize("name, tables", YES)
def test_yes_means_that_it_solves_with_the_schema(scene, name, tables):
    at = scene(**{"time": {"duration": 0.02}, **tables})
    assert CATALOGUE[name].applies(at) == (True, "")
    result = CATALOGUE[name].solve(at)
    assert result.attrs["engine"] == name
    for variable, places in (("stress", "stress"), ("velocity", "velocity")):
        values = result[variable].values
        assert values.shape[0] == len(getattr(at.record, places))
        assert np.isfinite(values).all()
        assert np.abs(values).max() > 0


@pytest.mark.parametrize("name, tables, reason", NO)
def test_no_gives_the_reason(scene, name, tables, reason):
    at = scene(**tables)
    assert CATALOGUE[name].applies(at) == (False, reason)
    with pytest.raises(SceneError, match=reason.split(":")[0]):
        solve(name, at)


def test_every_solution_is_asked_both_ways():
    assert {name for name, _ in YES} == {name for name, *_ in NO} == set(CATALOGUE)


def test_a_solution_works_without_sections_or_points(scene):
    for name, tables in YES:
        for record in ({"velocity": []}, {"stress": []}):
            at = scene(
                **{**tables, "time": {"duration": 0.004}, "record": {**record, "interval": 1e-4}}
            )
            result = CATALOGUE[name].solve(at)
            assert result.stress.shape[0] == len(at.record.stress)
            assert result.displacement.shape[0] == len(at.record.velocity)
