"""The Python interface: functions do what those behind them do, and cost nothing before."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import jointwave as jw
from jointwave import cases
from jointwave.cases.warnings import warnings
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import find
from jointwave.results.dataset import attributes_of, scene_hash

TABLES = {
    "title": "made of tables",
    "pillar": {"length": 5.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
    "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
    "time": {"duration": 0.03},
    "record": {"stress": [2.0]},
    "variants": [{"name": "damped", "joints": {"damping_ratio": 0.05}}],
}
MOVED = TABLES | {"record": {"velocity": [1.25]}}
ALONE = TABLES | {"variants": []}
STEP = ([0, 1], [0, 1])
UNEVEN = {"pillar.block": 0.3}
JOINTS = {"pillar": TABLES["pillar"] | {"joints": [2.0]}}
SOME = ("guo-li-2002/fig-03", "beyond/slip-weakening", "hard/short-pillar", "rock-mass/slope")
SOME += ("rock-mass/parallel-joints", "rock-mass/cavern", "rock-mass/layers")


@pytest.mark.parametrize("name", SOME)
def test_the_scene_of_a_result_loads_again(name):
    """Every key has a value there, and a variant its name."""
    for scene in jw.load_variants(name):
        tables = json.loads(attributes_of(scene, "dem", {})["scene"])
        again = jw.load(tables)
        assert again.model_dump() == scene.model_dump()
        assert scene_hash(again) == scene_hash(scene) and warnings(again) == warnings(scene)


def test_a_scene_is_loaded_from_a_name_a_file_or_tables():
    name, changes = "guo-li-2002/fig-03", {"time.duration": 0.02}
    found = cases.load_variant(find(name), "zeta 0.02", changes)
    assert jw.load(name, "zeta 0.02", changes) == found
    assert re.fullmatch(r"RockMass\('.*layers.toml'\)", repr(jw.load("rock-mass/layers")))
    assert {name, "hard/short-pillar"} <= set(jw.shipped())
    assert [s.name for s in jw.load_variants(name)] == [s.name for s in cases.load(find(name))]
    damped = jw.load(TABLES, "damped", {"record.stress": [3.0]})
    assert (damped.joints.damping_ratio, damped.record.stress) == (0.05, [3.0])
    assert TABLES["record"] == {"stress": [2.0]}  # as it was


def test_whatever_takes_a_scene_takes_its_file_its_name_and_its_tables(tmp_path):
    name = "beyond/ricker-one-layer"
    scene, file = jw.load(name), tmp_path / "scene.toml"
    file.write_text(find(name).read_text())
    assert jw.load(scene) is scene
    expected = jw.simulate(scene, "lattice")
    for given in (file, str(file), name):
        assert jw.simulate(given, "lattice").stress.equals(expected.stress)
        assert jw.solvers(given) == jw.solvers(scene)
        assert jw.properties(given).impedance == jw.properties(scene).impedance
        assert jw.dispersion_theory(given, [50.0]).equals(jw.dispersion_theory(scene, [50.0]))
    assert jw.simulate(TABLES).stress.equals(jw.simulate(jw.load(TABLES)).stress)
    assert "lattice" in jw.compare(TABLES).results


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: jw.load(TABLES, changes=UNEVEN), r"pillar\.block = 0\.3: must divide"),
        (lambda: jw.load(ALONE | {"name": "../up"}), r"scene: name = '../up': must be a string of"),
        (lambda: jw.simulate(3), "type = 'int': must be a file, the name of a shipped scene"),
        (lambda: jw.simulate("none.toml"), "none.toml: cannot be read"),
        (lambda: jw.simulate(TABLES, "rocks"), "'rocks' is unknown; allowed: dem,"),
        (lambda: jw.load(jw.load(TABLES), "damped"), "not of a loaded scene"),
        (lambda: jw.load_variants(TABLES), "must be a file or the name of a shipped scene"),
        (lambda: jw.plan(TABLES, misfit=0), "misfit = 0: must be a positive number"),
        (lambda: jw.ppv(3), "type = 'int': must be a result, a file, an array"),
        (lambda: jw.ppv(STEP, "speed"), "quantity = 'speed': must be one of stress"),
        (lambda: jw.arias(STEP, gravity=0.0), "gravity = 0.0: must be positive"),
        (lambda: jw.spectra(jw.simulate(MOVED), axis="q"), "axis = 'q': must be one of y"),
        (lambda: jw.transfer_function(STEP, 1), "receiver = 1: must be from -1 to 0"),
        (lambda: jw.misfit(TABLES, TABLES), "type = 'dict': must be a result"),
        (lambda: jw.ppv_map(3), "ppv_map: type = 'int': must be a result"),
        (lambda: jw.plot_map("dem.nc"), "plot_map: type = 'str': must be a result"),
        (lambda: jw.verdicts(3), "verdicts: type = 'int': must be a comparison, of `compare`"),
        (lambda: jw.figure([3]), "figure: type = 'int': must be a comparison, of `compare`"),
        (lambda: jw.figure([]), "figure: type = 'NoneType': must be a comparison"),
        (lambda: jw.simulate("nosuch"), "nosuch: is neither a file nor a shipped scene"),
        (lambda: jw.load(TABLES, {"time.duration": 0.1}), "variant = 'dict': must be the name"),
        (lambda: jw.load(TABLES, changes="a=1"), "changes = 'str': must be a dictionary"),
        (lambda: jw.load(ALONE, "damped"), "variants.name = 'damped': the scene has none"),
        (lambda: jw.compare(TABLES, ["a.csv"]), "curves = 'str': must be curves of `read_curves`"),
        (lambda: jw.fit(TABLES, "a.csv", "load.amplitude"), "fit: curves = 'str': must be curves"),
    ],
)
def test_a_wrong_argument_gives_one_line_with_what_is_allowed(call, words):
    with pytest.raises(jw.SceneError, match=words) as refused:
        call()
    assert "\n" not in str(refused.value)


def test_results_that_share_nothing_have_no_misfit():
    """Neither zero, nor a message of numpy's."""
    one, other, longer = (
        jw.simulate(jw.load(TABLES, changes=changes), "lattice")
        for changes in ({}, {"record.stress": [3.0]}, {"time.duration": 0.04})
    )
    with pytest.raises(jw.SceneError, match="the results share none"):
        jw.misfit(one, other)
    with pytest.raises(jw.SceneError, match="must have the other's samples"):
        jw.misfit(one, longer)
    assert jw.misfit(longer, one) < 1e-6


