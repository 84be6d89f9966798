"""The Python interface: functions do what those behind them do, and cost nothing before."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import jointwave as jw
from jointwave import cases
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.misfit.places import Place
from jointwave.compare.scenes import find

TABLES = {
    "title": "made of tables",
    "pillar": {"length": 5.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
    "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
    "time": {"duration": 0.03},
    "record": {"stress": [2.0]},
    "variants": [{"name": "damped", "joints": {"damping_ratio": 0.05}}],
}


def test_a_scene_is_loaded_from_a_name_a_file_or_tables(tmp_path):
    name = "guo-li-2002/fig-03"
    changes = {"time.duration": 0.02}
    assert jw.load(name, "zeta 0.02", changes) == cases.load_variant(
        find(name), "zeta 0.02", changes
    )
    assert {name, "hard/short-pillar"} <= set(jw.shipped())
    assert [s.name for s in jw.load_variants(name)] == [s.name for s in cases.load(find(name))]
    damped = jw.load(TABLES, "damped", {"record.stress": [3.0]})
    assert (damped.joints.damping_ratio, damped.record.stress) == (0.05, [3.0])
    assert TABLES["record"] == {"stress": [2.0]}  # as it was
    with pytest.raises(jw.SceneError, match=r"scene: pillar\.block = 0\.3: must divide"):
        jw.load(TABLES, changes={"pillar.block": 0.3})


def test_a_scene_is_solved_measured_and_drawn():
    scene = jw.load(TABLES)
    blocks, exact = jw.simulate(scene), jw.simulate(scene, "lattice")
    assert jw.misfit(blocks, exact) == misfit(blocks, exact) > 0
    assert jw.solvers(scene)["lattice"] == "" != jw.solvers(scene)["jointed-bar"]
    assert jw.properties(scene).block_count == 10
    found = jw.compare(scene)
    assert {"dem", "lattice"} <= found.results.keys()
    assert len(jw.figure([found], width=90.0).axes) == 1


def test_keys_are_fitted_and_numerics_planned():
    scene = jw.load(TABLES)
    heard = jw.simulate(jw.load(TABLES, changes={"load.amplitude": 2e6}), "lattice")
    noise = np.random.default_rng(0).normal(scale=1e3, size=heard.time.size)
    curve = Curves(
        "gauge",
        "gauge",
        heard.time.values,
        {Place("stress", "", (2.0,)): heard.stress.values[0] + noise},
    )
    found = jw.fit(scene, [curve], ["load.amplitude"]).values
    assert found.value["load.amplitude"] == pytest.approx(2e6, rel=1e-3)
    assert jw.plan(scene, misfit=0.05).misfit <= 0.05


def test_names_that_are_not_there_are_no_attributes():
    assert jw.Scene is cases.Scene and jw.UnstableError is cases.UnstableError
    with pytest.raises(AttributeError, match="module 'jointwave' has no attribute 'solve'"):
        _ = jw.solve
    assert all(callable(getattr(jw, name)) for name in jw.__all__)


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


def test_every_name_is_documented():
    """In its docstring and on the page of the interface."""
    page = (Path(__file__).parents[1] / "docs/reference/python.md").read_text(encoding="utf-8")
    shown = re.findall(r"<!-- generated: api jointwave (.*) -->", page)
    assert set(" ".join(shown).split()) | {"Scene"} == set(jw.__all__)
    assert all(getattr(jw, name).__doc__ for name in jw.__all__)
