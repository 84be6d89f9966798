"""The picture of transfer, dispersion and loss along a row of receivers."""

from dataclasses import replace

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.figures.charts.propagation import curves_of, propagation

Y = np.linspace(5.25, 20.25, 16).tolist()  # centres of blocks
THEORY = "rigid blocks, theory"


@pytest.fixture(scope="module")
def comparison(compared):
    """Return a damped pillar struck at its free start, until the wave is back from its end."""
    scene = load_tables(
        {
            "title": "a row",
            "pillar": {"length": 60.0, "side": 0.5, "block": 0.5},
            "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
            "joints": {"damping_ratio": 0.02},
            "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
            "time": {"duration": 0.048},
            "record": {"velocity": Y, "interval": 5e-5},
        }
    )
    return compared(scene)[0]


def test_a_damped_chain_is_its_theory(comparison):
    """Phase speed and 1/Q of rigid blocks."""
    curves = curves_of(comparison)
    for solution in ("dem", "lattice"):
        speed, theory = (curves[name]["phase speed (m/s)"] for name in (solution, THEORY))
        assert len(speed) > 10
        np.testing.assert_allclose(speed, theory[speed.index], rtol=2e-3)
        loss = curves[solution]["1/Q"]
        heard = loss.index[(loss.index > 50) & (loss.index < 200)]
        np.testing.assert_allclose(loss[heard], curves[THEORY]["1/Q"][heard], rtol=0.03)


def test_the_transfer_function_is_what_the_loss_leaves(comparison):
    """|H| = exp(-a x), a = omega / (2 c Q), c by all receivers and not by two: some 1e-4."""
    curves, way = curves_of(comparison)["dem"], Y[-1] - Y[0]
    speed, loss = curves["phase speed (m/s)"], curves["1/Q"]
    omega = 2 * np.pi * speed.index.values
    left = np.exp(-omega * way / (2 * speed) * loss[speed.index])
    np.testing.assert_allclose(curves["transfer function"][speed.index], left, rtol=2e-3)


def test_a_picture_needs_a_row(comparison):
    (found,) = propagation("row", [comparison])
    assert found.name == "row-propagation"
    assert {"dem", "lattice", THEORY} <= {c.split(" | ")[0] for c in found.table.columns[1:]}
    two = {k: x.isel(velocity_y=slice(0, 2)) for k, x in comparison.results.items()}
    assert propagation("row", [replace(comparison, results=two)]) == []
