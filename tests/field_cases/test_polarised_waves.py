"""S waves in space by two keys that contradict one another, `kind` and `polarisation`."""

import pytest

import jointwave as jw

SIDES = ("left", "right", "front", "back", "bottom", "top")


def load(**wave):
    """Return a cube of rock that a wave enters from below."""
    pulse = {"shape": "ricker", "amplitude": 1e6, "period": 2e-3}
    return jw.load(
        {
            "title": "a cube",
            "domain": {"size": [2.0, 2.0, 2.0]},
            "rock": {"density": 2600.0, "intact_modulus": 5e10},
            "joint_sets": [],
            "waves": [pulse | wave],
            "boundaries": dict.fromkeys(SIDES, "quiet"),
            "time": {"duration": 2e-3},
            "record": {"points": [[1.0, 1.0, 1.0]]},
        }
    )


def test_an_sv_wave_takes_no_polarisation():
    """Across the vertical plane, as here, it would be SH."""
    with pytest.raises(jw.SceneError, match="SV is polarised in the vertical plane"):
        load(kind="SV", direction=[0.6, 0.0, 0.8], polarisation=[0.0, 1.0, 0.0])


def test_a_vertical_wave_has_no_vertical_plane_of_its_own():
    with pytest.raises(jw.SceneError, match="a vertical wave is of no kind 'SV'"):
        load(kind="SV", direction=[0.0, 0.0, 1.0])
