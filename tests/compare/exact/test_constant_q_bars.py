"""Bars of a constant quality factor: what receivers see, and what four mechanisms leave out."""

from dataclasses import replace

import numpy as np
import pytest

from closed_forms.constant_q import ConstantQ
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import solve
from jointwave.compare.exact.bar import laplace
from jointwave.compare.exact.bar.bars import bar_of
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.readings.attenuation import quality_factor


def bar(pillar, length, quality, **tables):
    """Return a pillar without joints, of a quality factor, with a quiet end."""
    rock = {"y": [0.0, length], "joints": False, "intact_modulus": 4.375e9}
    own = {"pillar__length": length, "segments": [rock], "rock__quality_factor": quality}
    return pillar(**own, ends__end="quiet", soft_layers=[], **tables)


@pytest.mark.parametrize("quality", [10.0, 20.0, 50.0, 100.0])
def test_receivers_see_the_quality_factor_in_the_whole_band(pillar, quality):
    """Within 3 % over the two decades of the band, between receivers on a bar without joints, by a
    pulse with all of these frequencies: 2.5 % are the four mechanisms', 0.2 % the records'. These
    hold the wave's tail, two periods of 10 Hz, and forty samples a period of 1000 Hz: a tail cut
    off at 0.08 s is 5 % at 12 Hz, aliasing at ten samples 10 % at 1000 Hz and Q = 100.
    Waves lose exp(-omega x / (2 Q c)) of their amplitude."""
    scene = bar(
        pillar,
        150.0,
        quality,
        rock__intact_modulus=8.64e10,
        rock__reference_frequency=100.0,
        load={"shape": "triangle", "amplitude": 1e6, "rise": 2e-4, "decay": 2e-4},
        record={"stress": [2.0, 10.0], "velocity": [2.25, 10.25], "interval": 2.5e-5},
        time__duration=0.2,
    )
    result = solve("jointed-bar", scene)
    band = quality_factor(result, quantity="stress").sel(frequency=slice(10.0, 1000.0))
    assert len(band.frequency) > 190
    assert float(np.abs(band.quality / quality - 1).max()) < 0.03
    theory = ConstantQ(quality, 100.0).attenuation(band.frequency, calibrate(scene).bar_speed)
    assert np.allclose(band.attenuation, theory, rtol=0.06)


@pytest.mark.parametrize(("quality", "bound"), [(10.0, 2e-2), (20.0, 1e-2), (100.0, 2e-3)])
def test_four_mechanisms_stand_for_a_constant_quality_factor(pillar, quality, bound):
    """The pulse against that of Kjartansson's rock: a modelling error, of the fit."""
    scene = bar(
        pillar,
        10.0,
        quality,
        load={"shape": "ricker", "amplitude": 1e6, "period": 4e-3},
        record={"stress": [3.0, 7.0], "velocity": [5.25], "interval": 1e-4},
        time__duration=0.02,
    )
    rock, times = bar_of(scene, resolved=True), np.arange(0, 0.02, 1e-4)

    def stress(relaxation):
        asked = load_history(scene), times, [7.0], [5.25], 4e-3
        rocks = tuple(one._replace(relaxation=relaxation) for one in rock.rocks)
        return laplace.bounded(replace(rock, rocks=rocks), *asked)[0][0][0]

    ideal = stress(ConstantQ(quality, 250.0))
    assert relative_l2(stress(rock.rocks[0].relaxation), ideal) < bound
    assert relative_l2(stress(None), ideal) > 10 * bound
