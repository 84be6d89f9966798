"""Harmonic transmission through linear joints: one, and several in parallel.

Amplitudes are those of a Ricker pulse at its peak frequency, of which the exact incident wave is
known. Per wavelength there are 20 quadratic elements, whose phase error per wavelength, below
(k h)^4 / 1440 = 7e-6, and a step of a 300th of the period, (omega dt)^2 / 24 = 2e-5, leave far less
than the bounds.
"""

import numpy as np
import pytest

from closed_forms import one_joint, parallel_joints
from jointwave import continuum
from jointwave.cases.loads import load_history
from jointwave.compare.misfit.metrics import relative_l2

RHO, E, NU = 2400.0, 9.6e9, 0.25

KAPPA = {0.25: 0.4472, 0.5: 0.7071, 1.0: 0.8944, 2.0: 0.9701, 5.0: 0.9950}
PARALLEL = {
    2: (0.7822, 0.8890, 0.9864),
    3: (0.7927, 0.9995, 0.9138),
    5: (0.9963, 0.8840, 0.9468),
}


@pytest.mark.parametrize("kappa, passes", KAPPA.items())
def test_one_joint(bar, soft_joint, amplitude, kappa, passes):
    """|T| and |R| of Schoenberg (1980) within 0.1 %."""
    scene = bar(soft_layers=[soft_joint(20.0, kappa)])
    result = continuum.simulate(scene, "equivalent", dim=1)
    times = result.time.values
    front, behind = result.stress.values
    incident = load_history(scene).value(times - 10.0 / 2000.0) / 2
    whole = amplitude(times, incident)
    T, R = amplitude(times, behind) / whole, amplitude(times, front - incident) / whole
    exact = np.abs(one_joint.coefficients(1.0, kappa, 1.0))
    assert exact[0] == pytest.approx(passes, abs=5e-5)
    assert pytest.approx(exact, rel=1e-3) == (T, R)


@pytest.mark.parametrize("dim, wave", [(2, "P"), (2, "S"), (3, "P"), (3, "S")])
def test_plane_sections_and_one_joint(bar, soft_joint, amplitude, dim, wave):
    """d'Alembert's wave at the speed of the bar, or of shear, within 0.2 % (shear waves have 12.6
    elements a wavelength), and |T|, |R| of a joint of kappa = 0.5 within 0.1 %.

    A pillar of 120 m between free ends: up to 160 m / c none of their reflections is at
    the receivers. A joint's K_s is K_n / (2 (1 + nu)) as E and G of the rock are.
    """
    speed = np.sqrt((E if wave == "P" else E / (2 * (1 + NU))) / RHO)
    scene = bar(
        pillar__length=120.0,
        motion__rotation="none",
        load__direction=[0.0, 1.0, 0.0] if wave == "P" else [1.0, 0.0, 0.0],
        soft_layers=[soft_joint(60.0, 0.5, RHO * speed * (1 if wave == "P" else 2 * (1 + NU)))],
        ends={"start": "free", "end": "free"},
        time__duration=160.0 / speed,
        record__stress=[20.0, 50.0, 70.0],
    )
    result = continuum.simulate(scene, "equivalent", dim=dim)
    times, load = result.time.values, load_history(scene)
    stress = result.stress.values if wave == "P" else result.shear.values[:, :, 0]
    arrived = times < 95.0 / speed
    there = load.value(times - 20.0 / speed)
    assert relative_l2(stress[0][arrived], there[arrived]) < 2e-3
    incident = load.value(times - 50.0 / speed)
    whole = amplitude(times, incident)
    T, R = amplitude(times, stress[2]) / whole, amplitude(times, stress[1] - incident) / whole
    assert pytest.approx((0.5**0.5, 0.5**0.5), rel=1e-3) == (T, R)


@pytest.mark.parametrize("count", PARALLEL)
@pytest.mark.parametrize("i, spacing", enumerate((0.05, 0.1, 0.2)))
def test_parallel_joints(bar, soft_joint, amplitude, count, i, spacing):
    """|T| at kappa = 1 by transfer matrices (Cai & Zhao, 2000) within 0.1 %."""
    places = 20.0 + 20.0 * spacing * np.arange(count)
    scene = bar(
        soft_layers=[soft_joint(y, 1.0) for y in places],
        time__duration=0.4,
        record__stress=[50.0],
    )
    result = continuum.simulate(scene, "equivalent", dim=1)
    times = result.time.values
    incident = load_history(scene).value(times - 10.0 / 2000.0) / 2
    T = amplitude(times, result.stress.values[0]) / amplitude(times, incident)
    exact = parallel_joints.transmission(count, 1.0, spacing)
    assert exact == pytest.approx(PARALLEL[count][i], abs=5e-5)
    assert pytest.approx(exact, rel=1e-3) == T
