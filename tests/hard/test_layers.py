"""Joints of almost no stiffness or compliance, chains of any contrast, joints about to open."""

from math import sqrt

import numpy as np
import pytest

from closed_forms.modes import modes, of_modes
from hard_runs import BLOCKS, EPS, JOINT, JOINTED, REFEREE, ROUND_OFF, SCHEMES, HardRun, marked
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.sampling import interpolation
from jointwave.compare.exact.bar import bars
from jointwave.compare.misfit.metrics import relative_l2

#: Rigid rock, so that blocks move by their joints alone.
RIGID = {"rock.intact_modulus": 1e29, "time.duration": 0.02, "step": 0.9}
STIFF_JOINTS = 4.5e9  # Pa, of the intact rock: little above the rock mass's 4.375e9
FINE = {"step": 0.02, "load.shape": "sine", "load.cycles": 10, "time.duration": 0.01}
CUT_OFF = 1.1636e-3  # s, pi d / c: the shortest period that the blocks transmit


def contrast(c):
    """Return the changes that make every second joint so many times as stiff."""
    layers = [{"y": 0.5 + i, "normal_stiffness": c * JOINT} for i in range(10)]
    return RIGID | {"soft_layers": layers}


@pytest.mark.parametrize(("engine", "scheme"), marked(SCHEMES))
@pytest.mark.parametrize(
    "layer",
    [
        {"normal_stiffness": 1e-12 * JOINT},
        {"normal_stiffness": 1e-30},
        {"normal_stiffness": 8.7482e4, "thickness": 0.05},
    ],
    ids=["1e-12 of a joint", "1e-30 Pa/m", "meshed, a millionth of the rock"],
)
def test_pillar_ends_free_in_front_of_a_layer_of_almost_no_stiffness(layer, engine, scheme):
    """The layer passes K times its gap. A face moves no further than twice the incident velocity
    takes it, so K gap <= K 2 p t / Z, which leaks at each of the n passes along the pillar. A layer
    of thickness and of impedance Z_2 also takes up a wave of 2 Z_2 / Z of the stress, and replaces
    a joint, whose compliance the homogenised rock beside it loses: joints have little of it here.
    The other pillar is the same solver's, of half the length; at another step it may differ by the
    phase error, at the same by round-off."""
    rock = {"rock.intact_modulus": STIFF_JOINTS} if "thickness" in layer else {}
    run = HardRun(engine, scheme, {"soft_layers": [{"y": 5.0} | layer]} | rock)
    in_front = {"record__stress": [2.5], "record__velocity": []}
    short = run.run(pillar__length=5.0, soft_layers=[], **in_front)
    run.result = whole = run.run(**in_front)
    p, stiffness = run.properties, layer["normal_stiffness"]
    leak = stiffness * 2 * run.duration / p.impedance
    leak += 2 * sqrt(stiffness * layer.get("thickness", 0.0) * p.density) / p.impedance
    same = whole.attrs["dt"] == short.attrs["dt"]
    steps = 1e-15 * run.steps if same else run.phase_error()
    passes = p.bar_speed * run.duration / 5.0
    found = relative_l2(whole["stress"].values, short["stress"].values)
    assert found <= passes * leak + 2 * steps


@pytest.mark.parametrize(
    ("scheme", "times"), [("explicit", 1e5), ("implicit", 1e5), ("implicit", 1e12)]
)
def test_joint_of_almost_no_compliance_leaves_whole_rock(scheme, times):
    """It lets a wave of frequency omega pass with 1 / |T| - 1 < (Z omega / 2 K)^2 / 2 and a delay
    of Z omega / 2 K, once a pass. The exact bar has a joint of K = 1e30 Pa/m there."""
    layer = {"y": 5.0, "normal_stiffness": times * JOINT}
    changes = {"soft_layers": [layer]} | ({"step": 0.9} if scheme == "explicit" else {})
    run = HardRun("continuum-jointed", scheme, changes)
    exact = bars.JOINTED.run(run.read(soft_layers=[layer | {"normal_stiffness": 1e30}]))
    p = run.properties
    delay = p.impedance * 2 * run.peak / (2 * layer["normal_stiffness"])
    passes = p.bar_speed * run.duration / run.scene.pillar.length
    found = relative_l2(run.result["stress"].values, exact["stress"].values)
    assert found <= passes * delay + run.phase_error() + run.element_error() + REFEREE


