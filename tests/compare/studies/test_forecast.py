"""Estimates of `--dry-run`: steps and sizes exact, memory within a factor; the cost of a step."""

import json
import tracemalloc
from types import SimpleNamespace

import pytest

from jointwave import cases
from jointwave.cases.effects import effects
from jointwave.cases.errors import SceneError
from jointwave.cases.read import load_tables
from jointwave.cases.size import LIMIT
from jointwave.compare.engines import ENGINES, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.scenes import find
from jointwave.compare.studies import step_cost
from jointwave.compare.studies.forecast import Run, forecast, forecasts
from jointwave.compare.studies.step_cost import step_costs, with_every_effect

SHORT = {"time__duration": 0.01, "record__velocity": [20.25]}
SPACE = {"load__direction": [0.6, 0.8, 0.0]}
SCENE = "guo-li-2002/fig-03"


def foretold(name, scene, *more, **about):
    return SimpleNamespace(**forecast(Run("", scene, name, *more, **about)))


IMPLICIT = {"numerics__continuum__scheme": "implicit"}
PREPARED = [
    *((name, kind, {}) for name in ENGINES for kind in ("pillar", "rock mass")),
    ("dem", "pillar", SPACE),
    ("dem", "pillar", {"numerics__dem__scheme": "fourth-order"}),
    ("continuum-jointed", "pillar", IMPLICIT),
]


@pytest.mark.parametrize("name, kind, changes", PREPARED)
def test_a_run_is_prepared_and_foretold_as_it_is_made(pillar, one_joint, name, kind, changes):
    scene = pillar(**SHORT, **changes)
    if kind == "rock mass":
        tables = one_joint(numerics={"dem": {"block": 4.0, "threads": 2}}, time={"duration": 2e-3})
        tables["joint_sets"][0]["spacing"] = 5.0
        scene = load_tables(tables)
    found, made = solver(name).prepare(scene), solve(name, scene).attrs
    keys = ("steps", "dt", "critical_dt", "degrees_of_freedom", "scheme")
    prepared = found.steps, found.dt, found.critical, found.freedoms, found.scheme
    assert prepared == tuple(made[key] for key in keys) and found.bytes > 0
    settings = {"processes": 1} | dict(found.settings)  # their number is the command's
    assert all(made[key] == settings[key] for key in solver(name).cost)
    told = foretold(name, scene)
    assert (told.steps, told.scheme) == (made["steps"], made["scheme"])


@pytest.mark.parametrize(
    "engine, changes",
    [
        ("dem", {"pillar__length": 3000.0, **SPACE}),
        ("continuum-jointed", {"pillar__length": 2000.0}),
    ],
)
def test_memory_is_what_the_arrays_take_within_a_factor_of_three(pillar, engine, changes):
    """Relative to the peak of Python's arrays, by tracemalloc, the cut into blocks included."""
    given = {**SHORT, "time__duration": 2e-3, "record__energy": False, **changes}
    solve(engine, pillar(**given | {"pillar__length": 50.0}))  # compiled, imported
    scene = pillar(**given)
    tracemalloc.start()
    solve(engine, scene)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most > 2e6 and most / 3 <= foretold(engine, scene).bytes <= 3 * most


def test_a_run_beyond_the_memory_is_refused_as_the_run_would_be(pillar, monkeypatch):
    scene = pillar(record__interval=1e-6, time__duration=1.0, load__period=0.01)
    monkeypatch.setenv(LIMIT, "0.1")
    for name in ("dem", "continuum-jointed"):
        with pytest.raises(SceneError, match="would need about") as told:
            foretold(name, scene)
        with pytest.raises(SceneError) as refused:
            solve(name, scene)
        assert str(told.value) == str(refused.value)


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
def test_time_is_that_of_the_last_run_of_the_kind(pillar, engine):
    scene, other = pillar(**SHORT), pillar(**SHORT, joints__damping_ratio=0.1)
    longer = pillar(**SHORT | {"time__duration": 0.02})
    about = dict(solve(engine, scene).attrs) | {"seconds_stepping": 2.0}
    timings.note(engine, scene, about)
    assert foretold(engine, scene).stepping == pytest.approx(2.0)
    assert foretold(engine, longer).stepping == pytest.approx(4.0, rel=0.01)
    assert foretold(engine, other).stepping is None
    timings.note(engine, scene, about | {"seconds_stepping": 1e-3})  # too short to tell
    assert foretold(engine, scene).stepping == pytest.approx(2.0)
    timings.note(engine, scene, about | {"seconds_stepping": 8.0, "seconds_compile": 1.0}, 11.0)
    found = foretold(engine, scene, 3)
    assert found.stepping == pytest.approx(8.0) and found.setup == pytest.approx(2.0)
    assert found.seconds == pytest.approx(3 * (8.0 + 2.0))


