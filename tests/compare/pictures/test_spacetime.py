"""Space-time diagrams against what is known of the waves in them."""

import json

import numpy as np
import pytest
import xarray as xr

import dem
from cases.calibrate import calibrate
from cases.sampling import Clock
from compare.engines import solve
from compare.exact import leapfrog
from compare.page.packed import pack_plot, pack_table
from compare.pictures import along
from compare.pictures.along import along_pillar, recorded_along, sections
from compare.pictures.diagrams import diagrams_of
from compare.pictures.interactive import unpacked
from compare.pictures.spacetime import FINER, space_time
from dem.axial.model import build_model


def fields_of(scene, names):
    """Return what `along_pillar` would, by these solutions alone."""
    return {name: solve(name, recorded_along(scene)) for name in names}


def front_speed(diagram, time, y, level):
    """Return the speed of the first crossing of a level, fitted over the middle of the pillar."""
    middle, arrivals = slice(5, -5), []
    for row in diagram.values[middle]:
        i = int(np.argmax(row > level))
        arrivals.append(np.interp(level, row[i - 1 : i + 1], time[i - 1 : i + 1]))
    return np.polyfit(arrivals, y[middle], 1)[0]


@pytest.mark.parametrize(("name", "bound"), [("images", 1e-3), ("dem", 2e-2)])
def test_front_moves_at_the_speed_of_the_bar(pillar, name, bound):
    """That of the blocks is a little behind: the chain's long waves are slower than the bar's."""
    scene = pillar(time__duration=0.045)
    fields = fields_of(scene, ["dem", name])
    shown = diagrams_of({"dem": fields[name].assign_attrs(variant="")})[0]
    speed = front_speed(shown.diagrams[0], shown.time, shown.y, 0.5e6 / shown.diagrams[0].unit.size)
    assert speed == pytest.approx(calibrate(scene).bar_speed, rel=bound)


def test_difference_from_what_the_engine_is_exactly_is_round_off(pillar):
    """Against leapfrog's closed form, at every joint and sample."""
    scene = recorded_along(pillar(time__duration=0.03))
    result, p = dem.simulate(scene), calibrate(scene)
    samples, dt = result.sizes["time"], result.attrs["dt"]
    stride = round(scene.interval / dt)
    load = build_model(scene, p, Clock(dt, stride, samples)).load
    force = np.zeros(stride * (samples - 1))
    force[: len(load)] = load[: len(force)]
    k = p.regular_stiffness * p.area
    steps = stride * np.arange(samples)
    u = leapfrog.displacements(force, steps, dt, k, p.block_mass, p.block_count)
    joints = np.rint(result.stress_y.values[1:-1] / p.spacing).astype(int)
    inner = result.isel(stress_y=slice(1, -1))
    closed = inner.assign(stress=(("stress_y", "time"), k / p.area * (u[joints - 1] - u[joints])))
    (shown,) = diagrams_of({"dem": inner, "lattice": closed})
    assert [d.name for d in shown.diagrams] == ["dem", "lattice", "dem − lattice"]
    assert 0 < shown.diagrams[2].share < 1e-9


def test_difference_from_the_exact_chain_is_the_numerical_error(pillar):
    (shown,) = diagrams_of(fields_of(pillar(time__duration=0.03), ["dem", "lattice"]))
    one, other, difference = shown.diagrams
    largest = np.abs(difference.values).max() * difference.unit.size
    assert 1e-5 < difference.share < 2e-3
    assert largest == pytest.approx(
        difference.share * np.abs(other.values).max() * other.unit.size, rel=0.01
    )
    assert one.limit == other.limit and difference.limit < one.limit * one.unit.size
    assert f"at most {100 * difference.share:.2g} %" in difference.heading


def test_sections_are_the_waveforms_of_the_comparison(pillar, compared, monkeypatch):
    """Receivers all along change neither the step nor a digit of a run; samples are thinned."""
    monkeypatch.setattr(along, "ENGINES", ("dem",))
    scene = pillar()
    fields = along_pillar(scene)
    assert set(fields) == {"dem", "lattice"}
    waveform = compared(scene)[0].results["dem"].stress.sel(stress_y=20.0)
    thin = fields["dem"].stress.sel(stress_y=20.0)
    assert thin.sizes["time"] == 241
    np.testing.assert_array_equal(thin.values, waveform.sel(time=thin.time).values)


def test_sections_are_joints_and_both_ends(pillar):
    assert sections(pillar()) == [float(y) for y in range(51)]
    odd = sections(pillar(pillar__length=48.5))  # 97 blocks: the last section is one block on
    assert odd[-2:] == [48.0, 48.5] and len(odd) == 50
    assert len(sections(pillar(pillar__length=5000.0))) <= along.SECTIONS + 2


def test_few_blocks_show_no_wave(pillar):
    scene = pillar(pillar__length=3.5, record__stress=[1.0])
    assert along_pillar(scene) == {}


