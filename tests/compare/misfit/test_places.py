"""Places of waveforms in both kinds of scenes: their names, and distances at them."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.external import read_curves
from jointwave.compare.misfit.metrics import Worst, pairings, rms, worst
from jointwave.compare.misfit.pairs import measure
from jointwave.compare.misfit.places import Place, parsed, places_of
from jointwave.results.dataset import dataset

JOINT = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
TABLES = {
    "title": "receivers",
    "domain": {"size": [40.0, 40.0]},
    "rock": {"density": 2600.0, "intact_modulus": 5e10},
    "joint_sets": [{"name": "joint", "dip": 0.0, "through": [20.0, 20.0], **JOINT}],
    "time": {"duration": 0.01},
    "record": {"points": [[20.0, 10.0], [20.0, 30.0]], "joints": [[20.0, 20.0]], "interval": 1e-4},
}
PILLAR = {"record__stress": [5.0], "record__velocity": [5.25], "time__duration": 0.01}
TIME = 1e-4 * np.arange(101)
WAVE = np.sin(2e3 * TIME)
LOUD = np.broadcast_to(WAVE[:, None], (2, 101, 2))


def scene(**changes):
    return load_tables(TABLES | changes)


def result(mass, scale=1.0, still=0.0):
    values = {"velocity": scale * LOUD, "traction": still + scale * LOUD[:1]}
    errors = {"velocity": np.array([[1e-3, 2e-3], [3e-3, 4e-3]])}
    return dataset(mass, "dem", TIME, values | {"slip": scale * WAVE[None]}, errors=errors)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("stress@20", ("stress", "", (20.0,)), "stress at 20 m"),
        ("velocity@20.25", ("velocity", "y", (20.25,)), "velocity y at 20.25 m"),
        ("shear_x@2e1", ("shear", "x", (20.0,)), "shear x at 20 m"),
        ("velocity_x@[20,30]", ("velocity", "x", (20.0, 30.0)), "velocity x at [20, 30] m"),
        ("stress_xy@[ 2, -3.5 ] m", ("stress", "xy", (2.0, -3.5)), "stress xy at [2, -3.5] m"),
        ("Traction_n@[2 3]", ("traction", "n", (2.0, 3.0)), "traction n at [2, 3] m"),
        ("gap@[1,2]", ("gap", "", (1.0, 2.0)), "gap at [1, 2] m"),
        ("velocity_z@[1,2,3]", ("velocity", "z", (1.0, 2.0, 3.0)), "velocity z at [1, 2, 3] m"),
    ],
)
def test_a_label_and_the_words_of_a_place_name_it(text, place, words):
    assert parsed(text) == place and Place(*place).words == words
    assert parsed(str(Place(*place))) == place


@pytest.mark.parametrize(
    "text",
    [
        *("velocity@[1,2]", "stress@[1,2]", "stress_xx@2", "traction_n@2", "gap@2", "velocity_x@"),
        *("shear_x@[1,2]", "velocity_z@[1,2]", "velocity_xx@[1,2,3]", "velocity_x@[1]"),
        *("speed@[1,2]", "slip@[1,2,3]"),
    ],
)
def test_what_a_kind_of_scene_does_not_record_is_no_place(text):
    assert parsed(text) is None


def test_a_place_is_found_in_a_result_and_asks_for_its_key():
    found = result(scene())
    assert places_of(found, "velocity") == ([(20.0, 10.0), (20.0, 30.0)], ["x", "y"])
    assert places_of(found, "slip") == ([(20.0, 20.0)], [""])
    for text, key in (("velocity_y@[20,30]", "points"), ("slip@[20,20]", "joints")):
        place = parsed(text)
        assert place.key == key
        np.testing.assert_array_equal(place.waveform(found), WAVE)
    assert parsed("velocity_y@[20,31]").waveform(found) is None
    assert parsed("velocity@20").waveform(found) is None


def test_every_component_at_every_receiver_has_a_distance_of_its_own():
    rows = measure({"dem": result(scene(), 1.01), "continuum-jointed": result(scene())})
    assert [str(row.place) for row in rows] == [
        *("traction_n@[20,20]", "traction_s@[20,20]"),
        *("velocity_x@[20,10]", "velocity_y@[20,10]"),
        *("velocity_x@[20,30]", "velocity_y@[20,30]", "slip@[20,20]"),
    ]
    assert [row.distance.misfit for row in rows] == pytest.approx([0.01] * 7)
    assert rows[2].facts["x"] == 20.0 and rows[2].facts["y"] == 10.0


def test_in_a_pillar_a_silent_stress_decides_nothing_beside_shear(pillar):
    exact = row_of_blocks.solve(pillar(load__direction=[1.0, 0.0, 0.0], **PILLAR))
    exact["stress"] = exact.stress + 1e-12
    found = measure({"dem": exact * 1.01, "spatial-lattice": exact})
    found = {
        (row.place.named, *row.place.at): row.distance.misfit for row in found if not row.faint
    }
    moving = ("velocity x", "displacement x", "rotation z")
    places = [("shear x", 5.0), *((name, 5.25) for name in moving)]
    assert found == pytest.approx(dict.fromkeys(places, 0.01))


def test_where_a_pillar_only_turns_round_off_of_all_else_decides_nothing(pillar):
    """Under a couple about the axis: a stress of 1e-10 Pa that blocks do not have was 100 % off."""
    turns = row_of_blocks.solve(pillar(load__arm=0.3, **PILLAR))
    noisy = turns.copy()
    for name, size in {"stress": 1e-10, "velocity": 1e-15, "displacement": 1e-17}.items():
        noisy[name] = noisy[name] + size * np.sin(1e3 * noisy.time)
    far = worst(turns * 1.01, noisy)
    assert far.misfit == pytest.approx(0.01) and far.place.quantity == "rotation"


def test_stress_below_a_millionth_of_the_load_does_not_decide_where_a_block_flies_off(pillar):
    """The load pulls it off; behind it the exact stress is 0, and 1 Pa of noise was 100 % off."""
    keys = {"joints__tension": False, "load__amplitude": -1e6, "time__duration": 0.01}
    record = {"stress": [20.0], "velocity": [0.25]}
    flies = row_of_blocks.solve(pillar(record=record, **keys))
    noisy = flies.assign(stress=flies.stress + np.sin(1e3 * flies.time))
    assert worst(flies, noisy).misfit == 0.0 and worst(1.01 * flies, noisy).place.at == (0.25,)
    assert worst(flies, flies.assign(stress=noisy.stress * 10)).misfit == pytest.approx(1.0)
    still = noisy.drop_vars(("velocity", "displacement"))
    assert worst(flies, still) == Worst(0.0)


def test_quantities_of_one_unit_are_judged_together():
    """A slip of a thousandth of the displacement is ignored; without displacement it counts."""
    one, other = (
        dataset(scene(), "dem", TIME, {"displacement": LOUD, "slip": slip * WAVE[None]})
        for slip in (2e-3, 1e-3)
    )
    faint = {p.place.quantity: p.faint for p in pairings(one, other)}
    assert faint == {"displacement": False, "slip": True} and worst(one, other).misfit == 0
    alone = [x.drop_vars("displacement") for x in (one, other)]
    assert worst(*alone).misfit == pytest.approx(1.0)


@pytest.mark.parametrize(
    "changes",
    [{"prestress": {"xx": 1e6, "yy": 5e6}}, {"gravity": {}, "boundaries": {"bottom": "fixed"}}],
)
def test_the_state_at_the_start_is_no_motion(changes):
    """The traction of the static state, a thousand times the wave's, leaves the misfit as it is;
    without such a state it is part of the waveform."""
    held, free = scene(**changes), scene()
    found = pairings(result(held, 1.01, still=1e3), result(held, still=1e3))
    assert [p.misfit for p in found] == pytest.approx([0.01] * len(found), rel=1e-6)
    whole = pairings(result(free, 1.01, still=1e3), result(free, still=1e3))
    assert whole[0].place.quantity == "traction" and whole[0].misfit < 1e-4


def test_the_bound_of_a_reference_is_that_of_its_place():
    found = pairings(result(scene(), 1.01), result(scene()))
    errors = {str(p.place): p.floor * rms(p.other) for p in found}
    assert errors["velocity_y@[20,10]"] == pytest.approx(2e-3)
    assert errors["velocity_x@[20,30]"] == pytest.approx(3e-3)
    assert errors["slip@[20,20]"] == 0


@pytest.mark.parametrize("quotes", ['"', ""])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_columns_of_a_file_are_called_by_places(tmp_path, separator, quotes):
    """In a file with commas, too, in quotes or not: a comma in brackets parts no columns."""
    names = ["time [ms]", "-velocity_x@[20,10] [mm/s]", "traction_n@[20 20] [MPa]"]
    quoted = [f"{quotes}{name}{quotes}" if separator in name else name for name in names]
    rows = [separator.join(map(str, (k, -k, 2 * k))) for k in range(4)]
    file = tmp_path / "curve.csv"
    file.write_text("\n".join([separator.join(quoted), *rows]))
    (curves,) = read_curves([str(file)], [scene()])
    np.testing.assert_allclose(curves.time, 1e-3 * np.arange(4))
    velocity = curves.waveforms[Place("velocity", "x", (20.0, 10.0))]
    np.testing.assert_allclose(velocity, 1e-3 * np.arange(4))
    traction = curves.waveforms[Place("traction", "n", (20.0, 20.0))]
    np.testing.assert_allclose(traction, 2e6 * np.arange(4))
