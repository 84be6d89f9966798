"""Rock in the plane that a wave passes."""

import pytest

from jointwave.cases.schema.rock_mass import RockMass

QUIET = dict.fromkeys(("left", "right", "bottom", "top"), "quiet")
ROCK = {"density": 2600.0, "intact_modulus": 5e10}


@pytest.fixture
def struck(rock_mass):
    """Return a function that gives 20 m x 20 m of rock with quiet sides and one joint, which a
    Ricker pulse of 5 ms meets; keyword arguments of the wave, and tables as for `rock_mass`."""

    def scene(
        kind="P", direction=(0.0, 1.0), dip=30.0, through=(0.0, -4.0), joints=None, continuum=None,
        **tables,
    ) -> RockMass:  # fmt: skip
        pulse = {"shape": "ricker", "amplitude": 1e6, "period": 5e-3}
        wave = {"kind": kind, "direction": list(direction), "through": list(through), **pulse}
        table = {
            "domain": {"size": [20.0, 20.0]},
            "rock": ROCK,
            "waves": [wave],
            "boundaries": QUIET,
            "time": {"duration": 0.016},
            "record": {"points": [[10.0, 5.0], [10.0, 15.0]], "joints": [[10.0, 10.0]]},
        }
        joints = [{"dip": dip, "through": [10.0, 10.0]}] if joints is None else joints
        own = {"order": 2} | ({"size": 1.25} if continuum is None else continuum)
        return rock_mass(*joints, continuum=own, **{**table, **tables})

    return scene
