"""Keys of rock masses fitted to waveforms of points and joints; which keys a scene has free."""

import json
from contextlib import suppress

import numpy as np
import pytest

import jointwave
from jointwave.cases.errors import SceneError
from jointwave.cases.read import load_tables
from jointwave.cases.schema.keys import keys
from jointwave.compare.engines import solve
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place
from jointwave.compare.studies.fit_keys import changed, free_keys

STIFFNESS, AMPLITUDE = "joint_sets.0.normal_stiffness", "waves.0.amplitude"
TRUE = {STIFFNESS: 5e9, AMPLITUDE: 1.3e6}
ABOVE = Place("velocity", "y", (6.0, 8.0))
AT_JOINT = Place("traction", "n", (6.0, 5.0))


@pytest.fixture
def tables(one_joint):
    """Return a level joint in blocks of 2 m, met by a P wave from below."""
    found = one_joint(
        domain={"size": [12.0, 10.0]},
        numerics={"dem": {"block": 2.0}},
        time={"duration": 0.01},
        record={"points": [[6.0, 8.0]], "joints": [[6.0, 5.0]], "interval": 1e-4},
    )
    found["rock"]["intact_poisson"] = 0.0
    found["joint_sets"][0] |= {"dip": 0.0, "through": [6.0, 5.0]}
    found["waves"][0]["period"] = 0.004
    return found


@pytest.fixture
def scene(tables):
    """Return that as a scene."""
    return load_tables(tables)


def heard(result, places=(ABOVE, AT_JOINT)):
    """Return the curves of a result at some places."""
    waveforms = {place: place.waveform(result) for place in places}
    return Curves("run.nc", "run.nc", result.time.values, waveforms)


@pytest.mark.parametrize(("solver", "name"), [(None, "dem"), ("oblique-joint", "oblique-joint")])
def test_known_values_are_found_to_round_off(solver, name, scene):
    """Of a point and a joint, by rigid blocks unless asked otherwise, and by the exact solution."""
    curves = heard(solve(name, changed(scene, TRUE)))
    found = jointwave.fit(scene, [curves], list(TRUE), solver)
    before, after = found.waveforms[["before", "after"]].max()
    assert found.solver == name and before > 0.1 and after < 1e-6
    assert found.values.value.to_dict() == pytest.approx(TRUE, rel=1e-6)


@pytest.fixture
def column(pillar):
    return pillar(soft_layers=[{"y": 20.0, "spacing_stiffness": 4e8}])


@pytest.mark.parametrize(
    ("kind", "free_tables"),
    [
        ("column", {"pillar", "rock", "joints", "soft_layers", "load"}),
        ("scene", {"rock", "joint_sets", "waves"}),
    ],
)
def test_every_number_of_a_scene_is_free_or_refused(kind, free_tables, request):
    """With bounds within which the scene accepts it, and a value set as a file would set it; keys
    of blocks, solution and recording are refused."""
    scene, found = request.getfixturevalue(kind), set()
    for key, _ in keys(type(scene)):
        first, dot, rest = key.partition(".")
        here = f"{first}.0{dot}{rest}" if isinstance(getattr(scene, first, None), list) else key
        try:
            (free,) = free_keys([f"{here}=0.3"], scene)
        except SceneError as error:
            assert "\n" not in str(error) and here in str(error)
            continue
        assert free.low < 0.3 < free.high and free.value(free.unknown(0.31)) == pytest.approx(0.31)
        found.add(first)
        with suppress(SceneError):
            assert changed(scene, {here: 0.3}) != scene
    assert free_tables <= found and not {"domain", "time", "numerics", "record"} & found


@pytest.mark.parametrize("key", ["joint_sets.0.dip", "numerics.dem.block"])
def test_what_cuts_blocks_is_refused(key, scene):
    """Their number would jump."""
    with pytest.raises(SceneError, match="must be a continuous number"):
        free_keys([key], scene)


def test_a_scene_without_rigid_blocks_asks_for_another_solver(tables):
    del tables["numerics"]
    whole = load_tables(tables)
    with pytest.raises(SceneError, match=r"dem does not apply: numerics\.dem\.block is required"):
        jointwave.fit(whole, [heard(solve("oblique-joint", whole))], list(TRUE))


def test_command_fits_a_history(tables, tmp_path, command, in_toml):
    """The factor on a pulse from a file is found."""
    time = np.linspace(0.0, 0.004, 41)
    pulse = np.c_[time, 1e6 * np.sin(np.pi * time / 0.004) ** 2]
    np.savetxt(tmp_path / "pulse.csv", pulse, "%.9g", ",")
    wave = tables["waves"][0] | {"shape": "table", "file": "pulse.csv", "amplitude": 1.0}
    del wave["period"]
    tables["waves"] = [wave]
    (tmp_path / "scene.toml").write_text(in_toml(tables))
    true = jointwave.load(tmp_path / "scene.toml", changes={AMPLITUDE: 1.3})
    curve = heard(solve("oblique-joint", true), [ABOVE])
    columns = np.c_[1e3 * curve.time, 1e3 * curve.waveforms[ABOVE]]
    header = 'time [ms],"velocity_y@[6,8] [mm/s]"'
    np.savetxt(tmp_path / "gauge.csv", columns, "%.12g", ",", header=header, comments="")
    asked = ("--with", "gauge.csv", "--free", AMPLITUDE, "--engine", "exact")
    model = ("--model", "oblique-joint")
    facts = json.loads(command("fit", "scene.toml", *asked, *model, "--json").out)
    (estimate,) = facts["keys"]
    assert estimate["value"] == pytest.approx(1.3, rel=1e-6)
