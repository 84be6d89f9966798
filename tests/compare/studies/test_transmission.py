"""Reflection and transmission of a scene's joints, against formulas by hand and between solvers."""

import numpy as np
import pytest

import jointwave as jw
from jointwave.compare.studies.transmission import transmission

MASS, PILLAR = "rock-mass/one-joint", "beyond/ricker-one-layer"


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


@pytest.mark.parametrize("scene", [MASS, "rock-mass/parallel-joints"])
@pytest.mark.parametrize("angle", [20.0, 50.0])
def test_energy_is_conserved(scene, angle):
    """Fluxes rho c A^2 cos of the scattered waves add up to that of the incident P wave."""
    found, sine = transmission(scene, angle), np.sin(np.radians(angle))
    flux_s = np.sqrt(1 - sine**2 / 3) / np.sqrt(3) / np.cos(np.radians(angle))  # a = sqrt(3) b
    P, S = found.R_p**2 + found.T_p**2, found.R_s**2 + found.T_s**2
    assert (P + flux_s * S).item() == pytest.approx(1, rel=1e-12)


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
        for name in ("R_p", "R_s", "T_p", "T_s"):
            assert np.ptp(found[name].values, axis=0) == pytest.approx([0, 0], abs=1e-5)
        assert found.residual.sel(solver="parallel-joints").max() < 1e-5
        assert found.residual.sel(solver="exact").isnull().all()


def test_eight_joints_ring_within_the_record():
    """A quarter of a wave apart, where 1.5 % of the energy passes, after many reflections."""
    speed, frequency = (5e10 * 0.75 / (1.25 * 0.5) / 2600.0) ** 0.5, 100.0  # of P waves
    stiffness = np.pi * frequency * 2600.0 * speed  # one joint lets half of the energy pass
    laws = {"dip": 0.0, "normal_stiffness": stiffness, "shear_stiffness": stiffness / 3}
    places = 4.0 + speed / frequency / 4 * np.arange(8)
    sets = [laws | {"name": f"{k}", "through": [0.0, y]} for k, y in enumerate(places.tolist())]
    scene = jw.load(MASS, changes={"joint_sets": sets, "domain.size": [48.0, 120.0], "expect": {}})
    found = transmission(scene, 0, ["exact", "parallel-joints"], frequency=frequency)
    assert found.T_p.sel(solver="exact").item() == pytest.approx(0.124, abs=1e-3)
    assert np.ptp(found.T_p.values) < 2e-3 and np.ptp(found.R_p.values) < 2e-3


def test_engines_have_it_too():
    found = transmission(MASS, 30.0, ["exact", "dem", "continuum-jointed"]).isel(angle=0)
    off = abs(found - found.sel(solver="exact"))
    waves = ["R_p", "R_s", "T_p", "T_s"]
    assert max(off[w].sel(solver="continuum-jointed") for w in waves) < 5e-4
    assert 1e-3 < max(off[w].sel(solver="dem") for w in waves) < 0.02  # no Poisson effect


@pytest.mark.parametrize(
    "scene, changes, options, words",
    [
        (MASS, {}, {"angles": [0, 90]}, r"angles = .*must be from 0 to below 90 degrees"),
        (MASS, {}, {"angles": "steep"}, r"angles = .*must be from 0 to below 90 degrees"),
        (MASS, {}, {"incidence": "SH"}, r"incidence = 'SH': must be 'P', 'S' or 'SV'"),
        (MASS, {}, {"frequency": "12 Hz"}, r"frequency = 'str': must be a number, Hz"),
        (MASS, {}, {"frequency": 0.0}, r"frequency = 0.0: must be positive, Hz"),
        (MASS, {}, {"solvers": "dam"}, r"solvers = 'dam': must be of exact, dem,"),
        (MASS, {"joint_sets.0.friction_angle": 30.0}, {}, "'joint' can slip"),
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
