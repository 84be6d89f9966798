"""The critical step is sharp: bounded just below it, growing without limit just above; and where a
few small cells would shorten it, their mass is bounded, told, and without a force of its own."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from jointwave.cases.errors import UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import simulate
from jointwave.continuum.plan import plan_of
from jointwave.continuum.problem import problem_of
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.stepping.critical import critical_step
from jointwave.continuum.stepping.scaling import OF_ALL, OF_PIECE, scaled_mass

DAMPED = {"joints__damping_ratio": 0.05}
SOFT = {"y": 2.0, "spacing_stiffness": 4.375e8}
LAYER = {"soft_layers": [SOFT | {"damping_ratio": 0.1}]}
#: 0.1 % of what the ends take; a layer so that the kernel is that of others.
BARELY = {"joints__damping_ratio": 1e-4, "soft_layers": [SOFT | {"damping_ratio": 1e-4}]}
ABSORBS = {"ends__start": "quiet", "ends__end": "matched"}
#: Model, dimension, keys and numerics; four blocks of a bar, two in the plane and in space.
KINDS = {
    "undamped": ("jointed", 1, {}, {}),
    "quiet": ("jointed", 1, {"ends__start": "quiet", "ends__end": "quiet"}, {}),
    "matched": ("jointed", 1, BARELY | {"ends__start": "matched", "ends__end": "matched"}, {}),
    "damped, soft layer, absorbing": ("jointed", 1, DAMPED | LAYER | ABSORBS, {}),
    "linear": ("jointed", 1, DAMPED, {"order": 1}),
    "quartic": ("jointed", 1, DAMPED, {"order": 4}),
    "homogenised": ("equivalent", 1, {"ends__end": "fixed"}, {}),
    "homogenised, damped, soft layer": ("equivalent", 1, DAMPED | LAYER, {}),
    "plane": ("jointed", 2, {}, {}),
    "plane, cubic": ("jointed", 2, DAMPED, {"order": 3}),
    "plane, triangles": ("jointed", 2, DAMPED, {"cell": "simplex"}),
    "plane, absorbing": ("jointed", 2, DAMPED | ABSORBS, {}),
    "space, two across": ("jointed", 3, DAMPED, {"order": 1, "elements_across": 2}),
    "space, tetrahedra": ("jointed", 3, DAMPED, {"order": 1, "cell": "simplex"}),
    "plane wave in space": ("jointed", 3, {"motion__rotation": "none"} | DAMPED, {}),
}
STEPS, EVERY = 50_000, 250


def stepped(short, model, dim, changes, fraction):
    """Return the result of 50,000 steps of a fraction of the critical step, which is within 1e-4 of
    the true one, from below."""
    record = {"stress": [1.0], "velocity": [0.3], "interval": 5e-5}
    probe = short(**changes, record=record, time__duration=1e-4)
    dt = fraction * plan_of(probe, model, dim=dim).critical
    forced = {"step_fraction": fraction, "allow_unstable": True}
    forced = {f"numerics__continuum__{key}": value for key, value in forced.items()}
    record |= {"interval": EVERY * dt}
    scene = short(**changes, **forced, record=record, time__duration=STEPS * dt)
    result = simulate(scene, model, dim=dim)
    assert result.attrs["dt"] == pytest.approx(dt, rel=1e-9)
    return result


@pytest.mark.parametrize("kind", KINDS)
def test_critical_step_is_sharp(short, kind):
    """Nothing grows at 0.999 of it, and 0.1 % above the run is lost."""
    model, dim, keys, numerics = KINDS[kind]
    case = {f"numerics__continuum__{key}": value for key, value in numerics.items()} | keys
    case |= {"load__amplitude": 1.0, "pillar__length": 4.0 if dim == 1 else 1.0}
    v = np.abs(stepped(short, model, dim, case, 0.999).velocity.values)
    half = v.shape[1] // 2
    assert v.any() and v[:, half:].max() < 2 * v[:, :half].max()
    with pytest.raises(UnstableError):
        stepped(short, model, dim, case, 1.001)


@pytest.mark.parametrize(
    "joints",
    [{"friction_angle": 20.0, "cohesion": 1e4}, {"tension": False}],
    ids=["slip", "no tension"],
)
def test_slip_and_opening_do_not_lower_it(joints, short):
    """At 0.999 of the critical step of joints that hold, energy is the work but for a tenth."""
    load = {"shape": "sine", "amplitude": 1e5, "period": 1e-3, "direction": [0.6, 0.8, 0.0]}
    changes = {"load": load, "joints": joints, "numerics__continuum__step_fraction": 0.999}
    dt = 0.999 * plan_of(short(**changes), dim=2).critical
    changes |= {"record": {"interval": dt}, "time__duration": 4000 * dt}
    result = simulate(short(**changes), dim=2)
    assert result.attrs["steps"] == 4000
    energy = result.energy
    held = energy.sel(term="kinetic") + energy.sel(term="elastic")
    assert held.max() < 1.1 * energy.sel(term="work").max()


def test_uniform_lumped_linear_bar_is_critical_when_a_wave_crosses_one_element(pillar):
    scene = pillar(numerics__continuum__order=1, numerics__continuum__elements_per_block=1)
    p = calibrate(scene)
    critical = plan_of(scene, "equivalent").critical
    assert critical == pytest.approx(p.spacing / p.bar_speed, rel=1e-4)
    assert critical <= p.spacing / p.bar_speed * (1 + 1e-12)


def of_matrices(stiffness, viscosity=0.0, given=()):
    """Return the critical step of masses of 1 kg on springs and dashpots, s; given : freedoms whose
    motion is."""
    matrices = csr_matrix(stiffness), csr_matrix(viscosity + 0.0 * stiffness)
    return critical_step(np.ones(len(stiffness)), *matrices, np.array(given, int))


@pytest.mark.parametrize(
    ("springs", "dashpots", "given", "dt"),
    [
        ([9.0], [0.0], (), 2 / 3),
        ([9.0], [2.0], (), 2 * (np.sqrt(13) - 2) / 9),
        ([9.0, 1.0], [0.0, 4.0], (), np.sqrt(68) - 8),
        ([9.0, 1.0], [0.0, 0.0], [0], 2.0),
    ],
    ids=["spring", "dashpot", "dashpots decide", "motion is given"],
)
def test_critical_step_of_single_freedoms(springs, dashpots, given, dt):
    """omega = 3: 2/3 s. With a dashpot of C / M = 2: 9 dt^2 + 8 dt = 4. The stiffest is bounded by
    2/3 s, the most damped one, 1 + 16 dt = 4 / dt, by less. What is given bounds nothing."""
    found = of_matrices(np.diag(springs), np.diag(dashpots), given)
    assert found == pytest.approx(dt, rel=1e-12)


def test_critical_step_of_modes_that_dashpots_turn():
    """The largest eigenvalue of dt^2 K + 4 dt C is 4, of no mode of either alone; to the square of
    the change of 1e-6 at which the search ends."""
    springs, dashpots = np.random.default_rng(4).standard_normal((2, 6, 6))
    k, c = springs @ springs.T, 0.2 * dashpots @ dashpots.T
    dt = of_matrices(k, c)
    largest = np.linalg.eigvalsh(dt**2 * k + 4 * dt * c)[-1]
    assert largest == pytest.approx(4.0, rel=1e-10)


SHORT = 1e-3  # m, of an edge on top of a block between two joints
WEDGE = [{"dip": dip, "through": [3.0 + np.sign(dip) * SHORT / 2, 4.0]} for dip in (-80.0, 80.0)]
RAYLEIGH = {"rayleigh": {"frequencies": [200.0, 800.0], "ratios": [0.02, 0.02]}}


@pytest.mark.parametrize("damping", [{}, RAYLEIGH])
def test_the_step_of_a_short_edge_is_longer_by_little_mass(rock_mass, damping):
    scene = rock_mass(*WEDGE, continuum={"size": 0.8}, damping=damping)
    found = body_of(scene)
    problem, body, block = problem_of(scene, found), found.body, blocks_of_nodes(found.body)
    scaled = scaled_mass(problem)
    added = scaled.mass - body.mass
    assert added.min() == 0 and scaled.nodes == np.count_nonzero(added) / 2 < 10
    assert scaled.share == pytest.approx(added.sum() / body.mass.sum()) and scaled.share <= OF_ALL
    of_block = np.bincount(block, added[::2]) / np.bincount(block, body.mass[::2])
    assert of_block.max() <= OF_PIECE
    before, after = (
        problem._replace(body=body._replace(mass=mass)).critical_step()
        for mass in (body.mass, scaled.mass)
    )
    assert before <= scaled.before and after > 3 * before


def test_a_regular_mesh_has_its_own_mass(rock_mass):
    scene = rock_mass({"dip": 30.0, "through": [3.0, 2.0]})
    assert scaled_mass(problem_of(scene, body_of(scene))) is None


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_rock_at_rest_under_its_weight_stays_at_rest(rock_mass, caplog, scheme):
    """Added mass has its weight; implicit steps have none."""
    scene = rock_mass(
        *WEDGE,
        continuum={"size": 0.8, "scheme": scheme, "steps_per_period": 50},
        gravity={"direction": [0.0, -1.0]},
        boundaries={"bottom": "fixed", "left": "roller", "right": "roller"},
        time={"duration": 1e-4},
    )
    result = simulate(scene)
    assert ("have more mass" in caplog.text) == (scheme == "explicit")
    assert np.abs(result["velocity"]).max() < 1e-9
