"""Estimates of `--dry-run`: steps exact, sizes exact, memory within a factor."""

import json
import tracemalloc
from types import SimpleNamespace

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.run_memory import estimates, refuse_beyond_memory
from jointwave.cases.size import LIMIT
from jointwave.compare.engines import solve
from jointwave.compare.runs import timings
from jointwave.compare.studies.forecast import Run, forecast, forecasts
from jointwave.compare.studies.step_cost import step_costs

SHORT = {"time__duration": 0.01, "record__velocity": [20.25]}
SPACE = {"load__direction": [0.6, 0.8, 0.0]}
SCENE = "guo-li-2002/fig-03"


def foretold(run):
    """Return the estimate of a run."""
    return SimpleNamespace(**forecast(run))


def stepping(scene, name):
    """Return the seconds of stepping that are foretold for a run."""
    return foretold(Run("", scene, name)).stepping


RUNS = {
    "blocks": ("dem", {}),
    "damped blocks": ("dem", {"joints__damping_ratio": 0.05}),
    "blocks of fourth order": ("dem", {"numerics__dem__scheme": "fourth-order"}),
    "blocks in space": ("dem", SPACE),
    "jointed rock": ("continuum-jointed", {}),
    "homogenised rock": ("continuum-equivalent", {}),
    "implicit rock": ("continuum-jointed", {"numerics__continuum__scheme": "implicit"}),
    "an exact solution": ("lattice", {}),
}


@pytest.mark.parametrize("name", RUNS)
def test_steps_and_size_are_those_of_the_run(pillar, name):
    engine, changes = RUNS[name]
    scene = pillar(**SHORT, **changes)
    found, result = foretold(Run("", scene, engine)), solve(engine, scene)
    assert found.steps == result.attrs.get("steps", 0)
    assert found.bytes > 0 and found.seconds > 0 and found.stepping is None
    if engine == "dem":
        assert found.size == "100 blocks"
    elif engine.startswith("continuum-"):
        assert found.size == f"{result.attrs['degrees_of_freedom']:,} freedoms"
        assert found.scheme == result.attrs["scheme"]


@pytest.mark.parametrize(
    "engine, changes",
    [
        ("dem", {"pillar__length": 50_000.0}),
        ("dem", {"record__interval": 1e-8, "numerics__dem__step_fraction": 0.5}),
        ("dem", {"pillar__length": 10_000.0, **SPACE}),
        ("continuum-jointed", {"pillar__length": 5000.0}),
        ("continuum-equivalent", {"record__interval": 1e-8}),
    ],
)
def test_memory_is_what_the_arrays_take_within_a_factor_of_three(pillar, engine, changes):
    """Relative to the peak of Python's arrays, by tracemalloc, the cut into blocks included."""
    given = {**SHORT, "time__duration": 2e-3, "record__energy": False, **changes}
    solve(engine, pillar(**given))  # compiled, imported
    scene = pillar(**given)
    tracemalloc.start()
    solve(engine, scene)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most > 2e6
    assert most / 3 <= foretold(Run("", scene, engine)).bytes <= 3 * most


def test_a_run_beyond_the_memory_is_refused_as_the_run_would_be(pillar, monkeypatch):
    scene = pillar(record__interval=1e-6, time__duration=1.0, load__period=0.01)
    monkeypatch.setenv(LIMIT, "0.1")
    for name in ("dem", "continuum-jointed"):
        with pytest.raises(SceneError, match="would need about") as told:
            foretold(Run("", scene, name))
        with pytest.raises(SceneError) as refused:
            solve(name, scene)
        assert str(told.value) == str(refused.value)


def test_estimates_are_collected_by_their_keys(pillar):
    with estimates() as parts:
        refuse_beyond_memory(pillar(), {"a": 1.0, "b": 2.0})
        refuse_beyond_memory(pillar(), {"b": 3.0, "c": 4.0})
    refuse_beyond_memory(pillar(), {"d": 1.0})
    assert parts == {"a": 1.0, "b": 3.0, "c": 4.0}


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
def test_time_is_that_of_the_last_run_of_the_kind(pillar, engine):
    """Proportional to steps and size; no estimate for another kind of run."""
    scene = pillar(**SHORT)
    about = dict(solve(engine, scene).attrs) | {"seconds_stepping": 2.0}
    timings.note(engine, scene, about)
    assert stepping(scene, engine) == pytest.approx(2.0)
    longer = pillar(**SHORT | {"time__duration": 0.02})
    assert stepping(longer, engine) == pytest.approx(4.0, rel=0.01)
    assert stepping(pillar(**SHORT, joints__damping_ratio=0.1), engine) is None
    timings.note(engine, scene, about | {"seconds_stepping": 1e-3})  # too short to tell
    assert stepping(scene, engine) == pytest.approx(2.0)
    timings.note(engine, scene, about | {"seconds_stepping": 8.0, "seconds_compile": 1.0}, 11.0)
    found = foretold(Run("", scene, engine, 3))
    assert found.stepping == pytest.approx(8.0) and found.setup == pytest.approx(2.0)
    assert found.seconds == pytest.approx(3 * (8.0 + 2.0))


