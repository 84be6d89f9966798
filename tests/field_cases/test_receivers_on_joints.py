"""Receivers exactly on a joint (exact solutions were 73 % from the continuum there), and forces.

Velocity, displacement and the stress along a joint jump across it: every solver reads the mean of
both sides, within 1e-9 of the rock's size, and a warning says so. Traction does not jump. A force
acts as a receiver at its place reads."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.cases.warnings import warnings
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import relative_l2
from tests.field_cases.scenes import ENGINES, JOINT, mass, wave

DIP = 30.0
NORMAL = np.array([-np.sin(np.radians(DIP)), np.cos(np.radians(DIP))])
#: Distances from the joint, m: on it, by what a file rounds, and on either side of it.
AWAY = [0.0, -3e-9, 3e-9, -1e-6, 1e-6]

PILLAR = {
    "title": "a soft joint in a pillar",
    "pillar": {"length": 50.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10},
    "soft_layers": [{"y": 25.0, "spacing_stiffness": 1e8}],
    "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.02},
    "ends": {"start": "quiet", "end": "quiet"},
    "time": {"duration": 0.05},
    "record": {"velocity": [25.0, 24.75, 25.25]},
}


def of_mass(points, sets, **tables):
    """Return a rock mass with a P wave that travels upwards."""
    own = {
        "joint_sets": [JOINT | one for one in sets],
        "waves": [wave(period=0.01)],
        "time": {"duration": 0.02},
        "record": {"points": points},
    }
    return load_tables(mass(24.0, 24.0, **own | tables))


@pytest.fixture(scope="module")
def tilted():
    points = [(np.array([12.0, 12.0]) + away * NORMAL).tolist() for away in AWAY]
    one = {"dip": DIP, "through": [12.0, 12.0]}
    return of_mass(points, [one], numerics={"dem": {"block": 1.0}})


@pytest.fixture(scope="module")
def exact(tilted):
    return solve("oblique-joint", tilted)


def test_the_exact_solution_reads_the_mean_of_both_sides(exact):
    """Both sides differ; on the joint is their mean, to a wavelength's share of the distance."""
    for name in ("velocity", "displacement", "stress"):
        at, below, above, behind, front = exact[name].values
        size = np.abs(at).max()
        np.testing.assert_allclose(below, at, atol=1e-12 * size)
        np.testing.assert_allclose(above, at, atol=1e-12 * size)
        np.testing.assert_allclose(at, (behind + front) / 2, atol=1e-6 * size)
        assert np.abs(front - behind).max() > 0.05 * size


@pytest.mark.parametrize(("name", "far"), [("continuum-jointed", 0.01), ("dem", 0.12)])
def test_both_engines_read_the_same_on_a_joint_and_off_it_by_rounding(tilted, exact, name, far):
    """Rigid blocks of 1 m, with 40 of them a wavelength of P, have no Poisson effect along x."""
    found = solve(name, tilted)
    for quantity in ("velocity", "displacement"):
        one = found[quantity].values
        for rounded in (1, 2):
            np.testing.assert_allclose(one[rounded], one[0], atol=1e-6 * np.abs(one).max())
        assert relative_l2(one[0, :, 1], exact[quantity].values[0, :, 1]) < far


def test_rigid_blocks_and_their_exact_lattice_read_the_same_on_a_joint():
    """Where two sets cross, too: of the four blocks there."""
    sets = [{"name": f"{dip:g}", "dip": dip, "spacing": 2.0} for dip in (0.0, 90.0)]
    scene = of_mass([[11.0, 12.0], [12.0, 12.0]], sets)
    found, exact = (solve(name, scene).velocity.values for name in ("dem", "block-lattice"))
    np.testing.assert_allclose(found, exact, atol=2e-3 * np.abs(exact).max())


def test_a_point_on_a_joint_is_warned_of(tilted):
    said = [line for line in warnings(tilted) if "lies on a joint" in line]
    assert [line.split()[0] for line in said] == [f"record.points[{k}]" for k in range(3)]
    assert "joint_sets[0]" in said[0] and "mean of both sides" in said[0]


def test_a_point_on_a_side_lies_on_no_joint_and_map_coordinates_are_no_lengths():
    """Planes of a set fall on the sides of a slope in the coordinates of a map."""
    x, y = 512345.0, 4512345.0
    sets = [JOINT | {"name": f"{dip:g}", "dip": dip, "through": [x, y]} for dip in (0.0, 90.0)]
    scene = load_tables(
        mass(
            *(12.0, 12.0),
            domain={"outline": [[x, y], [x + 12, y], [x + 12, y + 12], [x, y + 12]]},
            joint_sets=[one | {"spacing": 2.0} for one in sets],
            loads=[wave("force", quantity="force") | {"at": [x + 5, y]}],
            time={"duration": 0.02},
            record={"points": [[x, y + 5], [x + 5, y + 12], [x + 5, y + 4]]},
        )
    )
    (said,) = (line for line in warnings(scene) if "lies on a joint" in line or "domain" in line)
    assert said.startswith("record.points[2]")


