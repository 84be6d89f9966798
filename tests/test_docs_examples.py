"""The pages of the examples: all of their text and code, outputs of the very version that ran."""

import base64
import importlib
import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOOLS = ROOT / "tools" / "docs"


@pytest.fixture
def examples(monkeypatch):
    monkeypatch.syspath_prepend(str(TOOLS))
    yield importlib.import_module("notebooks")
    sys.modules.pop("notebooks")


@pytest.fixture
def short(examples, tmp_path, monkeypatch):
    """An example of two cells of code, and what a notebook of it holds once it has run."""
    text = (
        "# ---\n# jupyter: {}\n# ---\n\n# %% [markdown]\n# # Title\n#\n# What $x$ is.\n\n"
        "# %%\nx = 1\nprint(x)\n\n# %% [markdown]\n# ## More\n\n# %%\nshow(x)\n"
    )
    (tmp_path / "short.py").write_text(text)
    monkeypatch.setattr(examples, "EXAMPLES", tmp_path)
    printed = {"output_type": "stream", "name": "stdout", "text": "1\n"}
    again = printed | {"text": "2\n"}
    picture = base64.b64encode(b"a picture").decode()
    drawn = {"output_type": "display_data", "data": {"image/png": picture, "text/plain": "<F>"}}
    cells = [
        {"cell_type": "markdown", "source": "# Title"},
        {"cell_type": "code", "source": "x = 1\nprint(x)", "outputs": [printed, again]},
        {"cell_type": "code", "source": "show(x)", "outputs": [drawn]},
    ]
    (tmp_path / "short.ipynb").write_text(json.dumps({"cells": cells}))
    return tmp_path


def test_a_page_is_its_text_its_code_and_what_came_out(examples, short):
    page = examples.page("short", short)
    order = [
        "# Title",
        "What $x$ is.",
        "`examples/short.py`",
        "```python\nx = 1\nprint(x)\n```",
    ]
    order += [
        "```text\n1\n2\n```",
        "## More",
        "```python\nshow(x)\n```",
        "data:image/png;base64,YSBw",
    ]
    places = [page.index(part) for part in order]
    assert places == sorted(places) and page.startswith("# Title") and "<F>" not in page
    assert "jupyter" not in page and examples.NOT_RUN not in page


def test_outputs_of_another_version_are_not_shown(examples, short):
    text = (short / "short.py").read_text()
    (short / "short.py").write_text(text.replace("x = 1", "x = 3"))
    page = examples.page("short", short)
    assert "x = 3" in page and examples.NOT_RUN in page and "```text" not in page


def test_long_outputs_end_in_dots(examples):
    shown = examples._shown({"text": "line\n" * 100})
    assert shown.count("line") == examples.LONGEST and shown.endswith("...\n```")


def test_every_example_has_its_page_and_every_page_its_example(examples):
    """And each begins with one heading."""
    pages = {p.stem: p.read_text() for p in (ROOT / "docs" / "examples").glob("*.md")}
    assert set(pages) == {path.stem for path in examples.EXAMPLES.glob("*.py")}
    for name, text in pages.items():
        assert text == f"<!-- generated: example {name} -->\n"
        made = examples.page(name, ROOT / "nowhere")
        assert made.startswith("# ") and "\n## " in made and "```python" in made


def test_an_example_is_run_as_a_notebook_and_kept(examples, short):
    """In a real kernel: what it prints is in the page afterwards; one that fails is not kept."""
    pytest.importorskip("nbclient")
    pytest.importorskip("jupytext")
    pytest.importorskip("ipykernel")
    from nbclient.exceptions import CellExecutionError

    kept = short / "kept"
    with pytest.raises(CellExecutionError, match="show"):
        examples.run("short", kept)
    assert not list(kept.glob("*.ipynb"))
    text = (short / "short.py").read_text()
    (short / "short.py").write_text(text.replace("show(x)", "print(x + 41)"))
    examples.run("short", kept)
    assert "```text\n42\n```" in examples.page("short", kept)