def test_a_scene_is_solved_measured_and_drawn():
    """Figures show themselves in a notebook, by the hook of IPython."""
    scene = jw.load(TABLES)
    blocks, exact = jw.simulate(scene), jw.simulate(scene, "lattice")
    assert jw.misfit(blocks, exact) == misfit(blocks, exact) > 0
    assert jw.solvers(scene)["lattice"] == "" != jw.solvers(scene)["jointed-bar"]
    assert jw.properties(scene).block_count == 10
    found = jw.compare(scene)
    assert {"dem", "lattice"} <= found.results.keys()
    drawn = jw.figure(found, width=90.0), jw.figure([found]), blocks.jw.plot()
    assert len(drawn[0].axes) == len(drawn[1].axes) == 1
    assert all(figure._repr_png_().startswith(b"\x89PNG") for figure in drawn)
    stronger = jw.simulate(jw.load(ALONE, changes={"load.amplitude": 2e6}), "lattice")
    again = blocks.jw.plot(exact, stronger, exact)
    assert [ax.get_title("left") for ax in again.axes] == [
        f"stress at y = 2 m, {which}" for which in ("base scene", "result 3", "result 4")
    ]
    peaks = [[abs(x.get_ydata()).max() for x in ax.lines[1:]] for ax in again.axes]
    assert [len(one) for one in peaks] == [2, 1, 1] and peaks[1][0] == 2 * peaks[2][0]


def test_readings_of_an_array_are_those_by_hand():
    """A bell: its peak, the square of its slope, its spectrum."""
    time, width = np.linspace(1.0, 3.0, 2001), 0.05
    bell = 3.0 * np.exp(-(((time - 2.0) / width) ** 2))
    record = (time, bell)
    assert jw.ppv(record).item() == 3.0
    slope_squared = 9.0 * np.sqrt(np.pi / 2) / width
    expected = np.pi / (2 * 9.81) * slope_squared
    assert jw.arias(record).item() == pytest.approx(expected, rel=1e-3)
    found = jw.spectra(record)[0]
    omega = 2 * np.pi * found.frequency.values
    area = 3.0 * width * np.sqrt(np.pi)
    exact = area * np.exp(-((omega * width / 2) ** 2) - 2j * omega)
    assert found.values == pytest.approx(exact, abs=1e-12 * area)
    assert found.units == "m/s/Hz" and jw.ppv(record).units == jw.arias(record).units == "m/s"


@pytest.mark.parametrize("use", [jw.simulate, jw.compare, jw.properties])
@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"record": {"stress": [6.0]}}, "record.stress = 6.0: must lie between 0 and 5 m"),
        (JOINTS, r"pillar.joints = \[2.0\]: is for files"),
    ],
)
def test_a_scene_made_in_python_is_checked_where_it_is_used(use, wrong, said):
    tables = {key: value for key, value in TABLES.items() if key != "variants"}
    with pytest.raises(cases.SceneError, match=f"^made of tables: {said}"):
        use(cases.Scene.model_validate(tables | wrong))


def test_every_name_is_there_and_documented():
    """In its docstring and on the page of the interface."""
    assert jw.Scene is cases.Scene and jw.UnstableError is cases.UnstableError
    with pytest.raises(AttributeError, match="module 'jointwave' has no attribute 'solve'"):
        _ = jw.solve
    page = (Path(__file__).parents[1] / "docs/reference/python.md").read_text(encoding="utf-8")
    shown = re.findall(r"<!-- generated: api jointwave (.*) -->", page)
    assert set(" ".join(shown).split()) | {"Scene"} == set(jw.__all__)
    assert all(callable(one) and one.__doc__ for one in (getattr(jw, n) for n in jw.__all__))


def test_importing_it_imports_nothing_else():
    """Nor does a list of its names, in which no package shows that is loaded later."""
    script = (
        "import sys, jointwave\n"
        "names = dir(jointwave)\n"
        "print(sorted({'numpy', 'xarray', 'numba', 'scipy', 'pydantic'} & set(sys.modules)))\n"
        "from jointwave.compare.runs import comparison\n"
        "assert names == dir(jointwave) == jointwave.__all__\n"
        "assert jointwave.compare is comparison.compare\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.stdout, done.returncode) == ("[]\n", 0), done.stderr
