"""Space-time diagrams against known properties of their waves."""

import numpy as np
import pytest

from jointwave.compare.engines import solve
from jointwave.compare.figures import scene_figures
from jointwave.compare.figures.charts.spacetime import space_time
from jointwave.compare.figures.scene_figures import along_pillar, recorded_along


def fields_of(scene, *names):
    """Return the result of `along_pillar` for these solutions only."""
    return {name: solve(name, recorded_along(scene)) for name in names}


def test_a_scene_that_records_velocities_is_drawn_by_them(pillar):
    scene = pillar(time__duration=0.03, record__stress=[], record__velocity=[20.25])
    shown = space_time("fig", scene, "a", fields_of(scene, "dem", "lattice"))[0]
    assert shown.title == "Velocity along the pillar over time, a"
    assert shown.table.columns[2] == "rigid blocks (mm/s)"
    assert shown.table["y (m)"].unique()[:2].tolist() == [0.25, 1.25]


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
    def sections(**changes):
        return recorded_along(pillar(**changes)).record.stress

    assert sections() == [float(y) for y in range(51)]
    odd = sections(pillar__length=48.5)  # 97 blocks: the last section is one block on
    assert odd[-2:] == [48.0, 48.5] and len(odd) == 50
    assert len(sections(pillar__length=5000.0)) <= scene_figures.SECTIONS + 2
    assert along_pillar(pillar(pillar__length=3.5, record__stress=[1.0])) == {}


def test_engines_stand_beside_each_other_and_their_errors_apart(pillar):
    scene = pillar(pillar__length=10.0, record__stress=[5.0], time__duration=0.02)
    shown, errors = space_time("fig", scene, "as it stands", along_pillar(scene))
    assert [name.rpartition(" (")[0] for name in shown.table.columns[2:]] == [
        "rigid blocks",
        "rigid blocks − jointed rock",
        "rigid blocks − homogenised rock",
        "homogenised rock − jointed rock",
    ]
    *names, last = (name.rpartition(" (")[0] for name in errors.table.columns[2:])
    assert names == ["rigid blocks − rigid blocks, exact", "jointed rock − jointed bar, exact"]
    assert last.startswith("homogenised rock − ")
    share = errors.figure.axes[0].get_title(loc="left").splitlines()[-1]
    assert 1e-3 < float(share.split()[2]) < 0.2  # numerical error, %
    assert shown.title == "Stress along the pillar over time, as it stands"
    assert errors.title == "Numerical error of stress along the pillar over time, as it stands"


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
    found, rest = (
        space_time("fig", one, "", {"dem": solve("spatial-lattice", recorded_along(one))})
        for one in (scene, still)
    )
    assert found[0].title.lower().startswith(f"{words} along") and rest == []
    assert len(found) == 1 and found[0].table.iloc[:, 2].any()


def test_diagrams_hold_the_numbers_of_the_table(pillar, ink):
    """And these are of the engine, and of the difference from another, whose largest value is said.
    A soft layer is drawn through each of them."""
    layer = {"y": 20.0, "spacing_stiffness": 4.375e8}
    scene = pillar(soft_layers=[layer], **{"time.duration": 0.03})
    found = fields_of(scene, "dem", "equivalent-bar")
    fields = {"dem": found["dem"], "continuum-equivalent": found["equivalent-bar"]}
    one, other = (result.stress.values for result in fields.values())
    picture = space_time("fig", scene, "soft layer", fields)[0]
    units = {"MPa": 1e6, "kPa": 1e3}
    shown = []
    for column, values in zip(picture.table.columns[2:], (one, one - other), strict=True):
        size = units[column.rpartition("(")[2].removesuffix(")")]
        shown.append(picture.table[column].to_numpy().reshape(values.shape))
        np.testing.assert_allclose(size * shown[-1], values, rtol=1e-12)
    headings = [ax.get_title(loc="left") for ax in picture.figure.axes[:2]]
    share = 100 * np.abs(one - other).max() / np.abs(other).max()
    assert headings[1].endswith(f"at most {share:.2g} % of the largest")
    inner = shown[0][1:-1]
    ends = " to ".join(f"{x:.4g}".replace("-", "−") for x in (inner.min(), inner.max()))
    assert headings[0].endswith(f"between the ends {ends}")
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
