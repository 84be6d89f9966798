"""Readings of velocities against closed forms: their table, and the picture along a row."""

import json
from dataclasses import replace

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.cli.compare import show_comparisons
from jointwave.compare.figures.charts.propagation import curves_of, propagation
from jointwave.compare.figures.tables import READINGS, reading_frame
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place

LONG = {"pillar__length": 60.0}
BAR = LONG | {
    "rock": {"density": 2000.0, "equivalent_modulus": 2e9, "equivalent_poisson": 0.25},
    "time__duration": 0.06,
    "record": {"velocity": [10.0, 30.0]},
}
Y = np.linspace(5.25, 20.25, 16).tolist()  # centres of blocks
#: A damped pillar struck at its free start, until the wave is back from its end.
ROW = LONG | {
    "joints__damping_ratio": 0.02,
    "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
    "time__duration": 0.048,
    "record": {"velocity": Y, "interval": 5e-5},
}
THEORY = "rigid blocks, theory"


@pytest.fixture(scope="module")
def bar(compared, pillar):
    return compared(pillar(**BAR), by=("images",))[0]


@pytest.fixture(scope="module")
def row(compared, pillar):
    return compared(pillar(**ROW))[0]


def test_a_sine_has_the_numbers_of_its_closed_forms(bar):
    """v = p0 / (rho c), and (v omega)^2 T / 2 of squared acceleration."""
    frame = reading_frame([bar])
    assert list(frame["at"]) == ["10 m", "30 m"]
    last, acceleration = frame.iloc[1], 0.5 * 200 * np.pi
    assert last["peak velocity (m/s)"] == pytest.approx(0.5, rel=1e-4)
    squared = acceleration**2 * 0.01 / 2
    assert last["Arias intensity (m/s)"] == pytest.approx(np.pi / 19.62 * squared, rel=2e-4)
    assert last["speed (m/s)"] == pytest.approx(1000.0, rel=1e-5)
    assert acceleration < last["spectral acceleration (m/s2)"] < 4 * acceleration


def test_curves_of_others_stand_below_the_solutions(bar):
    """A measured velocity, unevenly sampled, has its own row; a stress has none."""
    time = np.array([0.0, 0.01, 0.02, 0.025, 0.03])
    places = [Place("velocity", "y", (10.0,)), Place("stress", "", (10.0,))]
    curves = Curves("gauge.csv", "gauge.csv", time, dict.fromkeys(places, np.sin(100 * time)))
    beside = align_curve(curves, bar.scene, bar.results, align=False)
    frame = reading_frame([replace(bar, besides=[beside])])
    assert list(frame["solution"]) == ["images", "images", "gauge.csv"]
    assert frame["peak velocity (m/s)"].iloc[2] == pytest.approx(np.sin(2.0))


def test_the_table_is_printed_and_is_in_the_json(bar, capsys):
    show_comparisons([bar], False, False, reads=True)
    said = capsys.readouterr().out
    last = " ".join(said.splitlines()[-1].split())
    assert last.startswith("base scene homogenised bar, images 30 m 0.5 ")
    assert all(name in said for name in READINGS)
    show_comparisons([bar], False, True, reads=True)
    (facts,) = json.loads(capsys.readouterr().out)
    assert [row["at"] for row in facts["readings"]] == ["10 m", "30 m"]
    assert facts["readings"][0]["speed (m/s)"] is None


def test_nothing_is_read_where_no_velocity_is_recorded(bar, capsys):
    silent = {name: result.isel(velocity_y=[]) for name, result in bar.results.items()}
    nothing = replace(bar, results=silent)
    assert reading_frame([nothing]).empty
    show_comparisons([nothing], False, False, reads=True)
    said = "no velocities are recorded: record.velocity or record.points is empty"
    assert said in capsys.readouterr().out


def test_a_damped_chain_is_its_theory(row):
    """Phase speed and 1/Q of rigid blocks; in the table 1/Q = omega eta at the loudest frequency of
    a wavelet, which the record, of steps of 21 Hz, has at 104 Hz, not 100, and the loss on the way
    moves a little."""
    expected = 1 / (2 * np.pi * 100 * calibrate(row.scene).time_constant)
    found = reading_frame([row]).set_index("solution").loc["lattice", "apparent Q"]
    assert found.iloc[-1] == pytest.approx(expected, rel=0.15)
    curves = curves_of(row)
    for solution in ("dem", "lattice"):
        speed, theory = (curves[name]["phase speed (m/s)"] for name in (solution, THEORY))
        assert len(speed) > 10
        np.testing.assert_allclose(speed, theory[speed.index], rtol=2e-3)
        loss = curves[solution]["1/Q"]
        heard = loss.index[(loss.index > 50) & (loss.index < 200)]
        np.testing.assert_allclose(loss[heard], curves[THEORY]["1/Q"][heard], rtol=0.03)


def test_a_picture_needs_a_row(row):
    (found,) = propagation("row", [row])
    assert found.name == "row-propagation"
    assert {"dem", "lattice", THEORY} <= {c.split(" | ")[0] for c in found.table.columns[1:]}
    two = {k: x.isel(velocity_y=slice(0, 2)) for k, x in row.results.items()}
    assert propagation("row", [replace(row, results=two)]) == []
