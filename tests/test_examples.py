"""The shipped examples run as they stand, in a kernel too, keep their word and become pages."""

import ast
import base64
import json
import re
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.stats import binom

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py"))
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)
MEASUREMENTS = 50


@pytest.fixture
def notebooks(modules_of):
    """Return the module that makes the pages of the examples."""
    return modules_of(ROOT / "tools" / "docs")("notebooks")


def code_of(name):
    """Return the cells of code of an example."""
    _, *parts = CELL.split((EXAMPLES / f"{name}.py").read_text(encoding="utf-8"))
    return [text for mark, text in zip(parts[::2], parts[1::2], strict=True) if not mark]


@pytest.mark.parametrize("name", NAMES)
def test_an_example_runs_asserts_and_draws(name, monkeypatch, tmp_path):
    """Cell after cell; each figure holds curves, and every cell's assertions hold."""
    monkeypatch.chdir(tmp_path)
    matplotlib.use("agg")
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


def test_an_example_is_run_in_a_kernel_and_its_page_shows_what_came_out(
    notebooks, tmp_path, monkeypatch
):
    """As in Jupyter: a dataset is shown as a table, figures as pictures, nothing goes wrong."""
    pytest.importorskip("nbclient")
    pytest.importorskip("jupytext")
    pytest.importorskip("ipykernel")
    monkeypatch.delenv("MPLBACKEND", raising=False)  # which commands set in this process
    found = json.loads(notebooks.run("first-scene", tmp_path).read_text())
    code = [cell for cell in found["cells"] if cell["cell_type"] == "code"]
    assert found["cells"][0]["cell_type"] == "markdown"
    assert len(code) == len(code_of("first-scene"))
    shown = [output for cell in code for output in cell["outputs"]]
    assert not [o for o in shown if o["output_type"] == "error" or o.get("name") == "stderr"]
    (table,) = [o["data"]["text/html"] for o in shown if "text/html" in o.get("data", {})]
    assert "stress, compression positive" in "".join(table)
    page = notebooks.page("first-scene", tmp_path)
    assert page.count("data:image/png;base64,") == 2 and notebooks.NOT_RUN not in page


@pytest.fixture
def short(notebooks, tmp_path, monkeypatch):
    """An example of two cells of code, and what a notebook of it holds once it has run."""
    text = (
        "# ---\n# jupyter: {}\n# ---\n\n# %% [markdown]\n# # Title\n#\n# What $x$ is.\n\n"
        "# %%\nx = 1\nprint(x)\n\n# %% [markdown]\n# ## More\n\n# %%\nshow(x)\n"
    )
    (tmp_path / "short.py").write_text(text)
    monkeypatch.setattr(notebooks, "EXAMPLES", tmp_path)
    printed = {"output_type": "stream", "name": "stdout", "text": "1\n"}
    again = printed | {"text": "2\n" + "3\n" * notebooks.LONGEST}
    picture = base64.b64encode(b"a picture").decode()
    drawn = {"output_type": "display_data", "data": {"image/png": picture, "text/plain": "<F>"}}
    cells = [
        {"cell_type": "markdown", "source": "# Title"},
        {"cell_type": "code", "source": "x = 1\nprint(x)", "outputs": [printed, again]},
        {"cell_type": "code", "source": "show(x)", "outputs": [drawn]},
    ]
    (tmp_path / "short.ipynb").write_text(json.dumps({"cells": cells}))
    return tmp_path


def test_a_page_is_its_text_its_code_and_what_came_out(notebooks, short):
    """Long outputs end in dots; those of another version are not shown."""
    page = notebooks.page("short", short)
    parts = ["# Title", "What $x$ is.", "`examples/short.py`", "```python\nx = 1\nprint(x)\n```"]
    parts += ["```text\n1\n2\n3\n", "3\n...\n```", "## More", "```python\nshow(x)\n```"]
    places = [page.index(part) for part in [*parts, "data:image/png;base64,YSBw"]]
    assert places == sorted(places) and page.startswith("# Title") and "<F>" not in page
    assert "jupyter" not in page and notebooks.NOT_RUN not in page
    assert page.count("3\n") == notebooks.LONGEST - 2
    text = (short / "short.py").read_text()
    (short / "short.py").write_text(text.replace("x = 1", "x = 3"))
    page = notebooks.page("short", short)
    assert "x = 3" in page and notebooks.NOT_RUN in page and "```text" not in page


def test_an_example_that_fails_is_not_kept(notebooks, short):
    pytest.importorskip("jupytext")
    pytest.importorskip("ipykernel")
    exceptions = pytest.importorskip("nbclient.exceptions")
    with pytest.raises(exceptions.CellExecutionError, match="show"):
        notebooks.run("short", short / "kept")
    assert not list((short / "kept").glob("*.ipynb"))


def test_every_example_has_its_page_and_every_page_its_example(notebooks):
    """And each begins with one heading."""
    pages = {p.stem: p.read_text() for p in (ROOT / "docs" / "examples").glob("*.md")}
    assert sorted(pages) == NAMES
    for name, text in pages.items():
        assert text == f"<!-- generated: example {name} -->\n"
        made = notebooks.page(name, ROOT / "nowhere")
        assert made.startswith("# ") and "\n## " in made and "```python" in made


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
    """Of 50 measurements 40 to 50, from the binomial distribution; intervals of half the reach
    would hold it in 34, and the same bound refuses them. Fits start at the truth."""
    truth = np.log10(calibration["STIFFNESS"]), calibration["STRENGTH"]
    measured = map(calibration["measure"], range(MEASUREMENTS))
    fits = [calibration["fit"](one, start=truth) for one in measured]
    off = np.array([np.abs(np.array(one.best) - truth) / one.reach for one in fits])
    assert acceptable((off[:, 0] <= 1).sum()) and acceptable((off[:, 1] <= 1).sum())
    assert not acceptable((off[:, 0] <= 0.5).sum())
