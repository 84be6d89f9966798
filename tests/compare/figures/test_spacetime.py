"""Space-time diagrams against known properties of their waves."""

import numpy as np
import pytest

from jointwave.compare.engines import solve
from jointwave.compare.figures import scene_figures
from jointwave.compare.figures.charts.spacetime import diagrams_of, space_time
from jointwave.compare.figures.scene_figures import along_pillar, recorded_along


def fields_of(scene, *names):
    """Return the result of `along_pillar` for these solutions only."""
    return {name: solve(name, recorded_along(scene)) for name in names}


def test_a_scene_that_records_velocities_is_drawn_by_them(pillar):
    """At the centres of blocks."""
    scene = pillar(time__duration=0.03, record__stress=[], record__velocity=[20.25])
    shown = diagrams_of(scene, fields_of(scene, "dem", "lattice"))[0]
    assert shown.words == "velocity" and shown.diagrams[0].unit.name == "mm/s"
    assert shown.y[:2].tolist() == [0.25, 1.25]


def test_sections_are_the_waveforms_of_the_comparison(pillar, compared, monkeypatch):
    """Receivers all along change neither the step nor a digit of a run; samples are thinned."""
    monkeypatch.setattr(scene_figures, "ENGINES", ("dem",))
    scene = pillar()
    fields = along_pillar(scene)
    assert set(fields) == {"dem", "lattice"}
    waveform = compared(scene)[0].results["dem"].stress.sel(stress_y=20.0)
    thin = fields["dem"].stress.sel(stress_y=20.0)
    assert thin.sizes["time"] == 241
    np.testing.assert_array_equal(thin.values, waveform.sel(time=thin.time).values)


def test_sections_are_joints_and_both_ends(pillar):
    """Few blocks show no wave."""

    def sections(**changes):
        return recorded_along(pillar(**changes)).record.stress

    assert sections() == [float(y) for y in range(51)]
    odd = sections(pillar__length=48.5)  # 97 blocks: the last section is one block on
    assert odd[-2:] == [48.0, 48.5] and len(odd) == 50
    assert len(sections(pillar__length=5000.0)) <= scene_figures.SECTIONS + 2
    assert along_pillar(pillar(pillar__length=3.5, record__stress=[1.0])) == {}


def test_engines_stand_beside_each_other_and_their_errors_apart(pillar):
    scene = pillar(pillar__length=10.0, record__stress=[5.0], time__duration=0.02)
    shown, errors = diagrams_of(scene, along_pillar(scene))
    assert [d.name for d in shown.diagrams] == [
        "rigid blocks",
        "rigid blocks − jointed rock",
        "rigid blocks − homogenised rock",
        "homogenised rock − jointed rock",
    ]
    *names, last = (d.name for d in errors.diagrams)
    assert names == ["rigid blocks − rigid blocks, exact", "jointed rock − jointed bar, exact"]
    assert last.startswith("homogenised rock − ")
    assert 1e-5 < errors.diagrams[0].share < 2e-3  # numerical error
    picture = space_time("fig", scene, "as it stands", shown)
    assert picture.title == "Stress along the pillar over time, as it stands"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"load__direction": [0.28, 0.96, 0.0]}, "stress"),
        ({"load__direction": [0.96, 0.28, 0.0]}, "shear x"),
        ({"load__arm": 0.2, "record__stress": [], "record__velocity": [5.25]}, "rotation y"),
    ],
)
def test_largest_force_is_drawn_else_what_turns(pillar, changes, words):
    keys = {"pillar__length": 10.0, "time__duration": 0.01, "record__stress": [5.0]} | changes
    scene, still = pillar(**keys), pillar(**keys, load__amplitude=0.0)
    (shown,) = diagrams_of(scene, {"dem": solve("spatial-lattice", recorded_along(scene))})
    assert shown.words == words and shown.diagrams[0].values.any()
    assert diagrams_of(still, {"dem": solve("spatial-lattice", recorded_along(still))}) == []


def test_diagrams_hold_the_numbers_of_the_table(scene_with, ink):
    """And these are of the engine, and of the difference from another, whose largest value is said.
    A soft layer is drawn through each of them."""
    layer = {"y": 20.0, "spacing_stiffness": 4.375e8}
    scene = scene_with(soft_layers=[layer], **{"time.duration": 0.03})
    found = fields_of(scene, "dem", "equivalent-bar")
    fields = {"dem": found["dem"], "continuum-equivalent": found["equivalent-bar"]}
    one, other = (result.stress.values for result in fields.values())
    shown = diagrams_of(scene, fields)[0]
    for diagram, values in zip(shown.diagrams, (one, one - other), strict=True):
        np.testing.assert_allclose(diagram.unit.size * diagram.values, values, rtol=1e-12)
    stress, difference = shown.diagrams
    share = difference.share * np.abs(other).max()
    assert share == pytest.approx(np.abs(one - other).max()) and "at most" in difference.heading
    inner = stress.values[1:-1]
    ends = " to ".join(f"{x:.4g}".replace("-", "−") for x in (inner.min(), inner.max()))
    assert stress.heading.endswith(f"between the ends {ends}")
    picture = space_time("fig", scene, "soft layer", shown)
    drawn = [ax for ax in picture.figure.axes if ax.get_title(loc="left")]
    assert len(drawn) == 2 and "soft layer" in picture.title
    for ax, column in zip(drawn, picture.table.columns[2:], strict=True):
        (mesh,) = ax.collections
        values = picture.table[column].to_numpy().reshape(51, -1)
        np.testing.assert_array_equal(mesh.get_array().reshape(values.shape), values)
        assert mesh.norm.vmax == -mesh.norm.vmin == pytest.approx(np.abs(values).max())
        corners = np.asarray(mesh.get_coordinates())
        points = ((corners[1:, 1:] + corners[:-1, :-1]) / 2).reshape(-1, 2)
        assert np.ptp(points, axis=0) == pytest.approx([30.0, 50.0])
        assert (*ax.get_xlim(), *ax.get_ylim()) == pytest.approx((0.0, 30.0, 0.0, 50.0))
        assert any(set(line.get_ydata()) == {20.0} for line in ax.lines)
    assert ink(picture.figure) > 0.05
