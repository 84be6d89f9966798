"""Relaxation mechanisms of rock: their quality factor, moduli, dispersion and series with joints.

The fit is asked for 4 % of Q (`SPACING`); per cent of what follows from it are derived there."""

import numpy as np
import pytest

from closed_forms.constant_q import ConstantQ
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import fitted, mechanisms_of


def band(decades: float, points: int = 2000) -> np.ndarray:
    """Return frequencies of a band whose middle is at 100 Hz, Hz."""
    return 100 * np.logspace(-decades / 2, decades / 2, points)


def of_band(quality: float, decades: float):
    """Return the mechanisms of a quality factor in such a band."""
    f = band(decades)
    return fitted(quality, 100.0, f[0], f[-1])


def roots(memory, x: float, dt: float) -> np.ndarray:
    """Return z of the motions that go as z^n in leapfrog on a mode with (omega_u dt)^2 = x:

    z - 2 + 1/z + x (relaxed + sum_l share_l gain_l (z - 1) / (dt (z - decay_l))) = 0,

    as the eigenvalues of what a step makes of u, v dt and e_l."""
    size = memory.share.size
    force = np.concatenate([[memory.relaxed, 0.0], memory.share])
    step = np.zeros((size + 2, size + 2))
    step[1] = -x * force
    step[1, 1] += 1.0
    step[0] = step[1]
    step[0, 0] += 1.0
    step[2:] = (memory.gain / dt)[:, None] * step[1]
    step[2:, 2:] += np.diag(memory.decay)
    return np.linalg.eigvals(step)


@pytest.mark.parametrize("decades", [0.4, 1.0, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("quality", [5.0, 10.0, 20.0, 50.0, 100.0, 500.0, 1e4])
def test_quality_factor_is_constant_in_the_band(quality, decades):
    found = of_band(quality, decades)
    modulus = found.modulus(2j * np.pi * band(decades))
    assert np.abs(modulus.real / modulus.imag / quality - 1).max() < 0.04
    assert 0 < found.relaxed < 1 < found.unrelaxed and found.share.min() > 0
    assert len(found.share) <= 6


def test_two_decades_take_four_mechanisms():
    found = of_band(20.0, 2.0)
    assert len(found.share) == 4
    assert found.modulus(np.array(0.0)) == pytest.approx(found.unrelaxed * found.relaxed, rel=1e-14)
    assert found.modulus(np.array(1e20)) == pytest.approx(found.unrelaxed, rel=1e-12)


@pytest.mark.parametrize("quality", [10.0, 50.0, 500.0])
def test_phase_speed_is_that_of_the_modulus_at_the_reference_frequency(quality):
    found = of_band(quality, 2.0)
    slowness = 1 / np.sqrt(found.modulus(np.array(200j * np.pi)))
    assert slowness.real == pytest.approx(1.0, rel=1e-13)


@pytest.mark.parametrize("quality", [10.0, 20.0, 100.0, 500.0])
def test_dispersion_is_that_of_constant_q(quality):
    """By Kramers and Kronig the speed at f differs from that at f0 as 1/Q does between and beyond:
    d ln c = d ln f / (pi Q) (Kolsky, 1956; Futterman, 1962), and Kjartansson's power of f. What
    the fit does not hold beyond the band is felt within: the speeds differ by up to a fifth of the
    dispersion of half a band, ln 10 / (pi Q), and by less than a twentieth in its middle decade."""
    found, ideal, f = of_band(quality, 2.0), ConstantQ(quality, 100.0), band(2.0)
    speed = 1 / (1 / np.sqrt(found.modulus(2j * np.pi * f))).real
    log = np.log(speed / ideal.phase_speed(f)) / (np.log(10) / (np.pi * quality))
    assert np.abs(log).max() < 0.2
    assert np.abs(log[(f > 10**1.5) & (f < 10**2.5)]).max() < 0.05
    assert (np.diff(speed) > 0).all()
    assert ideal.gamma * np.pi * quality == pytest.approx(1, abs=0.34 / quality**2)


@pytest.mark.parametrize("zeta", [None, 0.0, 1e-3, 0.1])
def test_homogenised_rock_is_intact_rock_in_series_with_its_joints(pillar, zeta):
    """1/E_eq(s) = 1/E(s) + 1/(S K_n (1 + s eta)) at any s, to round-off."""
    scene = pillar(rock__quality_factor=20.0, joints__damping_ratio=zeta)
    p, rng = calibrate(scene), np.random.default_rng(1)
    s = 10 ** rng.uniform(0, 6, 50) * np.exp(1j * rng.uniform(-np.pi / 2, np.pi / 2, 50))
    rock, mass = (mechanisms_of(scene, model) for model in ("jointed", "equivalent"))
    joints = p.spacing * p.regular_own_stiffness * (1 + s * (p.time_constant or 0.0))
    compliance = 1 / (p.intact_modulus * rock.modulus(s)) + 1 / joints
    assert np.allclose(p.modulus * mass.modulus(s) * compliance, 1, rtol=1e-10)
    assert mass.share.min() > 0 and mass.frequency.min() > 0 and mass.relaxed > 0


STEP = {"load": {"shape": "step", "amplitude": 1e5}}
RAYLEIGH = {"damping__rayleigh": {"frequencies": [10.0, 100.0], "ratios": [0.01, 0.01]}}


@pytest.mark.parametrize(
    ("changes", "key", "message"),
    [
        ({"quality_band": [1.0, 100.0]}, "quality_band", "no meaning without"),
        ({"reference_frequency": 50.0}, "reference_frequency", "no meaning without"),
        ({"quality_factor": 4.0}, "quality_factor", "at least 5"),
        ({"quality_factor": 20.0, "quality_band": [90.0, 110.0]}, "quality_band", "2 to 10,000"),
        ({"quality_factor": 20.0, "quality_band": [1.0, 50.0]}, "quality_band", "the refer"),
        ({"quality_factor": 20.0, "reference_frequency": 1e-3}, "quality_band", "must be given: 0"),
        ({"quality_factor": 20.0, "intact_modulus": None}, "quality_factor", "needs rock.intact"),
        (STEP | {"quality_factor": 20.0}, "reference_frequency", "no load or wave has a period"),
        (RAYLEIGH | {"quality_factor": 20.0}, "quality_factor", "already damps the rock"),
    ],
)
def test_what_makes_no_rock_is_refused_in_one_line(pillar, changes, key, message):
    others = {name: value for name, value in changes.items() if name in STEP | RAYLEIGH}
    rock = {f"rock__{name}": value for name, value in changes.items() if name not in others}
    with pytest.raises(SceneError, match=message) as error:
        pillar(**others, **rock)
    assert f"rock.{key}" in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("load", "reference", "band"),
    [(STEP, 100.0, (10.0, 1000.0)), ({}, None, (10.0, 1000.0)), ({}, 1.0, (0.1, 1000.0))],
)
def test_the_band_is_a_decade_on_either_side_of_load_and_reference(pillar, load, reference, band):
    rock = {"rock__quality_factor": 20.0, "rock__reference_frequency": reference}
    scene = pillar(**load, **rock)
    assert scene.rock.quality_frequencies(scene.pulses) == (reference or 100.0, *band)