def test_an_exact_solution_has_the_time_of_its_own_scene(pillar):
    """Or of another one of the kind, in proportion to its waveforms."""
    scene, longer = pillar(**SHORT), pillar(**SHORT | {"time__duration": 0.02})
    timings.note("lattice", scene, {}, 0.5)
    assert foretold("lattice", scene).stepping == 0.5
    assert foretold("lattice", longer).stepping == pytest.approx(1.0, rel=0.01)
    assert foretold("lattice", pillar(**SHORT, ends__end="quiet")).stepping is None
    table, _ = forecasts([Run("", scene, "lattice"), Run("", scene, "images")])
    assert table.seconds[0] == 0.5 and table.stepping.isna().sum() == 1


def test_what_was_never_timed_is_timed_on_its_first_steps(pillar):
    scene, quiet = pillar(**SHORT), pillar(**SHORT, ends__end="quiet")
    runs = [Run("", scene, name) for name in ("dem", "continuum-jointed", "lattice")]
    table, _ = forecasts(runs, spare=60.0)
    assert table.stepping.notna().all() and (table.seconds < 60).all()
    table, _ = forecasts([Run("", quiet, "dem")])
    assert table.stepping.isna().all() and (table.seconds > 0).all()
    assert forecasts([Run("", quiet, "dem", is_read=True)])[0].empty


def test_snapshots_take_longer_and_their_files_more(pillar):
    scene, plain = pillar(**SHORT, record__fields=1e-3), foretold("dem", pillar(**SHORT))
    shown, filed = foretold("dem", scene), foretold("dem", scene, for_paraview=True)
    assert plain.stepping == shown.stepping
    assert plain.seconds - plain.setup < shown.seconds - shown.setup < filed.seconds - filed.setup


def test_a_broken_or_protected_file_of_rates_costs_nothing(pillar, tmp_path, monkeypatch):
    timings._file().write_text("[1, 2")
    assert foretold("dem", pillar(**SHORT)).stepping is None
    (tmp_path / "no-folder").write_text("")
    monkeypatch.setattr(timings, "_file", lambda: tmp_path / "no-folder" / "rates.json")
    timings.note("lattice", pillar(**SHORT), {}, 0.5)
    assert foretold("lattice", pillar(**SHORT)).stepping is None


@pytest.fixture
def dry(tmp_path, command):
    """Return a function that gives a command's estimates, and checks that it writes nothing."""

    def run(*arguments, code=0):
        before = sorted(tmp_path.iterdir())
        said = command(*arguments, "--dry-run", code=code)
        assert sorted(tmp_path.iterdir()) == before
        return said

    return run


def test_nothing_is_run_or_written(dry, tmp_path):
    said = dry("run", SCENE, "--variant", "", "--engine", "dem", "--engine", "continuum").out
    assert "3 would run" in said and "7,200" in said and "100 blocks" in said
    assert "4 would run" in dry("run", SCENE, "--engine", "exact", "--model", "lattice").out
    said = dry("compare", SCENE, "--variant", "").out
    assert "8 would run" in said and "rigid blocks, exact" in said
    assert "figures: 1 in" in dry("figure", SCENE, "--variant", "", "--out", "a.pdf").out
    assert "frames: 201 in" in dry("animate", SCENE).out
    assert "2 would run" in dry("view", SCENE).out
    rows = "".join(f"{i / 100},{i % 5}\n" for i in range(12))
    (tmp_path / "curve.csv").write_text(f"time [s],stress@20 [MPa]\n{rows}")
    options = ("--with", "curve.csv", "--free", "load.amplitude")
    assert "20 would run" in dry("fit", SCENE, *options).out


