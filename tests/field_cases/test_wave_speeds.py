"""Which wave speed has a pillar? A column, 10 m, E 50 MPa, nu 0.3, density 1890 kg/m3, fixed base,
step of 1 kPa on top that rises in 2.5 ms (Kratos Multiphysics, pull request 12047).

A bar with free sides has sqrt(E / rho) = 162.65 m/s, a plate in plane stress between fixed sides
170.50, confined rock 188.71. The sides of a pillar are free, and E is the modulus that rigid blocks
get (Guo & Li 2002, eq. 4 to 6), so that all engines are the bar, in every dimension."""

import json

import pytest

import jointwave as jw
from jointwave.compare.misfit.pairs import meaning, measure
from jointwave.compare.misfit.ranking import applicable, kind_of, own_exact
from jointwave.compare.solvers.record import Kind
from tests.field_cases.scenes import mass

E, RHO, NU = 5.0e7, 1890.0, 0.3


@pytest.fixture
def column(tmp_path, in_toml):
    """Return the column in a scene of one material; joints carry half its compliance."""
    rock = {"density": RHO, "equivalent_modulus": E, "equivalent_poisson": NU}
    tables = {
        "title": "Column",
        "pillar": {"length": 10.0, "side": 0.5, "block": 0.1},
        "rock": rock | {"intact_modulus": 2 * E, "intact_poisson": 0.2},
        "motion": {"rotation": "none"},
        "load": {"amplitude": 1.0, "shape": "table", "file": "rise.csv"},
        "ends": {"end": "fixed"},
        "time": {"duration": 0.045},
        "record": {"stress": [5.0], "velocity": [5.0], "interval": 1e-4},
    }
    (tmp_path / "rise.csv").write_text("time,stress\n0,0\n0.0025,1000\n1,1000\n")
    (tmp_path / "column.toml").write_text(in_toml(tables))
    return tmp_path / "column.toml"


VISCOUS = {"joints.damping_ratio": 0.05, "ends.end": "matched"}


@pytest.mark.parametrize("rock", ["equivalent", "jointed"])
@pytest.mark.parametrize(
    ("dim", "changes"),
    [(1, {}), (2, {}), (3, {}), (1, VISCOUS), pytest.param(3, VISCOUS, marks=pytest.mark.slow)],
)
def test_the_rock_of_a_pillar_is_the_exact_bar_in_every_dimension(column, rock, dim, changes):
    """Homogenised and with every joint within 0.1 % of the exact bar, whose own error is below.
    At the speeds of a plate and of confined rock the same misfit is 31 and 65 %."""
    scene = jw.load(column, changes={"numerics.continuum.dim": dim, **changes})
    found = jw.simulate(scene, f"continuum-{rock}")
    assert jw.misfit(found, jw.simulate(scene, f"{rock}-bar")) < 1e-3


@pytest.mark.parametrize("stress", [0.0, 1e6])
def test_explain_prints_the_speeds_of_a_rock_mass(jointwave, tmp_path, in_toml, stress):
    """lambda = mu = 1 GPa, rho = 1000: sqrt(3) and 1 km/s between the joints. Two orthogonal sets
    of K_n = 2, K_s = 1 GPa/m, 1 m apart: 1.08012 and 0.57735 km/s along x and y (Schoenberg and
    Sayers 1995). Rigid blocks have no Poisson effect: 1 / C_11 = 1/3 + 1/2 gives sqrt(1.2) =
    1.09545 km/s, and both sets slip, 1 / C_66 = 1 + 1 + 1. The same joints, of 0.5 GPa/m when open,
    are closed by K d_m: they are (1 + 1)^2 times as stiff."""
    law = {"spacing": 1.0, "normal_stiffness": 2e9, "shear_stiffness": 1e9}
    if stress:
        law |= {"normal_stiffness": 5e8, "maximum_closure": stress / 5e8}
    tables = mass(
        *(4.0, 4.0),
        prestress={"xx": stress, "yy": stress},
        rock={"density": 1000.0, "intact_modulus": 2.5e9, "intact_poisson": 0.25},
        joint_sets=[law | {"name": str(dip), "dip": dip} for dip in (0.0, 90.0)],
        time={"duration": 0.1},
        record={"points": [[2.0, 2.0]]},
    )
    (path := tmp_path / "mass.toml").write_text(in_toml(tables))
    found = json.loads(jointwave("explain", path, "--json").out)["speeds"]
    rock = found["continuum-jointed"]
    assert rock["intact rock"] == pytest.approx([1e3 * 3**0.5, 1e3], rel=1e-9)
    for axis in ("x", "y"):
        name = f"long waves along {axis}"
        assert rock[name] == pytest.approx([1080.12, 577.35], abs=0.01)
        assert found["dem"][name] == pytest.approx([1095.45, 577.35], abs=0.01)


@pytest.mark.parametrize(
    ("dim", "own", "kind"), [(1, "equivalent-bar", Kind.NUMERICAL), (2, None, Kind.MODELLING)]
)
def test_a_bar_is_no_measure_of_the_own_error_of_rock_that_widens(column, dim, own, kind):
    """Rock in two dimensions has lateral inertia where it turns, which a bar leaves out."""
    changes = {"numerics.continuum.dim": dim, "motion.rotation": "small"}
    scene = jw.load(column, changes=changes)
    there = [name for name, answer in applicable(scene).items() if answer]
    engine, bar = "continuum-equivalent", "equivalent-bar"
    assert (own_exact(engine, there, scene) is None) == (own is None)
    assert kind_of(engine, bar, scene) is kind
    wave = jw.simulate(scene, bar)
    rows = measure({engine: wave, bar: wave}, scene=scene)
    assert {row.pair.kind for row in rows} == {kind.words}
    assert meaning(rows[0].pair).startswith("another model; ") == (kind is Kind.MODELLING)
