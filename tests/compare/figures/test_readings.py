"""The table of readings from velocities: numbers of known pulses, in print and as JSON."""

import json

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.read import load_tables
from jointwave.compare.cli.compare import show_comparisons
from jointwave.compare.engines import solve
from jointwave.compare.figures.tables import READINGS, reading_frame
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.pairs import Comparison, measure
from jointwave.compare.misfit.places import Place


@pytest.fixture(scope="module")
def compared():
    """A sine in a bar: v = p0 / (rho c), (v omega)^2 T / 2 of squared acceleration."""
    scene = load_tables(
        {
            "title": "a bar",
            "pillar": {"length": 60.0, "side": 0.5, "block": 0.5},
            "rock": {
                "density": 2000.0,
                "equivalent_modulus": 2000.0 * 1000.0**2,
                "equivalent_poisson": 0.25,
            },
            "load": {"shape": "sine", "amplitude": 1e6, "period": 0.01},
            "time": {"duration": 0.06},
            "record": {"velocity": [10.0, 30.0]},
        }
    )
    results = {"images": solve("images", scene)}
    return Comparison(scene, results, {}, measure(results))


def test_a_sine_has_the_numbers_of_its_closed_forms(compared):
    frame = reading_frame([compared])
    assert list(frame["at"]) == ["10 m", "30 m"]
    first = frame.iloc[1]
    assert first["peak velocity (m/s)"] == pytest.approx(0.5, rel=1e-4)
    squared = (0.5 * 200 * np.pi) ** 2 * 0.01 / 2
    assert first["Arias intensity (m/s)"] == pytest.approx(np.pi / 19.62 * squared, rel=2e-4)
    assert first["speed (m/s)"] == pytest.approx(1000.0, rel=1e-5)
    assert np.isnan(frame.iloc[0]["speed (m/s)"])
    lossless = frame["apparent Q"].iloc[1]
    assert np.isnan(lossless) or lossless > 1e4
    assert 0.5 * 200 * np.pi < first["spectral acceleration (m/s2)"] < 4 * 0.5 * 200 * np.pi


def test_curves_of_others_stand_below_the_solutions(compared, tmp_path):
    """A measured velocity, unevenly sampled, has its own row; a stress has none."""
    time = np.array([0.0, 0.01, 0.02, 0.025, 0.03])
    places = [Place("velocity", "y", (10.0,)), Place("stress", "", (10.0,))]
    curves = Curves("gauge.csv", "gauge.csv", time, dict.fromkeys(places, np.sin(100 * time)))
    beside = align_curve(curves, compared.scene, compared.results, align=False)
    with_curve = Comparison(compared.scene, compared.results, {}, compared.rows, [beside])
    frame = reading_frame([with_curve])
    assert list(frame["solution"]) == ["images", "images", "gauge.csv"]
    assert frame["peak velocity (m/s)"].iloc[2] == pytest.approx(np.sin(2.0))


def test_the_table_is_printed_and_is_in_the_json(compared, capsys):
    show_comparisons([compared], False, False, reads=True)
    lines = capsys.readouterr().out.splitlines()
    last = " ".join(lines[-1].split())
    assert last.startswith("base scene homogenised bar, images 30 m 0.5 ")
    assert all(name in "\n".join(lines) for name in READINGS)
    show_comparisons([compared], False, True, reads=True)
    (facts,) = json.loads(capsys.readouterr().out)
    assert [row["at"] for row in facts["readings"]] == ["10 m", "30 m"]
    assert facts["readings"][0]["speed (m/s)"] is None


def test_nothing_is_read_where_no_velocity_is_recorded(compared, capsys):
    silent = {name: result.isel(velocity_y=[]) for name, result in compared.results.items()}
    nothing = compared.__class__(compared.scene, silent, {}, compared.rows)
    assert reading_frame([nothing]).empty
    show_comparisons([nothing], False, False, reads=True)
    assert (
        "no velocities are recorded: record.velocity or record.points is empty"
        in capsys.readouterr().out
    )


def test_a_damped_bar_has_its_quality_factor():
    """1/Q = omega eta at the loudest frequency of a wavelet, which the record, of steps of 21 Hz,
    has at 104 Hz, not 100, and the loss on the way moves a little."""
    scene = load_tables(
        {
            "title": "a damped row",
            "pillar": {"length": 60.0, "side": 0.5, "block": 0.5},
            "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
            "joints": {"damping_ratio": 0.02},
            "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
            "time": {"duration": 0.048},
            "record": {"velocity": [5.25, 20.25], "interval": 5e-5},
        }
    )
    frame = reading_frame([Comparison(scene, {"lattice": solve("lattice", scene)}, {}, [])])
    found = frame["apparent Q"].iloc[1]
    eta = calibrate(scene).time_constant
    assert found == pytest.approx(1 / (2 * np.pi * 100 * eta), rel=0.15)
