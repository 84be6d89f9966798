"""A joint that slips in deformable rock, under a harmonic shear wave."""

import numpy as np
import pytest

from closed_forms.one_joint import slip_coefficients
from jointwave import cases, continuum
from jointwave.cases.loads import load_history
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.scenes import SHIPPED

SCENE = SHIPPED / "beyond" / "slip-three-cohesions.toml"
PERIOD, INTERVAL = 0.04, 1e-4
#: One period of the four that are at the joint from 0.03125 to 0.19125 s.
CYCLE = slice(1501, 1901)
SHARES = {
    0.5: (0.6253, 0.4159, 0.6603),
    0.1: (0.1384, 0.8746, 0.4647),
    0.02: (0.0282, 0.9746, 0.2221),
}


def simulate(strength):
    """Return the scene, the shear stress at the joint (Pa) and the work of friction (J)."""
    changes = {
        "soft_layers": [{"y": 25.0, "cohesion": strength, "friction_angle": 0.0}],
        "record.stress": [25.0],
        "record.interval": INTERVAL,
        "variants": [],
        "expect": {},
    }
    scene = cases.load_variant(SCENE, "", changes)
    result = continuum.simulate(scene, "equivalent", dim=1)
    return scene, result.shear.values[0, :, 0], result.energy.sel(term="friction").values


@pytest.fixture(scope="module")
def holds():
    """The scene, the stress and the work of friction at a joint that holds."""
    return simulate(1e9)


def test_the_wave_is_dalemberts_where_the_joint_holds(holds):
    """At the shear speed. The joint, ten ordinary ones stiff, delays it by Z/2K = 1.6e-5 s, which
    is 0.25 % of it."""
    scene, shear, friction = holds
    times = INTERVAL * np.arange(shear.size)
    exact = load_history(scene).value(times - 25.0 / 800.0) / 2
    assert relative_l2(shear, exact) < 3e-3
    assert (friction == 0).all()


@pytest.mark.parametrize("a", SHARES)
def test_harmonic_wave(holds, a):
    """T, R and A of Miller (1978) within 0.2 %: 128 quadratic elements and more a wavelength, 25 of
    the fifth harmonic.

    The reflected wave is what slip changes at the joint; A^2 is the share of the incident energy
    that friction takes in a cycle.
    """
    incident = holds[1]
    _, shear, friction = simulate(a * 1e5)
    whole = np.mean(incident[CYCLE] ** 2)
    T = np.sqrt(np.mean(shear[CYCLE] ** 2) / whole)
    R = np.sqrt(np.mean((shear - incident)[CYCLE] ** 2) / whole)
    z, area = 2400.0 * 800.0, 0.25
    taken = friction[CYCLE.stop - 1] - friction[CYCLE.start - 1]
    A = np.sqrt(taken / (whole * PERIOD * area / z))
    exact = slip_coefficients(a)
    assert exact == pytest.approx(SHARES[a], abs=1e-4)
    assert pytest.approx(exact, rel=2e-3) == (T, R, A)
    assert np.abs(shear).max() <= a * 1e5 * (1 + 1e-9)
