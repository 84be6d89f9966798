"""Pillars against what leapfrog itself is, to round-off, and what ends give back."""

import numpy as np
import pytest

from closed_forms.leapfrog import modes_of_blocks
from closed_forms.modes import of_modes
from jointwave import dem
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks.pillar import bodies, drive_vector, own_freedoms
from jointwave.compare.exact.blocks.system import relative


def at_centres(p):
    """Return the centres of all blocks, m."""
    return (p.spacing * (np.arange(p.block_count) + 0.5)).tolist()


TWO_TILES = {"pillar__length": 50.0, "time__duration": 0.05}
TWIST = {"shape": "sine", "amplitude": 1e6, "period": 0.01, "direction": [0, 1, 0], "arm": 0.1}
UNTURNED = {"motion__rotation": "none", "load__at": [0.0, 0.0]}
SLENDER = {"pillar__length": 64.5, "pillar__side": 0.2, "load__at": [0.05, 0.0]}
#: The fixture, its changes, and the step over the block's travel time.
BLOWS = {
    "chain": ("pillar", {}, 0.05),
    "chain near the critical step": ("pillar", {"time__duration": 2.3}, 0.99),
    "shear of blocks that do not turn": ("row", UNTURNED | TWO_TILES, 0.02),
    "torsion": ("row", {"load": TWIST} | TWO_TILES, 0.02),
    "oblique blow, fixed end": ("row", {"ends__end": "fixed"} | TWO_TILES, 0.02),
    "slender, one block in the third tile": ("row", SLENDER | {"time__duration": 0.04}, 0.02),
}


def closed_form(scene, dt, steps):
    """Return displacements and rotations [freedoms, N] of leapfrog after steps of dt (s)."""
    stress, (mass, contacts) = step_means(load_history(scene), dt, np.arange(steps)), bodies(scene)
    count, c = scene.block_count, mass.shape[1]
    drive = drive_vector(scene)[own_freedoms(scene)]
    place = relative(contacts, *mass.shape)[:c, : count * c].T @ drive
    modes = modes_of_blocks(mass, contacts)
    return of_modes(modes, place, stress, np.array([steps]), dt).reshape(count, c).T


@pytest.mark.parametrize(("fixture", "changes", "fraction"), BLOWS.values(), ids=BLOWS)
def test_closed_form_after_thousands_of_steps(fixture, changes, fraction, request):
    """sin(Omega dt / 2) = omega dt / 2 of every mode. Round-off grows with the steps, not with the
    error: below 1e-10 of the largest, and where nothing moves, up to round-off of the modes, of
    what turns at the face's edge."""
    make = request.getfixturevalue(fixture)
    record = {"velocity": at_centres(calibrate(make(**changes))), "interval": 0.02 / 5}
    scene = make(**changes, record=record, numerics__dem__step_fraction=fraction)
    result = dem.simulate(scene)
    assert result.attrs["steps"] >= 5000
    kinds = [kind for kind in ("displacement", "rotation") if kind in result]
    moved = np.concatenate([result[kind].values[:, -1].T for kind in kinds])
    expected = closed_form(scene, result.attrs["dt"], result.attrs["steps"])
    arm = scene.pillar.side / 2
    size = np.abs(expected[:3]).max() + arm * np.abs(expected[3:]).max(initial=0.0)
    off = np.abs(moved - expected)
    assert off[:3].max() <= 1e-10 * size
    assert off[3:].max(initial=0.0) <= 1e-10 * size / arm


RAMP, STEADY = 40, 60  # periods: a slow start excites nothing near the cut-off of the chain


def reflection(result, period, wavenumber):
    """Return |R|: two opposite waves fitted to the last periods' Fourier component."""
    time, y = result.time.values, result.velocity_y.values
    last = time > time[-1] - 10 * period + 1e-12
    component = result.velocity.values[:, last, 0] @ np.exp(-2j * np.pi * time[last] / period)
    waves = np.exp(np.outer(y, [-1j * wavenumber, 1j * wavenumber]))
    incident, reflected = np.linalg.lstsq(waves, component, rcond=None)[0]
    return float(abs(reflected / incident))


@pytest.mark.parametrize("end, power", [("quiet", 1), ("matched", 2)])
def test_reflection_of_an_absorbing_end(pillar, tmp_path, end, power):
    """tan(kh/4) for a dashpot on a whole block, tan^2(kh/4) where matched, within 1 %: 15.8 and
    2.5 % at ten blocks a wavelength; kh is the lattice's own."""
    p, kh = calibrate(pillar()), 2 * np.pi / 10
    period = np.pi * p.spacing / (p.bar_speed * np.sin(kh / 2))
    t = np.arange(0, (RAMP + STEADY) * period, period / 200)
    ramp = np.sin(np.pi / 2 * np.clip(t / (RAMP * period), 0, 1)) ** 2
    sine = 1e6 * ramp * np.sin(2 * np.pi * t / period)
    np.savetxt(tmp_path / "sine.csv", np.c_[t, sine], delimiter=",")
    y = (p.spacing * (np.arange(60, 90) + 0.5)).tolist()
    scene = pillar(
        load={"shape": "table", "amplitude": 1.0, "file": str(tmp_path / "sine.csv")},
        ends={"start": "matched", "end": end},
        time__duration=(RAMP + STEADY) * period,
        record={"velocity": y, "interval": period / 40},
        numerics__dem__step_fraction=0.02,
    )
    found = reflection(dem.simulate(scene), period, kh / p.spacing)
    assert found == pytest.approx(np.tan(kh / 4) ** power, rel=0.01)