def test_an_exact_solution_has_the_time_of_its_own_scene(pillar):
    """Or of another one of the kind, in proportion to its waveforms."""
    scene = pillar(**SHORT)
    timings.note("lattice", scene, {}, 0.5)
    assert stepping(scene, "lattice") == 0.5
    longer = pillar(**SHORT | {"time__duration": 0.02})
    assert stepping(longer, "lattice") == pytest.approx(1.0, rel=0.01)
    assert stepping(pillar(**SHORT, ends__end="quiet"), "lattice") is None
    table, _ = forecasts([Run("", scene, "lattice"), Run("", scene, "images")])
    assert table.seconds[0] == 0.5 and table.stepping.isna().sum() == 1


def test_what_was_never_timed_is_timed_on_its_first_steps(pillar):
    scene = pillar(**SHORT)
    runs = [Run("", scene, name) for name in ("dem", "continuum-jointed", "lattice")]
    table, _ = forecasts(runs, spare=60.0)
    assert table.stepping.notna().all() and (table.seconds < 60).all()
    table, _ = forecasts([Run("", pillar(**SHORT, ends__end="quiet"), "dem")])
    assert table.stepping.isna().all() and (table.seconds > 0).all()


def test_snapshots_take_longer_and_their_files_more(pillar):
    scene = pillar(**SHORT, record__fields=1e-3)
    plain, shown = foretold(Run("", pillar(**SHORT), "dem")), foretold(Run("", scene, "dem"))
    assert plain.stepping == shown.stepping
    filed = foretold(Run("", scene, "dem", for_paraview=True))
    assert plain.seconds - plain.setup < shown.seconds - shown.setup < filed.seconds - filed.setup


def test_what_is_read_costs_nothing(pillar):
    table, _ = forecasts([Run("", pillar(**SHORT), "dem", is_read=True)])
    assert table.empty


def test_what_explain_measures_is_known(pillar):
    scene = pillar(**SHORT)
    assert stepping(scene, "dem") is None
    (found,) = step_costs([scene])
    assert 0 < found.ns < 1e4 and found.noise >= 0
    told = foretold(Run("", scene, "dem"))
    assert told.stepping > 0.5e-9 * found.ns * 100 * told.steps


def test_a_broken_or_protected_file_of_rates_costs_nothing(pillar, tmp_path, monkeypatch):
    timings._file().write_text("[1, 2")
    assert stepping(pillar(**SHORT), "dem") is None
    (tmp_path / "no-folder").write_text("")
    monkeypatch.setattr(timings, "_file", lambda: tmp_path / "no-folder" / "rates.json")
    timings.note("lattice", pillar(**SHORT), {}, 0.5)
    assert stepping(pillar(**SHORT), "lattice") is None


@pytest.fixture
def dry(tmp_path, command):
    """Return a function that gives a command's estimates, and checks that it writes nothing."""

    def run(*arguments, code=0):
        said = command(*arguments, "--dry-run", code=code)
        assert not list(tmp_path.iterdir())
        return said

    return run


def test_nothing_is_run_or_written(dry):
    """For every command: only estimates are printed."""
    said = dry("run", SCENE, "--engine", "dem", "--engine", "continuum").out
    assert "12 would run" in said and "7,200" in said and "100 blocks" in said
    said = dry("compare", SCENE, "--variant", "").out
    assert "8 would run" in said and "rigid blocks, exact" in said
    assert "figures: 1 in" in dry("figure", SCENE, "--variant", "", "--out", "a.pdf").out
    assert "frames: 201 in" in dry("animate", SCENE).out
    assert "2 would run" in dry("view", SCENE).out


def test_a_fit_is_told_before_its_search(command, tmp_path):
    curve = tmp_path / "curve.csv"
    rows = "".join(f"{i / 100},{i % 5}\n" for i in range(12))
    curve.write_text(f"time [s],stress@20 [MPa]\n{rows}")
    options = ("--with", curve, "--free", "load.amplitude", "--dry-run")
    assert "20 would run" in command("fit", SCENE, *options).out
    assert list(tmp_path.iterdir()) == [curve]


def test_every_point_of_a_sweep_is_told_and_which_would_fail(dry):
    options = ("--sweep", "joints.damping_ratio=-1,0.1", "--variant", "", "--json")
    facts = json.loads(dry("run", SCENE, *options).out)
    assert [run["point"] for run in facts["runs"]] == ["joints.damping_ratio=0.1"]
    (failing,) = facts["failing"]
    assert "must be at least 0" in failing["message"]


def test_a_scene_that_cannot_run_is_one_line(dry):
    said = dry("run", SCENE, "--set", "numerics.dem.step_fraction=1.5", code=2).err
    assert said.count("\n") == 1 and "critical step" in said
