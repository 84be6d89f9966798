"""Methods that a user would write instead: correct if applicable, else refused."""

import pytest

from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit, relative_l2
from jointwave.compare.studies.measure import measure
from jointwave.compare.studies.methods import adaptive, plain_dolfinx

RICKER = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}


@pytest.fixture
def bar(pillar):
    """Return a function that gives the paper's pillar for a while, with cubic elements."""

    def scene(**changes):
        common = {
            "load": RICKER,
            "time__duration": 0.06,
            "record__interval": 5e-4,
            "record__stress": [0.0, 7.3, 20.0, 50.0],
            "record__velocity": [0.0, 12.3, 50.0],
            "record__energy": False,
            "numerics__continuum__order": 3,
            "numerics__continuum__elements_per_block": 1,
            "numerics__continuum__step_fraction": 0.2,
        }
        return pillar(**(common | changes))

    return scene


@pytest.mark.parametrize(
    ("changes", "bound"),
    [
        ({}, 1e-3),
        ({"ends__start": "matched", "ends__end": "quiet"}, 1e-3),
        ({"ends__end": "fixed", "joints__damping_ratio": 0.05}, 3e-3),
    ],
)
def test_plain_dolfinx_is_the_homogenised_bar(bar, changes, bound):
    """Within a thousandth: steps dt of 2e-5 s shift the wave's phase by omega T (omega dt)^2 / 24,
    2e-4 after T = 0.06 s, and the slope of cubic elements errs by some (omega h / c)^3 / 100, 1e-4.
    Dashpots lag by half a step, (omega eta) (omega dt) / 2 of a hundred joints."""
    scene = bar(**changes)
    found, exact = plain_dolfinx.solve(scene), solve("equivalent-bar", scene)
    assert misfit(found, exact) < bound
    for name in ("velocity", "displacement"):
        assert relative_l2(found[name].values, exact[name].values) < bound
    assert found.attrs["steps"] * found.attrs["dt"] == pytest.approx(0.06)
    assert found.attrs["dt"] <= 0.2 * found.attrs["critical_dt"]
    assert found.attrs["degrees_of_freedom"] == 3 * 100 + 1


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_plain_dolfinx_runs_away_just_above_its_critical_step(bar, damping):
    """Stable at 0.99 of it, not at 1.05, where the shortest wave grows by some per cent a step."""
    peaks = []
    for fraction in (0.99, 1.05):
        keys = {
            "numerics__continuum__step_fraction": fraction,
            "numerics__continuum__allow_unstable": True,
            "joints__damping_ratio": damping,
            "record__interval": 1e-6,
            "time__duration": 0.01,
        }
        probe = plain_dolfinx._bar(bar(**keys)).critical
        keys["record__interval"] = fraction * probe
        peaks.append(float(abs(plain_dolfinx.solve(bar(**keys)).stress).max()))
    assert peaks[0] < 2e6 < 1e3 * 2e6 < peaks[1]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}]}, "soft layer"),
        ({"joints__tension": False}, "carries no tension"),
        ({"load": RICKER | {"direction": [0.0, 0.6, 0.8]}}, "spatial"),
        ({"numerics__continuum__scheme": "implicit"}, "explicit"),
        ({"numerics__continuum__dim": 2}, "solves a bar"),
        (
            {
                "numerics__continuum__order": 2,
                "numerics__continuum__mass": "consistent",
                "numerics__continuum__cell": "simplex",
            },
            "explicit",
        ),
    ],
)
def test_plain_dolfinx_says_what_it_does_not_do(bar, changes, words):
    answer = plain_dolfinx.applies(bar(**changes))
    assert not answer and words in answer.reason


def test_the_adaptive_chain_does_not_move_across_the_axis(bar):
    assert adaptive.applies(bar())
    assert not adaptive.applies(bar(load=RICKER | {"direction": [0.0, 0.6, 0.8]}))


def test_a_method_that_does_not_apply_is_a_failed_point_with_the_reason(study):
    curve = {
        "label": "loop",
        "method": "plain-dolfinx",
        "changes": {"numerics.continuum.dim": 3},
    }
    (point,) = study([curve]).points()
    row = measure(point)
    assert row.state == "failed" and "plain-dolfinx does not apply: it solves a bar" in row.message
    assert "\n" not in row.message


@pytest.mark.parametrize("damping", [{}, {"joints__damping_ratio": 0.05}])
def test_adaptive_steps_reach_the_exact_chain_as_their_tolerance_shrinks(pillar, damping):
    """Some digits for every digit of the tolerance."""
    scene = pillar(load=RICKER, time__duration=0.03, **damping)
    exact = solve("lattice", scene)
    coarse, fine = (misfit(adaptive.solve(scene, rtol), exact) for rtol in (1e-4, 1e-8))
    assert coarse < 1e-2 and fine < 1e-5 and fine < 1e-2 * coarse
