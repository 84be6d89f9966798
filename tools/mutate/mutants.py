"""Small faults of a module, one at a time: what a slip of the hand would make of it."""

import ast
import random
from collections.abc import Iterator
from typing import NamedTuple

COMPARISONS = {
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt), ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,), ast.NotIn: (ast.In,),
}  # fmt: skip
ARITHMETIC = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.FloorDiv: ast.Div, ast.Mod: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd,
    ast.MatMult: ast.Add,
}  # fmt: skip
OPPOSITES = [
    ("min", "max"), ("minimum", "maximum"), ("sin", "cos"), ("sinh", "cosh"), ("any", "all"),
    ("floor", "ceil"), ("argmin", "argmax"), ("zeros", "ones"), ("left", "right"),
]  # fmt: skip
SWAPS = {a: b for pair in OPPOSITES for a, b in (pair, pair[::-1])}
SILENT = (ast.Raise, ast.Assert, ast.Import, ast.ImportFrom)


class Mutant(NamedTuple):
    """A fault: `module` source with one node of it changed.

    line, scope : the line, and the first of the outermost function around it.
    text : what was changed into what.
    """

    path: str
    line: int
    scope: int
    text: str
    tree: ast.Module


def mutants(path: str, source: str, most: int, seed: int) -> Iterator[Mutant]:
    """Yield `most` of the mutants of a module's functions at most, by chance, by their lines."""
    scopes = [scope for _, scope, _ in _faults(ast.parse(source))]
    within = [i for i, scope in enumerate(scopes) if scope]
    chosen = random.Random(seed).sample(within, min(most, len(within)))
    for i in sorted(chosen):
        tree = ast.parse(source)
        node, scope, apply = [*_faults(tree)][i]
        around = _around(tree, node)
        before = ast.unparse(around)
        apply()
        after = ast.unparse(ast.fix_missing_locations(around))
        if after != before:
            yield Mutant(path, node.lineno, scope, _difference(before, after), tree)


def _difference(before: str, after: str) -> str:
    """Return the lines that differ, shortened."""
    old, new = before.splitlines(), after.splitlines()
    lost, found = [x for x in old if x not in new], [x for x in new if x not in old]
    return "  ->  ".join(" ".join(map(str.strip, lines))[:110] for lines in (lost, found))


def _around(tree: ast.Module, node: ast.AST) -> ast.AST:
    found: ast.AST = tree
    for other in ast.walk(tree):
        is_scope = isinstance(other, ast.FunctionDef | ast.ClassDef)
        if is_scope and any(n is node for n in ast.walk(other)):
            found = other
    return found


def _faults(tree: ast.Module) -> Iterator[tuple]:
    yield from _of_body(tree, 0, [])


def _of_body(node: ast.AST, scope: int, names: list[str]) -> Iterator[tuple]:
    """Yield (node, scope, apply) below a node, but for annotations, messages and decorators."""
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list", "type_comment"):
            continue
        for i, child in enumerate(value if isinstance(value, list) else [value]):
            if not isinstance(child, ast.AST) or isinstance(child, SILENT) or _is_text(child):
                continue
            own, inner = names, scope
            if isinstance(child, ast.FunctionDef):
                a = child.args
                own = [x.arg for x in (*a.posonlyargs, *a.args, *a.kwonlyargs)]
                own = [name for name in own if name not in ("self", "cls")]
                first = min([child.lineno, *(d.lineno for d in child.decorator_list)])
                inner = scope or first
            if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
                continue
            if isinstance(child, ast.FunctionDef) and any(
                "overload" in ast.unparse(d) or "intrinsic" in ast.unparse(d)
                for d in child.decorator_list
            ):
                continue
            if isinstance(value, list):
                yield from ((child, inner, f) for f in _removed(value, i, child))
            yield from ((child, inner, f) for f in _changed(node, field, i, child, own))
            yield from _of_body(child, inner, own)


def _is_text(node: ast.AST) -> bool:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True
    return isinstance(node, ast.JoinedStr)


def _removed(body: list, i: int, node: ast.AST) -> list:
    """Drop a statement, or an operand of `and` and `or` (as one of a list)."""
    if (
        isinstance(node, ast.AugAssign)
        or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call))
        or (isinstance(node, ast.Assign) and not isinstance(node.targets[0], ast.Name | ast.Tuple))
    ):
        return [lambda: body.__setitem__(i, ast.copy_location(ast.Pass(), node))]
    return []


def _changed(parent: ast.AST, field: str, i: int, node: ast.AST, names: list[str]) -> Iterator:
    def put(new: ast.AST):
        value = getattr(parent, field)
        new = ast.copy_location(new, node)

        def apply() -> None:
            if isinstance(value, list):
                value[i] = new
            else:
                setattr(parent, field, new)

        return apply

    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        for op in COMPARISONS.get(type(node.ops[0]), ()):
            yield lambda op=op: node.ops.__setitem__(0, op())
    elif isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in ARITHMETIC:
        yield lambda: setattr(node, "op", ARITHMETIC[type(node.op)]())
    elif isinstance(node, ast.BoolOp):
        other = ast.Or if isinstance(node.op, ast.And) else ast.And
        yield lambda: setattr(node, "op", other())
    elif isinstance(node, ast.UnaryOp) and not isinstance(node.operand, ast.Constant):
        yield put(node.operand)
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        if not isinstance(node.test, ast.Compare):
            yield lambda: setattr(node, "test", ast.UnaryOp(ast.Not(), node.test))
        else:
            yield lambda: setattr(node, "test", ast.Constant(True))
            if not isinstance(node, ast.While):
                yield lambda: setattr(node, "test", ast.Constant(False))
    elif isinstance(node, ast.Constant):
        yield from _constants(node, put)
    elif isinstance(node, ast.Attribute) and node.attr in SWAPS:
        yield lambda: setattr(node, "attr", SWAPS[node.attr])
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        if node.id in SWAPS:
            yield lambda: setattr(node, "id", SWAPS[node.id])
        elif node.id in names and len(names) > 1 and field not in ("func", "value"):
            other = names[(names.index(node.id) + 1) % len(names)]
            yield lambda: setattr(node, "id", other)
    elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
        if isinstance(node.slice, ast.Name):
            less = ast.BinOp(node.slice, ast.Sub(), ast.Constant(1))
            yield lambda: setattr(node, "slice", less)
        if isinstance(node.value, ast.Name) and node.value.id in names and len(names) > 1:
            other = names[names.index(node.value.id) - 1]
            yield put(ast.Name(other, ast.Load()))


def _constants(node: ast.Constant, put) -> Iterator:
    if isinstance(node.value, bool):
        yield put(ast.Constant(not node.value))
    elif isinstance(node.value, int):
        yield put(ast.Constant(node.value + 1))
        yield put(ast.Constant(node.value - 1))
    elif isinstance(node.value, float):
        yield put(ast.Constant(1.25 * node.value if node.value else 1.0))
