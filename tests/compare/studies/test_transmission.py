"""Reflection and transmission at joints: closed forms, what is read off motion, and the study."""

import numpy as np
import pandas as pd
import pytest

import jointwave as jw
from jointwave.compare.engines import solve
from jointwave.compare.studies import scattering
from jointwave.compare.studies.scattering import WAVES, draw, experiment, joints_of, measure
from jointwave.compare.studies.transmission import amplitudes, scene_of, transmission

MASS, PILLAR = "rock-mass/one-joint", "beyond/ricker-one-layer"
#: |R_p|, |R_s|, |T_p|, |T_s| of P at 30 degrees, nu = 0.25, K_n = Z_p omega, K_s = Z_s omega.
KNOWN = (0.2836, 0.4144, 0.8999, 0.0188)


def point_of(*about):
    return dict(zip(("solver", "incidence", "angle", "joints"), about, strict=True))


def by_hand(impedance, stiffness, omega):
    """|R| and |T| of one joint at normal incidence (Pyrak-Nolte, Myer & Cook 1990)."""
    kappa = stiffness / (impedance * omega)
    return 1 / np.hypot(1, 2 * kappa), 2 * kappa / np.hypot(1, 2 * kappa)


def test_normal_incidence_is_the_formula():
    """lambda + 2 mu = 6e10 Pa at 2600 kg/m3, mu = 2e10 Pa, and 200 Hz; any other frequency too."""
    found = transmission(MASS, 0.0)
    R, T = by_hand(np.sqrt(2600 * 6e10), 1.6e10, 2 * np.pi / 0.005)
    assert found.R_p.item() == pytest.approx(R) and found.T_p.item() == pytest.approx(T)
    assert found.R_s == found.T_s == 0 and found.frequency == pytest.approx(200)
    found = transmission(MASS, 0.0, incidence="SV", frequency=50.0)
    assert found.equals(transmission(MASS, 0.0, incidence="S", frequency=50.0))
    R, T = by_hand(np.sqrt(2600 * 2e10), 9e9, 100 * np.pi)
    assert found.R_s.item() == pytest.approx(R) and found.T_s.item() == pytest.approx(T)


@pytest.mark.parametrize(
    "incidence, angle, off",
    [("P", 45.0, 1e-9), ("SV", 30.0, 1e-9), pytest.param("SV", 60.0, 1e-5, marks=pytest.mark.slow)],
)
def test_the_motion_of_one_joint_has_the_closed_form(incidence, angle, off):
    """Of a pulse over 12 periods, whose tail is 1e-9 of it by then; beyond the critical angle of S
    waves the tail falls as a power of time, and the record ends."""
    row = measure(point_of("oblique-joint", incidence, angle, 1))
    assert row["error"] < off and row["residual"] < 2 * off and row["cpu"] > 0


def test_the_motion_at_joints_has_the_closed_form():
    """Unequal spacings, dashpots, a free side above, and other rock than that of the study."""
    sets = [
        {"dip": 10.0, "through": [20.0, 20.0], "damping_ratio": 0.1},
        {"dip": 10.0, "through": [20.0, 23.0]},
        {"dip": 10.0, "through": [20.0, 30.0]},
    ]
    laws = {"normal_stiffness": 1.6e10, "shear_stiffness": 9e9}
    changes = {"joint_sets": [{"name": f"{k}"} | laws | one for k, one in enumerate(sets)]}
    changes |= {"rock.intact_poisson": 0.35, "boundaries.top": "free", "expect": {}}
    scene = jw.load(MASS, changes=changes)
    for incidence in ("P", "SV"):
        found = transmission(scene, [0, 25], ["exact", "parallel-joints"], incidence)
        for name in WAVES:
            assert np.ptp(found[name].values, axis=0) == pytest.approx([0, 0], abs=1e-5)
        assert found.residual.sel(solver="parallel-joints").max() < 1e-5
        assert found.residual.sel(solver="exact").isnull().all()


def test_a_turned_joint_is_the_same_joint():
    """A joint at 20 degrees under a wave at 10 is one at 30 under its normal. Motion that is no
    plane wave is left over."""
    turned = np.radians(-10)
    changes = {
        "joint_sets.0.dip": 20.0,
        "waves.0.direction": [float(np.sin(-turned)), float(np.cos(turned))],
        "waves.0.through": [0.0, -6.0],
    }
    places = [[6.0, 1.0], [7.0, 2.0], [5.0, 3.0], [6.0, 9.0], [7.0, 10.0], [5.0, 11.0]]
    scene = scene_of(joints_of(1), "P", 0.0, changes | {"record.points": places})
    velocity = solve("oblique-joint", scene).velocity.values.copy()
    found = amplitudes(scene, velocity)
    assert found[:4] == pytest.approx(KNOWN, abs=6e-5) and found[4] < 1e-8
    velocity[0] *= 1.1
    assert 0.01 < amplitudes(scene, velocity)[4] < 0.1


