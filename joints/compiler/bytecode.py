"""Translation of Python's bytecode to numba's IR, without branches that are never taken.

numba translates all of a function and looks for such branches only then. But flags are known
before, and which arguments are None: half of a step in rock need not be translated.
"""

import dis
import re
import sys
from collections.abc import Callable
from typing import Any

from numba.core import bytecode, compiler_machinery, interpreter, types, untyped_passes

BRANCH = re.compile("POP_JUMP_(?:(?:FOR|BACK)WARD_)?IF_(TRUE|FALSE|NONE|NOT_NONE)")
#: Whether a branch is taken for a value, by the end of its name.
TAKEN: dict[str, Callable[[Any], bool]] = {
    "TRUE": bool,
    "FALSE": lambda value: not value,
    "NONE": lambda value: value is None,
    "NOT_NONE": lambda value: value is not None,
}
TRUTH = (bool, int, type(None))  # types of constants whose truth is known
MAYBE = (types.Optional, types.Omitted)  # type: ignore[attr-defined] # arguments that may be None
SOMETHING, UNKNOWN = object(), object()  # an argument that is not None; one that may be
JUMP = dis.opmap["JUMP_FORWARD"]
ATTRIBUTE = int(sys.version_info >= (3, 12))  # bits of a name's index that say something else
#: Instructions with lists and dictionaries of arguments, and with contexts.
UNUSUAL = {"BEFORE_WITH", "CALL_FUNCTION_EX", "DICT_MERGE", "DICT_UPDATE", "LIST_EXTEND"}


class Bytecode(interpreter.Interpreter):
    """Translation of bytecode: what follows it concerns only some instructions."""

    def post_process(self, peepholes, func_ir):
        """Return numba's IR of a function."""
        found = {one.opname for one in self.bytecode}
        if found & UNUSUAL or any("EXCEPT" in one for one in found):
            return super().post_process(peepholes, func_ir)
        return func_ir


@compiler_machinery.register_pass(mutates_CFG=True, analysis_only=False)
class Translation(untyped_passes.TranslateByteCode):
    """Translate bytecode to numba's IR."""

    _name = "translation"

    def run_pass(self, state):
        """Return that the state has changed."""
        given = {name: _value(kind) for name, kind in arguments_of(state)}
        follow_branches(state.bc.table, state.func_id.func, given)
        state.func_ir = Bytecode(state.func_id).interpret(state.bc)
        return True


def arguments_of(state: Any) -> Any:
    """Return the names of a function's arguments with their types."""
    return zip(state.func_id.arg_names, state.args, strict=False)


def _value(kind: types.Type) -> Any:
    """Return what is known of an argument: flags, None, or that it is not None."""
    if kind == types.none:
        return None
    return UNKNOWN if isinstance(kind, MAYBE) else getattr(kind, "values", SOMETHING)


def follow_branches(table: dict[int, Any], function: Any, given: dict[str, Any]) -> None:
    """Replace branches on what is known, in place, by jumps to where they lead.

    table : instructions by their offset. given : what is known of arguments, by their names. The
    variables of a closure are known too, and so are fields of tuples.
    """
    code = function.__code__
    cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
    assigned = _assigned(table, code)
    known = {name: value for name, value in given.items() if name not in assigned}
    known |= {name: cell.cell_contents for name, cell in cells}
    for one in [one for one in table.values() if one.opname in ("LOAD_DEREF", "LOAD_FAST")]:
        value = known.get(code._varname_from_oparg(one.arg), UNKNOWN)
        if value is UNKNOWN:
            continue
        branch = _after(table, one)
        while branch.opname == "LOAD_ATTR" and isinstance(value, tuple):
            value = getattr(value, code.co_names[branch.arg >> ATTRIBUTE], UNKNOWN)
            branch = _after(table, branch)
        found = BRANCH.fullmatch(branch.opname)
        if found and value is not UNKNOWN and ("NONE" in found[1] or isinstance(value, TRUTH)):
            target = branch.get_jump_target() if TAKEN[found[1]](value) else branch.next
            jump = bytecode.ByteCodeInst(one.offset, JUMP, (target - one.next) // 2, one.next)
            jump.lineno = one.lineno
            table[one.offset] = jump


def _after(table: dict[int, Any], one: Any) -> Any:
    """Return the instruction that follows another, but for what only prepares it."""
    one = table[one.next]
    while one.opname in ("CACHE", "NOP", "TO_BOOL"):
        one = table[one.next]
    return one


def _assigned(table: dict[int, Any], code: Any) -> set[str]:
    """Return the names of the local variables that a function assigns."""
    stores = [one for one in table.values() if one.opname.startswith("STORE_FAST")]
    if any(one.opname != "STORE_FAST" for one in stores):  # with another variable at once
        return set(code.co_varnames)
    return {code._varname_from_oparg(one.arg) for one in stores}