@pytest.mark.parametrize(("engine", "scheme"), BLOCKS)
@pytest.mark.parametrize(
    "changes",
    [
        *map(contrast, (1e-8, 1e-4, 1e4, 1e8)),
        *({"load.period": t} | FINE for t in (CUT_OFF, CUT_OFF / 2)),
    ],
    ids=["1e-8", "1e-4", "1e4", "1e8", "at the cut-off", "twice the cut-off"],
)
def test_chain_moves_as_leapfrog_in_closed_form(changes, engine, scheme):
    """Leapfrog to round-off, an eps each step; the fourth-order scheme, beside leapfrog at its own
    four forces a step, to the phase error of that."""
    run = HardRun(engine, scheme, changes)
    bound = ROUND_OFF * run.steps if scheme == "leapfrog" else run.phase_error()
    assert off_chain(run) <= bound


def off_chain(run):
    """Return the misfit of the displacements of an undamped chain of free ends from leapfrog on its
    modes in closed form, at a step for each evaluation of the forces."""
    about, p = run.result.attrs, run.properties
    dt = float(about["dt"] * about["steps"] / about["force_evaluations"])
    mass = np.full(p.block_count, p.block_mass)
    root = np.sqrt(p.stiffness * p.area)[:, None] * np.diff(np.eye(p.block_count), axis=0)
    steps = np.rint(run.result["time"].values / dt).astype(int)
    force = p.area * step_means(load_history(run.scene), dt, np.arange(int(steps[-1]) + 1))
    u = of_modes(modes(mass, root), np.eye(p.block_count)[0], force, steps, dt)
    centres = p.spacing * (np.arange(p.block_count) + 0.5)
    left, right, weight = interpolation(centres, run.scene.record.velocity)
    exact = (1 - weight[:, None]) * u[left] + weight[:, None] * u[right]
    return relative_l2(run.result["displacement"].values[..., 0], exact)


#: Few steps of blocks, which are plain Python: little else has their kernels.
LOOSE = {"joints.tension": False, "time.duration": 0.03}
SLOW = [("continuum-jointed", "explicit"), ("continuum-jointed", "implicit")]
EVERY = [one for one in JOINTED if one[1] != "fourth-order"]  # force evaluation has a sample


@pytest.mark.parametrize(("engine", "scheme"), marked(EVERY, SLOW))
def test_prestress_of_just_the_largest_tension_leaves_every_joint_closed(engine, scheme, request):
    """The elastic pillar under the same prestress, p, gives that tension; there the traction of
    tension-free joints is zero, to round-off, and they behave like elastic ones."""
    if engine == "dem":
        request.getfixturevalue("plain")
    run = HardRun(engine, scheme, LOOSE)
    dt = 0.5 * run.critical
    clock = {"step": 0.5, "record__interval": dt, "record__velocity": []}
    clock["record__stress"] = run.properties.joint_y.tolist()
    free = run.run(**clock, joints__tension=True, prestress__normal=0.0)
    p = -float(free["stress"].values.min())
    bound, loose = (
        run.run(**clock, joints__tension=tension, prestress__normal=p)["stress"].values
        for tension in (True, False)
    )
    assert relative_l2(loose, bound) <= 10 * EPS * float(free.attrs["steps"])


@pytest.mark.parametrize(("engine", "scheme"), marked(JOINTED, SLOW[1:]))
def test_gaps_of_1e_40_m_open_and_close_like_large_ones(engine, scheme, request):
    """Tension-free joints have no scale: a load smaller by a power of two gives the same digits."""
    if engine == "dem":
        request.getfixturevalue("plain")
    run, small = HardRun(engine, scheme, LOOSE), 2.0**-99
    one, other = (run.run(load__amplitude=a)["stress"].values for a in (1.0, small))
    assert np.array_equal(other / small, one)
