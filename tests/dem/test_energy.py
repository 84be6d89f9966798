"""The energy ledger closes: nothing appears, nothing is lost."""

import pytest

import dem
from cases.result import energy_residual


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"ends__end": "quiet"},
        {"ends__end": "matched", "ends__start": "matched"},
        {"ends__end": "fixed"},
        {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}]},
        {"joints__damping_ratio": 0.3},
        {"numerics__dem__step_fraction": 0.9},
    ],
    ids=["free", "quiet", "matched", "fixed", "soft layer", "dashpots", "large step"],
)
def test_linear_scenes_close_to_round_off(pillar, changes):
    """Below 1e-10 of the work, in the form of the energy that leapfrog conserves at any step."""
    assert energy_residual(dem.simulate(pillar(**changes))) < 1e-10


@pytest.mark.parametrize("ratio", [None, 0.02])
def test_no_tension_closes_to_second_order(pillar, ratio):
    """A joint opens between two steps, which costs (k / 2) gap^2 of at most one step's gap."""
    changes = {} if ratio is None else {"joints__damping_ratio": ratio}
    residual = [
        energy_residual(
            dem.simulate(
                pillar(joints__tension=False, numerics__dem__step_fraction=fraction, **changes)
            )
        )
        for fraction in (0.1, 0.05)
    ]
    assert residual[1] < 1e-3
    assert residual[1] < residual[0]


def test_dashpots_take_what_the_wave_loses(pillar):
    """The viscous term grows to what kinetic and elastic energy have lost of the work."""
    energy = dem.simulate(pillar(joints__damping_ratio=0.1)).energy
    last = energy.isel(time=-1)
    lost = last.sel(term="work") - last.sel(term="kinetic") - last.sel(term="elastic")
    assert float(last.sel(term="viscous")) == pytest.approx(float(lost), rel=1e-9)
    assert float(last.sel(term="viscous")) > 0.5 * float(last.sel(term="work"))
