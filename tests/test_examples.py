"""The shipped examples run as they stand, in a kernel and as plain Python, and keep their word."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.stats import binom

EXAMPLES = Path(__file__).parents[1] / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py"))
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)
MEASUREMENTS = 100


def code_of(name):
    """Return the cells of code of an example."""
    _, *parts = CELL.split((EXAMPLES / f"{name}.py").read_text(encoding="utf-8"))
    return [text for mark, text in zip(parts[::2], parts[1::2], strict=True) if not mark]


@pytest.fixture
def no_windows(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    matplotlib.use("agg")
    yield
    plt.close("all")


@pytest.mark.parametrize("name", NAMES)
def test_an_example_runs_asserts_and_draws(name, no_windows, monkeypatch):
    """Cell after cell; each figure holds curves, and every cell's assertions hold."""
    figures = []

    def show():
        figures.extend(ax for number in plt.get_fignums() for ax in plt.figure(number).axes)
        plt.close("all")

    monkeypatch.setattr(plt, "show", show)
    space = {"__name__": "__main__"}
    for cell in code_of(name):
        drawn, tree = len(figures), ast.parse(cell)
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else ast.parse("None").body[0]
        exec(compile(tree, f"{name}.py", "exec"), space)
        if isinstance(found := eval(ast.unparse(last), space), Figure):
            figures += found.axes  # a notebook shows it
    assert any("assert " in cell for cell in code_of(name))
    assert figures and all(ax.lines or ax.collections for ax in figures)
    assert len(figures) > drawn  # it ends in a picture


def test_an_example_runs_in_a_kernel_and_shows_what_it_makes(tmp_path):
    """As in Jupyter: a dataset is shown as a table, figures as pictures, nothing goes wrong."""
    jupytext = pytest.importorskip("jupytext")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = jupytext.read(EXAMPLES / "first-scene.py")
    kinds = [cell.cell_type for cell in notebook.cells]
    assert kinds[0] == "markdown" and kinds.count("code") == len(code_of("first-scene"))
    client = nbclient.NotebookClient(notebook, kernel_name="python3", timeout=600)
    client.execute(cwd=str(tmp_path))
    shown = [o for c in notebook.cells if c.cell_type == "code" for o in c.outputs]
    assert not [o for o in shown if o.output_type == "error" or o.get("name") == "stderr"]
    data = [o.data for o in shown if "data" in o]
    assert sum("image/png" in d for d in data) == 2
    (table,) = [d["text/html"] for d in data if "text/html" in d]
    assert "stress, compression positive" in table


def test_plain_python_runs_an_example_too(tmp_path):
    """Without Jupyter, from any folder."""
    command = [sys.executable, EXAMPLES / "own-scene.py"]
    environment = os.environ | {"MPLBACKEND": "agg"}
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert "reflected 5" in done.stdout and not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def calibration():
    """What the example of the calibration defines, without what it then does."""
    space = {}
    for cell in code_of("calibrate-joint-stiffness"):
        if "\ndef " in f"\n{cell}":
            exec(re.split("^(?:measured|inside) = ", cell, flags=re.MULTILINE)[0], space)
    return space


def acceptable(inside, confidence=0.95, chance=1e-4):
    """Return whether so many of MEASUREMENTS intervals may hold the truth, but for a chance."""
    low, high = binom.ppf([chance / 2, 1 - chance / 2], MEASUREMENTS, confidence)
    return low <= inside <= high


def test_intervals_hold_the_true_stiffness_as_often_as_they_say(calibration):
    """Of 100 measurements 85 to 100, from the binomial distribution; intervals of half the reach
    would hold it in 67, and the same bound refuses them. Fits start at the truth, near which each
    ends."""
    truth = np.log10(calibration["STIFFNESS"])
    start = truth, calibration["STRENGTH"]
    measured = map(calibration["measure"], range(MEASUREMENTS))
    fits = [calibration["fit"](one, start=start) for one in measured]
    off = np.array([abs(one.best[0] - truth) / one.reach[0] for one in fits])
    assert acceptable((off <= 1).sum())
    assert not acceptable((off <= 0.5).sum())
    strengths = np.array([abs(one.best[1] - calibration["STRENGTH"]) for one in fits])
    assert acceptable((strengths <= [one.reach[1] for one in fits]).sum())


def test_the_reach_follows_the_confidence_and_the_noise(calibration):
    """Student's quantile at 68 and 95 %; without noise nothing is left to doubt."""
    measured = calibration["measure"](1)
    wide, narrow = calibration["fit"](measured), calibration["fit"](measured, confidence=0.68)
    assert wide.reach / narrow.reach == pytest.approx(1.966 / 0.9957, rel=1e-3)
    clean = calibration["waveform"]((np.log10(calibration["STIFFNESS"]), calibration["STRENGTH"]))
    exact = calibration["fit"](clean)
    assert exact.best == pytest.approx([np.log10(4e8), 1.3], rel=1e-6)
    assert (exact.reach < 1e-3 * wide.reach).all()
