"""The Python interface as a page: signatures and docstrings, from sources without importing."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

Documented = ast.FunctionDef | ast.ClassDef
#: A line of a docstring that describes parameters or attributes: `name, other : what`.
ENTRY = re.compile(r"^(\w[\w, *]*) : (.*)$")
#: A second description in the same line.
SECOND = re.compile(r"\. (\w+(?:, \w+)*) : ")
UNDERLINE = re.compile(r"^-{3,}$")


def page(root: Path, line: str) -> str:
    """Return the public functions and classes of a module as Markdown.

    line : the module's dotted name, optionally `as` and the module that users import, then the
        names to document, defined or imported there.
    """
    module, *wanted = line.split()
    shown, wanted = (wanted[1], wanted[2:]) if wanted[0] == "as" else (module, wanted)
    return "\n\n".join(_entry(shown, _definition(root, module, name)) for name in wanted)


def _definition(root: Path, module: str, name: str) -> Documented:
    """Return the definition of a name in a module, or in the module that it imports it from."""
    at = root / module.removeprefix("jointwave.").replace(".", "/")
    files = at.with_suffix(".py"), at / "__init__.pyi", at / "__init__.py"
    source = next(file for file in files if file.is_file()).read_text(encoding="utf-8")
    for node in ast.parse(source).body:
        if isinstance(node, Documented) and node.name == name:
            return node
        if isinstance(node, ast.ImportFrom) and any(one.name == name for one in node.names):
            return _definition(root, str(node.module), name)
    raise KeyError(f"{module} has no {name}")


def _entry(module: str, node: Documented) -> str:
    name = f"{module}.{node.name}"
    parts = [f'<a id="{name}"></a>', f"### `{name}`", _signature(node)]
    parts.append(as_markdown(ast.get_docstring(node) or ""))
    return "\n\n".join(part for part in parts if part)


def _signature(node: Documented) -> str:
    if isinstance(node, ast.ClassDef):
        fields = [n for n in node.body if isinstance(n, ast.AnnAssign)]
        lines = [f"class {node.name}", *(f"    {ast.unparse(field)}" for field in fields)]
        return "\n".join(["```text", *lines, "```"])
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    arguments = list(_arguments(node.args))
    call = f"{node.name}({', '.join(arguments)}){returns}"
    if len(call) > 75:
        lines = "".join(f"    {argument},\n" for argument in arguments)
        call = f"{node.name}(\n{lines}){returns}"
    return f"```text\n{call}\n```"


def _arguments(found: ast.arguments) -> Iterator[str]:
    """Yield each argument with its type and default; keyword-only arguments are not marked."""
    defaults = [None] * (len(found.args) - len(found.defaults)) + found.defaults
    pairs = [*zip(found.args, defaults, strict=True)]
    pairs += zip(found.kwonlyargs, found.kw_defaults, strict=True)
    for argument, default in pairs:
        yield ast.unparse(argument) + (f" = {ast.unparse(default)}" if default else "")


def as_markdown(docstring: str) -> str:
    """Return a docstring as Markdown: entries as a list, headings bold, formulas as code."""
    lines: list[str] = []
    for line in SECOND.sub(r".\n\1 : ", docstring).splitlines():
        if UNDERLINE.match(line):
            lines[-1:] = [f"**{lines[-1]}**", ""]
        elif entry := ENTRY.match(line):
            if lines and lines[-1] and not lines[-1].startswith(("- ", "    ")):
                lines.append("")
            lines.append(f"- `{entry[1]}`: {entry[2]}")
        else:
            lines.append(line)
    return "\n".join(lines)