def test_engines_have_it_too():
    found = transmission(MASS, 30.0, ["exact", "dem", "continuum-jointed"]).isel(angle=0)
    off = abs(found - found.sel(solver="exact"))
    assert max(off[w].sel(solver="continuum-jointed") for w in WAVES) < 5e-4
    assert 1e-3 < max(off[w].sel(solver="dem") for w in WAVES) < 0.02  # no Poisson effect


@pytest.mark.slow
@pytest.mark.parametrize("joints", [1, 3])
@pytest.mark.parametrize("incidence", ["P", "SV"])
def test_deformable_rock_has_them_at_all_angles(incidence, joints):
    """Elements of order 2, about 8 to the S wave: a thousandth."""
    for angle in scattering.ANGLES:
        row = measure(point_of("continuum-jointed", incidence, angle, joints))
        assert row["error"] < 1e-3, row


@pytest.mark.parametrize(
    "scene, changes, options, words",
    [
        (MASS, {}, {"angles": [0, 90]}, r"angles = .*must be from 0 to below 90 degrees"),
        (MASS, {}, {"incidence": "SH"}, r"incidence = 'SH': must be 'P', 'S' or 'SV'"),
        (MASS, {}, {"frequency": 0.0}, r"frequency = 0.0: must be positive, Hz"),
        (MASS, {}, {"solvers": "dam"}, r"solvers = 'dam': must be of exact, dem,"),
        ("rock-mass/brickwork", {}, {}, "joints are not parallel"),
        ("rock-mass/layers", {}, {}, "regions differ in rock"),
        (PILLAR, {}, {}, "has no transmission by angle: it is a pillar"),
    ],
)
def test_what_has_no_table_is_refused_in_one_line(scene, changes, options, words):
    loaded = jw.load(scene, changes=changes | {"expect": {}})
    with pytest.raises(jw.SceneError, match=words) as refused:
        transmission(loaded, **{"angles": 0.0} | options)
    assert "\n" not in str(refused.value)


def test_the_study_writes_its_table_and_its_figure(monkeypatch, tmp_path):
    few = [point_of("oblique-joint", kind, 30.0, 1) for kind in ("P", "SV")]
    monkeypatch.setattr(scattering, "points", lambda *of: few)
    found = experiment("oblique-joint", tmp_path).make()
    names = {"oblique-joint.csv", "oblique-joint.svg"}
    assert names <= {file.name for file in found.files}
    heads = [(f"joint at an angle, exact: {k} wave", 30.0) for k in ("P", "SV")]
    assert found.table.index.tolist() == heads
    assert found.table.iloc[0, :4].tolist() == pytest.approx(KNOWN, abs=6e-5)
    assert "at 30 degrees" in found.sentences[0]


def test_a_brief_study_has_every_other_point():
    for name, places in (("oblique-joint", {0, 30, 60}), ("parallel-joints", {2, 5})):
        found, every = scattering.points(name, brief=True), scattering.points(name)
        assert {p["angle" if name == "oblique-joint" else "joints"] for p in found} == places
        assert all(one in every for one in found) and len(found) == 6 * len(places)


def lines_of(name, rows):
    return {one.get_gid(): one for ax in draw(name, pd.DataFrame(rows)).axes for one in ax.lines}


def test_the_figure_has_the_numbers_and_the_closed_form():
    """By the angle of one joint, and by the number of several. Waves between five joints ring on: a
    millionth of the motion is left at the record's end."""
    moduli = dict(zip(WAVES, (0.2, 0.3, 0.9, 0.1), strict=True))
    lines = lines_of("oblique-joint", [point_of("oblique-joint", "SV", 20.0, 1) | moduli])
    for w, modulus in enumerate(moduli.values()):
        drawn, curve = lines[f"oblique-joint-1-0-{w}"], lines[f"oblique-joint-exact-0-{w}"]
        assert (drawn.get_xdata().tolist(), drawn.get_ydata().tolist()) == ([20.0], [modulus])
        at = dict(zip(curve.get_xdata(), curve.get_ydata(), strict=True))
        assert at[30.0] == pytest.approx(KNOWN[w], abs=6e-5)
    row = measure(point_of("parallel-joints", "P", 30.0, 5))
    assert row["error"] < 1e-6 and row["residual"] < 2e-6
    curve = lines_of("parallel-joints", [row])["parallel-joints-exact-0-2"]
    assert row["T_p"] == pytest.approx(curve.get_ydata()[4], abs=1e-6)
