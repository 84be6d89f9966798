"""Live ranges of variables: what numba's IR is given instead of static single assignment.

A variable that is assigned in several places becomes several, one for each set of assignments of
which some use may see any (a web): their types do not meet, where a kernel uses a name twice. numba
goes through the whole function for each variable, and back; this once for all.
"""

from collections import defaultdict

from numba.core import compiler_machinery, ir, ir_utils

NESTED = "call", "build_map"  # expressions that hold pairs of names and values
LOCKED = ir.Const, ir.Global, ir.FreeVar  # their targets take the type of this very value


@compiler_machinery.register_pass(mutates_CFG=False, analysis_only=False)
class LiveRanges(compiler_machinery.FunctionPass):
    """Give each live range of a variable a name of its own."""

    _name = "live ranges"

    def __init__(self):
        super().__init__()

    def run_pass(self, state):
        """Return whether any variable is assigned twice."""
        blocks, places = state.func_ir.blocks, defaultdict(list)
        for block in blocks.values():
            for one in block.find_insts(ir.Assign):
                places[one.target.name].append(one)
        several = {name: found for name, found in places.items() if len(found) > 1}
        if several:
            _rename(blocks, several)
            state.func_ir._definitions = ir_utils.build_definitions(blocks)
        return bool(several)


def _rename(blocks: dict[int, ir.Block], several: dict[str, list[ir.Assign]]) -> None:
    web = {one: {one} for found in several.values() for one in found}  # of each assignment
    uses = []  # of what is assigned twice: statement, name, an assignment that it may see
    before = _reaching(blocks, several)
    for at, block in blocks.items():
        reaching = before[at]
        for one in block.body:
            for name in names_read(one).intersection(several):
                seen = reaching.get(name)
                if seen:
                    first, *others = seen
                    for other in others:
                        _join(web, first, other)
                    uses.append((one, name, first))
            if one in web:
                reaching[one.target.name] = {one}
    scope, variable = next(iter(blocks.values())).scope, {}
    for name, found in several.items():
        for place, one in enumerate(found):
            if id(web[one]) not in variable:
                variable[id(web[one])] = scope.redefine(name, one.loc) if place else one.target
    for one, name, seen in uses:
        _replace(one, name, variable[id(web[seen])])
    for one in web:
        one.target = variable[id(web[one])]
    for block in blocks.values():
        block.body = [part for one in block.body for part in _unlocked(scope, one, web.get(one))]


def _reaching(blocks, several) -> dict[int, dict[str, set]]:
    """Return which assignments of a name may have been the last at the beginning of each block."""
    before: dict[int, dict[str, set]] = {at: defaultdict(set) for at in blocks}
    targets = {at: block.terminator.get_targets() for at, block in blocks.items()}
    last = {
        at: {one.target.name: one for one in block.find_insts(ir.Assign)}
        for at, block in blocks.items()
    }
    for at, found in last.items():
        for name in found.keys() & several.keys():
            one, work = found[name], list(targets[at])
            while work:
                here = work.pop()
                if one not in before[here][name]:
                    before[here][name].add(one)
                    if name not in last[here]:
                        work += targets[here]
    return before


def names_read(one: ir.Stmt) -> set[str]:
    """Return the names that a statement reads."""
    read = one.value if isinstance(one, ir.Assign) else one
    if isinstance(read, ir.Var):
        return {read.name}
    if isinstance(read, ir.Expr) and read.op not in NESTED:
        parts = read._kws.values()
        several = (one for part in parts if isinstance(part, tuple | list) for one in part)
        return {one.name for one in (*parts, *several) if isinstance(one, ir.Var)}
    return {var.name for var in read.list_vars()} if isinstance(read, ir.Inst) else set()


def _join(web: dict[ir.Assign, set[ir.Assign]], first: ir.Assign, other: ir.Assign) -> None:
    if web[other] is not web[first]:
        web[first] |= web[other]
        for one in web[other]:
            web[one] = web[first]


def _replace(one: ir.Stmt, name: str, variable: ir.Var) -> None:
    """Let a statement read another variable."""
    if variable.name == name:
        return
    if isinstance(one, ir.Assign):
        one.value = ir_utils.replace_vars_inner(one.value, {name: variable})
    else:
        ir_utils.replace_vars_stmt(one, {name: variable})


def _unlocked(scope: ir.Scope, one: ir.Stmt, web: set[ir.Assign] | None) -> tuple[ir.Stmt, ...]:
    """Return a statement, or two where others of its web may give values of another type."""
    if web is None or len(web) == 1 or not isinstance(one.value, LOCKED):
        return (one,)
    given = ir.Assign(one.value, scope.redefine("$constant", one.loc), one.loc)
    one.value = given.target
    return given, one