def test_every_engine_stands_beside_its_own_model_and_the_others(pillar):
    fields = along_pillar(pillar(pillar__length=10.0, record__stress=[5.0], time__duration=0.02))
    found = {shown.engine: [d.name for d in shown.diagrams] for shown in diagrams_of(fields)}
    assert {engine: names[1] for engine, names in found.items() if engine} == {
        "dem": "lattice",
        "continuum-jointed": "jointed-bar",
        "continuum-equivalent": "equivalent-bar",
    }
    assert found[""] == [
        "dem − continuum-jointed",
        "dem − continuum-equivalent",
        "continuum-equivalent − continuum-jointed",
    ]


def spatial(stress, shear, rotation):
    """Return a result in space with these peaks, each of its own shape."""
    time, y = np.linspace(0, 1, 5), np.arange(9.0)
    wave = np.outer(y, np.sin(time))
    return xr.Dataset(
        {
            "stress": (("stress_y", "time"), stress * wave),
            "shear": (("stress_y", "time", "across"), np.stack([shear * wave, 0 * wave], axis=2)),
            "rotation": (
                ("velocity_y", "time", "axis"),
                np.stack([0 * wave, rotation * wave, 0 * wave], axis=2),
            ),
        },
        {"time": time, "stress_y": y, "velocity_y": y},
        {"variant": ""},
    )


@pytest.mark.parametrize(
    ("peaks", "words", "unit"),
    [
        ((5e5, 1e5, 1e-3), "stress", "MPa"),
        ((1e5, 5e5, 1e-3), "shear x", "MPa"),
        ((0.0, 0.0, 1e-3), "rotation y", "mrad"),
    ],
)
def test_largest_force_is_drawn_else_what_turns(peaks, words, unit):
    (shown,) = diagrams_of({"dem": spatial(*peaks)})
    assert shown.quantity.words == words
    assert shown.diagrams[0].unit.name == unit
    assert shown.diagrams[0].limit > 0


def test_nothing_moves_nothing_is_drawn():
    assert diagrams_of({"dem": spatial(0.0, 0.0, 0.0)}) == []


@pytest.fixture
def picture(pillar):
    layer = {"y": 20.0, "spacing_stiffness": 4.375e8}
    scene = pillar(time__duration=0.03, soft_layers=[layer])
    (shown,) = diagrams_of(fields_of(scene, ["dem", "lattice"]))
    return space_time("fig", scene, shown)


def test_traces_hold_the_numbers_of_the_table(picture):
    assert len(picture.plot["data"]) == 3
    for trace, column in zip(picture.plot["data"], picture.table.columns[2:], strict=True):
        z = unpacked(trace["z"])
        assert column.startswith(f"{trace['name']} (")
        np.testing.assert_allclose(z.ravel(), picture.table[column].values, rtol=1e-7)
        assert z.shape == (51, len(z[0])) and np.abs(z).max() <= 1.001 * trace["zmax"]
        x = 1e-3 * (trace["x0"] + trace["dx"] * np.arange(z.shape[1]))
        np.testing.assert_allclose(x, picture.table["time (s)"].unique(), atol=1e-9)
        y = trace["y0"] + trace["dy"] * np.arange(z.shape[0])
        np.testing.assert_allclose(y, picture.table["y (m)"].unique())


def test_one_diagram_takes_little_of_the_page(picture):
    size = len(pack_plot(json.dumps(picture.plot))) + len(pack_table(picture.table))
    assert size / len(picture.plot["data"]) < 40e3


def test_soft_layer_is_drawn_through_every_diagram(picture):
    assert [shape["y0"] for shape in picture.plot["layout"]["shapes"]] == [20.0] * 3
    drawn = [ax for ax in picture.static.axes if ax.images and ax.get_title(loc="left")]
    for ax in drawn:
        assert any(set(line.get_ydata()) == {20.0} for line in ax.lines)


def test_static_diagrams_hold_the_same_numbers_in_the_same_colours(picture, ink):
    drawn = [ax for ax in picture.static.axes if ax.get_title(loc="left")]
    assert len(drawn) == 3
    for ax, trace in zip(drawn, picture.plot["data"], strict=True):
        (image,) = ax.images
        rows = image.get_array()[::FINER]
        np.testing.assert_allclose(rows, unpacked(trace["z"]), rtol=1e-6, atol=1e-9)
        assert image.norm.vmax == trace["zmax"] and image.norm.vmin == trace["zmin"]
        assert (*ax.get_xlim(), *ax.get_ylim()) == pytest.approx((0.0, 30.0, 0.0, 50.0))
        edges = np.array(image.get_extent()).reshape(2, 2)
        pixel = np.ptp(edges, axis=1) / image.get_array().shape[::-1]
        outermost = edges + np.outer(pixel, [0.5, -0.5])  # where the outermost points are
        np.testing.assert_allclose(outermost, [[0.0, 30.0], [0.0, 50.0]], atol=1e-9)
        assert image.origin == "lower"
    assert ink(picture.static) > 0.05
