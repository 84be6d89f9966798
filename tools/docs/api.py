"""The Python interface as a page: signatures and docstrings, read without importing anything."""

import ast
import re
from pathlib import Path

Documented = ast.FunctionDef | ast.ClassDef
#: A line of a docstring that describes a parameter or attribute: `name, other : what`.
ENTRY = re.compile(r"^(\w[\w, *]*) : (.*)$")
UNDERLINE = re.compile(r"^-{3,}$")


def page(root: Path, line: str) -> str:
    """Return the public functions and classes of a module; `line` is its dotted name, then names.

    Without names, all that are public and have a docstring.
    """
    module, *wanted = line.split()
    tree = ast.parse((root / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8"))
    found = {n.name: n for n in tree.body if isinstance(n, Documented)}
    names = wanted or [name for name in found if not name.startswith("_")]
    return "\n\n".join(_entry(module, found[name]) for name in names)


def _entry(module: str, node: Documented) -> str:
    text = ast.get_docstring(node) or ""
    parts = [f"### `{module}.{node.name}` {{ #{module}.{node.name} }}", _signature(node)]
    parts.append(as_markdown(text))
    if isinstance(node, ast.ClassDef):
        parts += [_member(m) for m in node.body if isinstance(m, ast.FunctionDef) and _shown(m)]
    return "\n\n".join(part for part in parts if part)


def _shown(node: ast.FunctionDef) -> bool:
    return not node.name.startswith("_") and ast.get_docstring(node) is not None


def _signature(node: Documented) -> str:
    if isinstance(node, ast.ClassDef):
        fields = [n for n in node.body if isinstance(n, ast.AnnAssign) and n.target.id[0] != "_"]
        lines = [f"    {ast.unparse(field)}" for field in fields]
        return "\n".join(["```text", f"class {node.name}", *lines, "```"])
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    arguments = ast.unparse(node.args).split(", ")
    call = f"{node.name}({', '.join(arguments)}){returns}"
    if len(call) > 90:
        call = f"{node.name}(\n    " + _broken(node.args) + f"\n){returns}"
    return f"```text\n{call}\n```"


def _broken(arguments: ast.arguments) -> str:
    """Return the arguments a line each; commas within brackets stay where they are."""
    return re.sub(r", (?=\w+(?:: |=|$)|\*)", ",\n    ", ast.unparse(arguments))


def _member(node: ast.FunctionDef) -> str:
    return f"`{node.name}`\n:   {(ast.get_docstring(node) or '').splitlines()[0]}"


def as_markdown(docstring: str) -> str:
    """Return a docstring as Markdown: entries as a list, headings bold, formulas as code."""
    lines: list[str] = []
    for line in docstring.splitlines():
        if UNDERLINE.match(line):
            lines[-1:] = [f"**{lines[-1]}**", ""]
        elif entry := ENTRY.match(line):
            if lines and lines[-1] and not lines[-1].startswith(("- ", "    ")):
                lines.append("")
            lines.append(f"- `{entry[1]}`: {entry[2]}")
        else:
            lines.append(line)
    return "\n".join(lines)