def test_what_would_fail_is_told(dry):
    options = ("--sweep", "joints.damping_ratio=-1,0.1", "--variant", "", "--json")
    facts = json.loads(dry("run", SCENE, *options).out)
    assert [run["point"] for run in facts["runs"]] == ["joints.damping_ratio=0.1"]
    (failing,) = facts["failing"]
    assert "must be at least 0" in failing["message"]
    said = dry("run", SCENE, "--set", "numerics.dem.step_fraction=1.5", code=2).err
    assert said.count("\n") == 1 and "critical step" in said
    coarse = (f"--set=numerics.{engine}.step_fraction=1.5" for engine in ("dem", "continuum"))
    facts = json.loads(dry("compare", SCENE, "--variant", "", "--all", "--json", *coarse).out)
    failing = {one["point"]: one["message"] for one in facts["failing"]}
    assert set(failing) == {"dem", "continuum-jointed", "continuum-equivalent"}
    assert all("critical step" in message for message in failing.values())
    assert {run["scheme"] for run in facts["runs"]} == {"exact"}


def test_the_least_of_runs_in_turns_counts_and_is_known(monkeypatch):
    """Whatever else the machine does meanwhile: runs of six turns take three times as long, and
    the median with them."""
    turns, solve, costs = [], step_cost.solve, {100: 2e-9, 50: 3e-8}

    def slowed(name, scene):
        result, blocks = solve(name, scene), scene.block_count
        turn = turns.count(blocks)
        turns.append(blocks)
        steps = result.attrs["steps"] * blocks
        result.attrs["seconds_stepping"] = costs[blocks] * steps * (3 if turn in range(2, 8) else 1)
        return result

    monkeypatch.setattr(step_cost, "solve", slowed)
    scenes = [cases.load_variant(find(SCENE), "", {"pillar.length": x}) for x in (50.0, 25.0)]
    found = [x for cost in step_costs(scenes) for x in cost]
    assert found == pytest.approx([2.0, 4.0, 30.0, 60.0])
    assert turns == [100, 50] * (1 + step_cost.REPEATS)


def test_every_effect_is_measured_once_in_as_many_blocks(monkeypatch):
    """A step has a cost of its own, which few blocks share; a thousand hardly feel it."""
    timed = []
    monkeypatch.setattr(step_cost, "_every_effect", {})
    monkeypatch.setattr(step_cost, "step_costs", lambda some: timed.extend(some) or [len(timed)])
    for blocks, count in ((2, 1), (2, 1), (100, 2), (10**4, 3)):
        changes = {"pillar.length": 0.5 * blocks, "record.stress": [0.0]}
        scene = cases.load_variant(find(SCENE), "", changes)
        assert step_cost.cost_of_every_effect(scene) == count
    assert [one.block_count for one in timed] == [2, 100, 1000]


@pytest.mark.slow  # it compiles the largest kernels
@pytest.mark.parametrize("name", [SCENE, "rock-mass/brickwork"])
def test_scenes_with_every_effect_run(name):
    assert step_costs([with_every_effect(cases.load_variant(find(name)))])[0].ns > 0


def test_every_effect_that_can_be_beside_others_is_there():
    """In a rock mass all but periodic and roller sides and, since blocks are rigid, a quality
    factor; in a pillar also but those that exclude others of it."""
    pillar = with_every_effect(cases.load_variant(find(SCENE)))
    off = {one.name for one in effects(pillar) if not one.active}
    excluded = {"no tension", "rate and state", "fixed ends", "prestress", "shaken base"}
    other = {"segments", "scatter", "field output", "local damping", "constant Q"}
    assert off == excluded | other
    mass = with_every_effect(cases.load_variant(find("rock-mass/brickwork")))
    off = {one.name for one in effects(mass) if not one.active}
    assert off == {"periodic sides", "roller sides", "field output", "constant Q"}
