"""The examples as pages: text, code, and outputs of the last run.

    python tools/docs/notebooks.py

runs the examples that have changed since, and saves them as out/examples/NAME.ipynb for Jupyter.
"""

import json
import re
import sys
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
KEPT = ROOT / "out" / "examples"
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)
LONGEST = 40  # lines of an output
NOT_RUN = "*What it prints and draws is shown here by `make docs`.*\n"


class Cell(NamedTuple):
    """A part of an example: its text, or its code."""

    is_text: bool
    source: str


def cells(name: str) -> list[Cell]:
    """Return the cells of an example."""
    _, *parts = CELL.split((EXAMPLES / f"{name}.py").read_text(encoding="utf-8"))
    pairs = zip(parts[::2], parts[1::2], strict=True)
    return [Cell(bool(mark), _bare(text) if mark else text.strip()) for mark, text in pairs]


def _bare(comment: str) -> str:
    return re.sub(r"^# ?", "", comment.strip(), flags=re.MULTILINE)


def page(name: str, kept: Path = KEPT) -> str:
    """Return an example as Markdown, with its outputs if the same code has been run."""
    found, outputs = cells(name), _outputs(name, kept)
    path = f"examples/{name}.py"
    head = f"A notebook in jupytext's percent format: `{path}`.\n"
    parts = [head] if outputs is not None else [head, NOT_RUN]
    code = iter(outputs or [])
    for cell in found:
        parts.append(cell.source if cell.is_text else f"```python\n{cell.source}\n```")
        if not cell.is_text:
            parts += [_shown(output) for output in _joined(next(code, []))]
    title = parts.index(found[0].source)  # the title comes first
    parts.insert(0, parts.pop(title))
    return "\n\n".join(part for part in parts if part) + "\n"


def _outputs(name: str, kept: Path) -> list[list[dict[str, Any]]] | None:
    try:
        notebook = json.loads((kept / f"{name}.ipynb").read_text(encoding="utf-8"))
    except OSError:
        return None
    code = [c for c in notebook["cells"] if c["cell_type"] == "code"]
    was = ["".join(c["source"]).strip() for c in code]
    is_same = was == [c.source for c in cells(name) if not c.is_text]
    return [c["outputs"] for c in code] if is_same else None


def _joined(outputs: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return outputs with consecutive printed texts joined."""
    found: list[dict[str, Any]] = []
    for output in outputs:
        text = "".join(output.get("text", ""))
        if text and found and "text" in found[-1]:
            found[-1]["text"] += text
        else:
            found.append({**output, "text": text} if text else output)
    return found


def _shown(output: dict[str, Any]) -> str:
    """Return an output as Markdown: a picture or text."""
    data = output.get("data", {})
    if "image/png" in data:
        picture = "".join(data["image/png"]).replace("\n", "")
        return f'<img alt="What the cell draws" src="data:image/png;base64,{picture}">'
    lines = "".join(output.get("text") or data.get("text/plain", "")).rstrip().splitlines()
    if len(lines) > LONGEST:
        lines = [*lines[:LONGEST], "..."]
    return "```text\n{}\n```".format("\n".join(lines)) if lines else ""


def run(name: str, kept: Path = KEPT) -> Path:
    """Run an example in its own kernel and save it; raises if a cell fails."""
    import jupytext
    import nbformat
    from nbclient import NotebookClient

    notebook = jupytext.read(EXAMPLES / f"{name}.py")
    kept.mkdir(parents=True, exist_ok=True)
    quiet = ["--IPKernelApp.log_level=ERROR"]  # no warning about a port open to this machine only
    client = NotebookClient(notebook, kernel_name="python3", timeout=600, extra_arguments=quiet)
    client.execute(cwd=str(kept))
    nbformat.write(notebook, kept / f"{name}.ipynb")
    return kept / f"{name}.ipynb"


def main() -> None:
    """Run the examples that have changed."""
    KEPT.mkdir(parents=True, exist_ok=True)
    for path in sorted(EXAMPLES.glob("*.py")):
        if _outputs(path.stem, KEPT) is None:
            print(f"examples: {path.stem}", file=sys.stderr)
            run(path.stem)


if __name__ == "__main__":
    main()
