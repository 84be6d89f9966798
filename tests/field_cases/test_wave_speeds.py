"""Which wave speed has a pillar? A column, 10 m, E 50 MPa, nu 0.3, density 1890 kg/m3, fixed base,
step of 1 kPa on top that rises in 2.5 ms (Kratos Multiphysics, pull request 12047).

A bar with free sides has sqrt(E / rho) = 162.65 m/s, a plate in plane stress between fixed sides
170.50, confined rock 188.71. The sides of a pillar are free, and E is the modulus that rigid blocks
get (Guo & Li 2002, eq. 4 to 6), so that all engines are the bar, in every dimension.
"""

import json

import numpy as np
import pytest

import jointwave as jw

E, RHO, NU = 5.0e7, 1890.0, 0.3
BAR, SHEAR = np.sqrt(E / RHO), np.sqrt(E / (2 * (1 + NU)) / RHO)
RISE, STRESS, MIDDLE = 0.0025, 1000.0, 5.0  # s, Pa, m


@pytest.fixture(scope="module")
def column(tmp_path_factory):
    """Return the column in a scene of one material; joints carry half its compliance."""
    folder = tmp_path_factory.mktemp("column")
    (folder / "rise.csv").write_text(f"time,stress\n0,0\n{RISE},{STRESS}\n1,{STRESS}\n")
    (folder / "column.toml").write_text(f"""
title = "Column"
[pillar]
length = 10.0
side = 0.5
block = 0.1
[rock]
density = {RHO}
equivalent_modulus = {E}
equivalent_poisson = {NU}
intact_modulus = {2 * E}
intact_poisson = 0.2
[motion]
rotation = "none"
[load]
amplitude = 1.0
shape = "table"
file = "rise.csv"
[ends]
end = "fixed"
[time]
duration = 0.045
[record]
stress = [{MIDDLE}]
velocity = [{MIDDLE}]
interval = 1e-4
""")
    return folder / "column.toml"


VISCOUS = {"joints.damping_ratio": 0.05, "ends.end": "matched"}


@pytest.mark.parametrize("changes", [{}, VISCOUS], ids=["elastic", "viscous"])
@pytest.mark.parametrize("rock", ["equivalent", "jointed"])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_the_rock_of_a_pillar_is_the_exact_bar_in_every_dimension(column, rock, dim, changes):
    """Homogenised and with every joint within 0.1 % of the exact bar, whose own error is below.
    At the speeds of a plate and of confined rock the same misfit is 31 and 65 %."""
    scene = jw.load(column, changes={"numerics.continuum.dim": dim, **changes})
    found = jw.simulate(scene, f"continuum-{rock}")
    assert jw.misfit(found, jw.simulate(scene, f"{rock}-bar")) < 1e-3


def middle_speed(scene, solver, direction, speed):
    """Return the mean particle velocity at mid-height behind the front, before the base's
    reflection, m/s."""
    found = jw.simulate(scene, solver)
    time, arrival = found.time.values, MIDDLE / speed
    behind = (time > arrival + 2 * RISE) & (time < 2 * arrival)
    v = found.velocity.values[0, behind]
    return float(v[:, 0 if v.shape[1] == 1 or direction[0] else 1].mean())


@pytest.mark.parametrize(
    ("direction", "speed"),
    [((0.0, 1.0, 0.0), BAR), ((1.0, 0.0, 0.0), SHEAR)],
    ids=["along", "across"],
)
@pytest.mark.parametrize("solver", ["dem", "continuum-equivalent", "continuum-jointed"])
def test_particle_velocity_is_the_stress_over_the_impedance(column, solver, direction, speed):
    """p / (rho c) = 3.253 mm/s along the pillar and 5.246 mm/s across, within 1 %: the last half
    block and joint before the free face are the rest, 0.1 of 10 m."""
    changes = {"load.direction": list(direction), "time.duration": 2 * MIDDLE / speed}
    for dim in (1, 3) if "continuum" in solver else (None,):
        own = {"numerics.continuum.dim": dim} if dim else {}
        scene = jw.load(column, changes=changes | own)
        found = middle_speed(scene, solver, direction, speed)
        assert found == pytest.approx(STRESS / (RHO * speed), rel=0.01)


def explained(jointwave, path):
    """Return what `explain` prints of a scene."""
    return json.loads(jointwave("explain", path, "--json").out)


def test_explain_prints_the_speeds_of_a_pillar(jointwave, column):
    """The bar of E_eq and its shear; between joints the bar of intact rock, of twice that E."""
    (found,) = explained(jointwave, column)["segments"]
    assert [found["bar_speed"], found["shear_speed"]] == pytest.approx([BAR, SHEAR], rel=1e-12)
    assert found["intact_bar_speed"] == pytest.approx(np.sqrt(2 * E / RHO), rel=1e-12)


ROCK_MASS = """
title = "Two sets"
[domain]
size = [4.0, 4.0]
[rock]
density = 1000.0
intact_modulus = 2.5e9
intact_poisson = 0.25
[[joint_sets]]
name = "flat"
dip = 0.0
spacing = 1.0
normal_stiffness = 2.0e9
shear_stiffness = 1.0e9
[[joint_sets]]
name = "steep"
dip = 90.0
spacing = 1.0
normal_stiffness = 2.0e9
shear_stiffness = 1.0e9
[time]
duration = 0.1
[record]
points = [[2.0, 2.0]]
"""


def test_explain_prints_the_speeds_of_a_rock_mass(jointwave, tmp_path):
    """lambda = mu = 1 GPa, rho = 1000: sqrt(3) and 1 km/s between the joints. Two orthogonal sets
    of K_n = 2, K_s = 1 GPa/m, 1 m apart: 1.08012 and 0.57735 km/s along x and y (Schoenberg and
    Sayers 1995). Rigid blocks have no Poisson effect: 1 / C_11 = 1/3 + 1/2 gives sqrt(1.2) =
    1.09545 km/s, and both sets slip, 1 / C_66 = 1 + 1 + 1."""
    (tmp_path / "mass.toml").write_text(ROCK_MASS)
    found = explained(jointwave, tmp_path / "mass.toml")["speeds"]
    rock = found["continuum-jointed"]
    assert rock["intact rock"] == pytest.approx([1e3 * 3**0.5, 1e3], rel=1e-9)
    for axis in ("x", "y"):
        name = f"long waves along {axis}"
        assert rock[name] == pytest.approx([1080.12, 577.35], abs=0.01)
        assert found["dem"][name] == pytest.approx([1095.45, 577.35], abs=0.01)