def forced(at, direction, point, **tables):
    """Return rock under a force, with all that reflects waves, as far as tables leave it."""
    joints = [{"dip": 33.0, "spacing": 5.0, "through": [1.0, 1.0]}, {"name": "other", "dip": -57.0}]
    load = wave("force", direction, quantity="force") | {"at": at}
    own = {
        "joint_sets": [JOINT | {"through": [17.0, 9.0]} | one for one in joints],
        "regions": [{"name": "top", "dip": -12.0, "through": [12.0, 15.0], "intact_modulus": 2e10}],
        "boundaries": {"left": "quiet", "right": "fixed", "bottom": "roller"},
        "loads": [load],
        "time": {"duration": 0.02},
        "record": {"points": [point]},
        "numerics": {"dem": {"block": 1.5}, "continuum": {"size": 2.0}},
    }
    return load_tables(mass(24.0, 20.0, **own | tables))


@pytest.mark.parametrize("engine", ENGINES)
def test_what_a_force_does_elsewhere_a_force_there_does_here(engine):
    """Betti and Rayleigh's reciprocity, to round-off."""
    one, other = ([5.3, 4.1], [0.6, 0.8]), ([18.7, 13.3], [0.28, -0.96])
    there, here = (
        solve(engine, forced(*a, b[0])).velocity.values[0] @ b[1]
        for a, b in ((one, other), (other, one))
    )
    np.testing.assert_allclose(there, here, atol=1e-11 * np.abs(here).max())


@pytest.mark.parametrize("engine", ENGINES)
def test_a_force_on_a_joint_acts_on_both_sides_alike(engine):
    """Hardly off the joint it acts on one side, and does up to 0.6 of the peak there more."""

    def scene(away):
        at, joint = [11.7, 12.0 + away], JOINT | {"dip": 0.0, "through": [12.0, 12.0]}
        return forced(at, [0.6, 0.8], [12.0, 17.0], joint_sets=[joint], regions=[])

    on, above, below = (solve(engine, scene(x)).velocity.values for x in (0.0, 1e-6, -1e-6))
    size = np.abs(on).max()
    np.testing.assert_allclose(on, (above + below) / 2, atol=1e-5 * size)
    assert np.abs(above - below).max() > 0.3 * size
    (line,) = (line for line in warnings(scene(0.0)) if "lies on a joint" in line)
    assert line.startswith("loads[0].at = [11.7, 12]") and "equal parts of the force" in line


def test_a_pillar_reads_the_mean_of_both_sides_of_a_soft_layer():
    """Both engines, and the exact solutions of either model, within 1 % of the jointed bar."""
    scene = load_tables(PILLAR)
    found = {
        name: solve(name, scene).velocity.values
        for name in ("dem", "lattice", "continuum-jointed", "jointed-bar")
    }
    bar = found["jointed-bar"].reshape(3, -1)
    sides = solve("jointed-bar", _at(scene, [25.0 - 1e-6, 25.0 + 1e-6])).velocity.values
    np.testing.assert_allclose(bar[0], sides.mean(axis=0).ravel(), atol=1e-5 * np.abs(bar).max())
    for values in found.values():
        assert relative_l2(values.reshape(3, -1)[0], bar[0]) < 0.01
    assert any("lies on a soft layer" in line for line in warnings(scene))
    near = warnings(_at(scene, [25.1, 25.25]))  # within half a block they interpolate across it
    said = [line.split(" m ")[0] for line in near if "half a block" in line]
    assert said == ["record.velocity = 25.1"]


@pytest.mark.parametrize("engine", ENGINES)
def test_the_nearest_joint_is_read_though_nodes_of_another_are_nearer(engine):
    """Beds 0.45 m below, with nodes at x = 4 and 6 m, and a joint 0.8 m to the left, with one at
    y = 4.5 m; at the crossing it is the first set."""
    tables = mass(
        *(8.0, 8.0),
        joint_sets=[
            JOINT | {"name": "bed", "dip": 0.0, "spacing": 1.0},
            JOINT | {"name": "cross", "dip": 90.0, "through": [4.0, 4.0]},
        ],
        prestress={"xx": 4e6, "yy": 6e6, "xy": 7e5},
        time={"duration": 1e-4},
        numerics={"continuum": {"size": 4.0}},
        record={"joints": [[4.8, 4.45], [4.0, 4.0]]},
    )
    found = solve(engine, load_tables(tables)).traction[:, 0]
    assert found.values == pytest.approx(np.array([[6e6, -7e5]] * 2), rel=1e-7)


def _at(scene, places):
    record = scene.record.model_copy(update={"velocity": places})
    return scene.model_copy(update={"record": record})
