"""Reflection and transmission at one joint: extracted from motion, and as a study."""

import numpy as np
import pandas as pd
import pytest

from jointwave.compare.engines import solve
from jointwave.compare.studies import scattering as points
from jointwave.compare.studies.scattering import (
    WAVES,
    draw,
    experiment,
    joints_of,
    measure,
)
from jointwave.compare.studies.transmission import amplitudes, scene_of

#: |R_p|, |R_s|, |T_p|, |T_s| of P at nu = 0.25, K_n = Z_p omega, K_s = Z_s omega, found by solving
#: the four boundary conditions as they stand.
KNOWN = {
    0.0: (0.4472, 0.0, 0.8944, 0.0),
    30.0: (0.2836, 0.4144, 0.8999, 0.0188),
    45.0: (0.1560, 0.4410, 0.9103, 0.0515),
    60.0: (0.0908, 0.3609, 0.9237, 0.0908),
}


def point_of(solver, incidence, angle, joints):
    """Return a point of a study."""
    return {"solver": solver, "incidence": incidence, "angle": angle, "joints": joints}


@pytest.mark.parametrize("angle", KNOWN)
def test_amplitudes_are_those_of_the_motion(angle):
    """The motion of a pulse over 12 periods, whose tail is 1e-9 of it by then."""
    row = measure(point_of("oblique-joint", "P", angle, 1))
    assert row["error"] < 1e-9 and row["residual"] < 1e-9
    assert [row[w] for w in WAVES] == pytest.approx(KNOWN[angle], abs=6e-5)
    assert row["cpu"] > 0


@pytest.mark.parametrize(
    "angle, off", [(30.0, 1e-9), pytest.param(60.0, 1e-5, marks=pytest.mark.slow)]
)
def test_shear_waves_too(angle, off):
    """Beyond the critical angle the tail falls as a power of time, and the record ends."""
    row = measure(point_of("oblique-joint", "SV", angle, 1))
    assert row["error"] < off and row["residual"] < 2 * off


def test_a_turned_joint_is_the_same_joint():
    """A joint at 20 degrees under a wave at 10 is one at 30 under its normal."""
    turned = np.radians(-10)
    changes = {
        "joint_sets.0.dip": 20.0,
        "waves.0.direction": [float(np.sin(-turned)), float(np.cos(turned))],
        "waves.0.through": [0.0, -6.0],
    }
    places = [[6.0, 1.0], [7.0, 2.0], [5.0, 3.0], [6.0, 9.0], [7.0, 10.0], [5.0, 11.0]]
    scene = scene_of(joints_of(1), "P", 0.0, changes | {"record.points": places})
    found = amplitudes(scene, solve("oblique-joint", scene).velocity.values)
    assert found[:4] == pytest.approx(KNOWN[30.0], abs=6e-5) and found[4] < 1e-8


def test_motion_that_is_no_plane_wave_is_left_over():
    scene = scene_of(joints_of(1), "P", 30.0)
    velocity = solve("oblique-joint", scene).velocity.values.copy()
    velocity[0] *= 1.1
    assert 0.01 < amplitudes(scene, velocity)[4] < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("joints", [1, 3])
@pytest.mark.parametrize("incidence", ["P", "SV"])
def test_deformable_rock_has_them_at_all_angles(incidence, joints):
    """Elements of order 2, about 8 to the S wave: a thousandth."""
    for angle in points.ANGLES:
        row = measure(point_of("continuum-jointed", incidence, angle, joints))
        assert row["error"] < 1e-3, row


@pytest.fixture
def few(monkeypatch):
    """Leave one angle of each kind of wave."""
    few = [point_of("oblique-joint", kind, 30.0, 1) for kind in ("P", "SV")]
    monkeypatch.setattr(points, "points", lambda *of: few)


def test_the_study_writes_its_table_and_its_figure(few, tmp_path):
    found = experiment("oblique-joint", tmp_path).make()
    names = {"oblique-joint.csv", "oblique-joint.svg"}
    assert names <= {file.name for file in found.files}
    assert set(found.table.index) == {
        (f"joint at an angle, exact: {k} wave", 30.0) for k in ("P", "SV")
    }
    assert found.table.iloc[0, :4].tolist() == pytest.approx(KNOWN[30.0], abs=6e-5)
    assert "at 30 degrees" in found.sentences[0]
    saved = [file.stat().st_mtime_ns for file in sorted((tmp_path / "oblique-joint").iterdir())]
    again = experiment("oblique-joint", tmp_path).make()
    assert again.table.equals(found.table) and len(saved) == 2
    assert saved == [f.stat().st_mtime_ns for f in sorted((tmp_path / "oblique-joint").iterdir())]


def test_a_brief_study_has_every_other_point():
    for name, places in (("oblique-joint", {0.0, 30.0, 60.0}), ("parallel-joints", {2, 5})):
        found = points.points(name, brief=True)
        assert {p["angle" if name == "oblique-joint" else "joints"] for p in found} == places
        every = points.points(name)
        assert all(one in every for one in found) and len(found) == 6 * len(places)


def lines_of(name, rows):
    return {one.get_gid(): one for ax in draw(name, pd.DataFrame(rows)).axes for one in ax.lines}


def test_several_joints_pass_what_is_known():
    """|T_p| and |T_s| of 2 and 5 joints a tenth of the P wave apart at 30 degrees, found by
    solving all their boundary conditions at once. Waves between five joints ring on: a millionth of
    the motion is left at the record's end."""
    known = {2: (0.9098, 0.0443), 5: (0.9256, 0.0721)}
    for count, (T_p, T_s) in known.items():
        row = measure(point_of("parallel-joints", "P", 30.0, count))
        assert row["error"] < 1e-6 and row["residual"] < 2e-6
        assert (row["T_p"], row["T_s"]) == pytest.approx((T_p, T_s), abs=6e-5)
        curve = lines_of("parallel-joints", [row])["parallel-joints-exact-0-2"]
        assert curve.get_ydata()[count - 1] == pytest.approx(T_p, abs=6e-5)


def test_the_figure_has_the_numbers():
    row = point_of("oblique-joint", "SV", 20.0, 1) | dict(
        zip(WAVES, (0.2, 0.3, 0.9, 0.1), strict=True)
    )
    lines = lines_of("oblique-joint", [row])
    for w, name in enumerate(WAVES):
        drawn = lines[f"oblique-joint-1-0-{w}"]
        assert drawn.get_xdata().tolist() == [20.0]
        assert drawn.get_ydata().tolist() == [row[name]]
    curve = lines["oblique-joint-exact-0-0"]
    at = {x: y for x, y in zip(curve.get_xdata(), curve.get_ydata(), strict=True)}
    assert [at[x] for x in KNOWN] == pytest.approx([of[0] for of in KNOWN.values()], abs=6e-5)
