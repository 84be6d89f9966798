"""The first steps of two deformable blocks, worked out by hand.

Cubes of 1 m and 1000 kg, one linear element long: half of the mass at each node, E A / h = 5e6 N/m
intact and 2.5e6 N/m as rock mass, and between them joints of K_n A = 5e6 N/m. A step load of 1000 N
and steps of 0.01 s, of which the first sees half the load.
"""

import numpy as np

from jointwave import continuum
from jointwave.cases.schema.scene import Scene


def run(model, **tables):
    """Return the result of one model of the bar, in steps of 0.01 s."""
    own = {
        "title": "by hand",
        "pillar": {"length": 2.0, "side": 1.0, "block": 1.0},
        "rock": {
            "density": 1000.0,
            "equivalent_modulus": 2.5e6,
            "equivalent_poisson": 0.25,
            "intact_modulus": 5e6,
        },
        "load": {"shape": "step", "amplitude": 1000.0},
        "time": {"duration": 0.02},
        "record": {"stress": [0.0, 2.0], "velocity": [0.0, 0.5, 1.0, 1.5, 2.0], "interval": 0.01},
        "numerics": {
            "continuum": {
                "order": 1,
                "elements_per_block": 1,
                "scheme": "explicit",
                "step_fraction": 0.95,
            }
        },
    }
    result = continuum.simulate(Scene.model_validate(own | tables), model, dim=1)
    assert result.attrs["dt"] == 0.01
    return result


def holds(values, expected):
    """Hold an array to numbers, at round-off."""
    np.testing.assert_allclose(values, expected, rtol=1e-11, atol=1e-15)


def at(variable, *places):
    """Return the component along the pillar at places (m), [place, sample]."""
    return variable.sel(axis="y", velocity_y=list(places)).values


def test_homogenised_bar():
    """Nodes of 500, 1000, 500 kg: v0 = 10, 25 mm/s; 250 N in the first element sets the second node
    to 2.5 mm/s, then 812.5 N and none yet beyond it to 10 mm/s."""
    result = run("equivalent")
    holds(at(result.displacement, 0.0, 1.0, 2.0), [[0, 1e-4, 3.5e-4], [0, 0, 2.5e-5], [0, 0, 0]])
    first = [0.005, 0.0175, (0.025 + 0.025 + 2e-5 * 187.5) / 2]
    second = [0, 1.25e-3, (2.5e-3 + 2.5e-3 + 1e-5 * (812.5 - 62.5)) / 2]
    holds(at(result.velocity, 0.0, 1.0), [first, second])
    holds(result.stress.sel(stress_y=0.0)[1:], [1000, 1000])


def test_jointed_bar():
    """A row of four masses of 500 kg and three springs of 5e6 N/m, the joint between the second and
    the third: v = 20, 10, 0 mm/s, then 1000 and 500 N: 20, 20, 10 mm/s."""
    result = run("jointed")
    holds(at(result.displacement, 0.0, 2.0), [[0, 1e-4, 3e-4], [0, 0, 0]])
    holds(at(result.displacement, 0.5), [[0, 5e-5, 2e-4]])
    holds(
        at(result.velocity, 0.0, 0.5, 2.0), [[5e-3, 1.5e-2, 0.02], [2.5e-3, 1e-2, 1.75e-2], [0] * 3]
    )
    holds(at(result.velocity, 1.5), [[0, 0, 2.5e-3]])


def test_ledger_of_the_jointed_bar():
    """m v v' / 2 of four nodes, f g / 2 of element and joint, the load's work by the mean force."""
    energy = run("jointed").energy
    kinetic = [0, 250 * 0.01 * 0.02, 250 * (0.02 * 0.02 + 0.01 * 0.02)]
    elastic = [0, 500 * 1e-4 / 2, 1000 * 2e-4 / 2 + 500 * 1e-4 / 2]
    work = [0, 7.5 * 0.01, 7.5 * 0.01 + 10 * 0.02]
    holds(energy.sel(term="kinetic"), kinetic)
    holds(energy.sel(term="elastic"), elastic)
    holds(energy.sel(term="work"), work)


def test_quiet_start():
    """A dashpot of 5e4 N s/m on 500 kg: v' = (v / 2 + 2e-5 F) / 1.5, 1/150 and 1/90 m/s."""
    result = run("jointed", ends={"start": "quiet"})
    holds(at(result.velocity, 0.0)[:, :2], [[1 / 300, (1 / 150 + 1 / 90) / 2]])
    holds(at(result.displacement, 0.0), [[0, 1 / 15000, 1 / 15000 + 1 / 9000]])
