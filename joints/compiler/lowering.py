"""Lowering of numba's IR to LLVM's, without what LLVM would only remove again.

numba turns a loop over a range into some sixty instructions, and keeps what several blocks read in
memory. Here a loop takes fifteen, and what is assigned once, at the beginning of a function, is
never stored. LLVM reads half as much, and its optimised code hardly differs. Arithmetic, fields of
NamedTuples and flags are written at once: numba would search all its overloads for each of them.
"""

import operator
from collections import defaultdict
from typing import Any, NamedTuple

from llvmlite.ir import IntType, IRBuilder
from numba.core import cgutils, ir, types, typing
from numba.core.lowering import Lower
from numba.core.types.containers import BaseNamedTuple

from joints.compiler.calls import FormulaCall, alloca, raises
from joints.compiler.live_ranges import names_read

WORD = IntType(64)
SIGNS = {operator.lt: "<", operator.le: "<=", operator.gt: ">", operator.ge: ">="}
SIGNS |= {operator.eq: "==", operator.ne: "!="}
#: LLVM's instructions for two numbers of one type; an unordered number differs from all.
INSTRUCTIONS: dict[types.Type, dict[Any, tuple[str, ...]]] = {
    types.int64: {
        operator.add: ("add",),
        operator.sub: ("sub",),
        operator.mul: ("mul",),
        **{op: ("icmp_signed", sign) for op, sign in SIGNS.items()},
    },
    types.float64: {
        operator.add: ("fadd",),
        operator.sub: ("fsub",),
        operator.mul: ("fmul",),
        **{op: ("fcmp_ordered", sign) for op, sign in SIGNS.items()},
        operator.ne: ("fcmp_unordered", "!="),
    },
}
TRUTH = typing.signature(types.boolean, types.boolean)


class Range(NamedTuple):
    """A range that one loop runs over: its values in LLVM's IR; start None for 0."""

    start: Any
    stop: Any


class Counter(NamedTuple):
    """Where a loop keeps its next number and how many are left."""

    following: Any
    left: Any


class Unoptimised(NamedTuple):
    """A library whose modules LLVM only translates: its passes gain nothing in what unpacks the
    arguments that Python gives a kernel, and there are hundreds."""

    library: Any

    def add_ir_module(self, module):
        """Add a module."""
        for one in module.functions:
            if not one.is_declaration:
                one.attributes.add("noinline")
                one.attributes.add("optnone")
        self.library.add_ir_module(module)


class OfKernel(Lower):
    """Write code without what only debuggers read."""

    def create_cpython_wrapper(self, release_gil=False):
        """Write the function by which Python calls a kernel."""
        self.context.create_cpython_wrapper(
            Unoptimised(self.library), self.fndesc, self.env, self.call_helper, release_gil
        )

    def _find_singly_assigned_variable(self):
        """Find variables that need no place in memory, and loops over ranges."""
        places, uses = defaultdict(list), defaultdict(list)  # by name: (block, statement)
        early = set()  # names read before they are assigned, in the order of the blocks
        for at, block in sorted(self.blocks.items()):
            for one in block.body:
                for name in (one.value,) if isinstance(one, ir.Del) else names_read(one):
                    uses[name].append((at, one))
                    if name not in places:
                        early.add(name)
                if isinstance(one, ir.Assign):
                    places[one.target.name].append((at, one))
        once = {name: found[0] for name, found in places.items() if len(found) == 1}
        once = {name: found for name, found in once.items() if name not in early}
        first = min(self.blocks)
        self._counts = any(isinstance(one, ir.Del) for found in uses.values() for _, one in found)
        self._singly_assigned_vars = {
            name
            for name, (here, _) in once.items()
            if all(at == here for at, _ in uses[name]) or (here == first and self._plain(name))
        }
        self._blk_local_varmap = {}
        self._of_loops: set[str] = set()  # variables of loops over ranges, which are not stored
        self._state: dict[str, Any] = {}  # of each of them
        for name, (_, one) in once.items():
            if self._is_range(one.value):
                self._of_loops |= _loop(name, once, uses)

    def _plain(self, name):
        """Return whether a variable's type counts no references."""
        model = self.context.data_model_manager[self.typeof(name)]
        return not model.contains_nrt_meminfo()

    def _is_range(self, value):
        """Return whether a value is a range of numbers in steps of 1."""
        if not isinstance(value, ir.Expr) or value.op != "call":
            return False
        kind, found = self.typeof(value.func.name), self.fndesc.calltypes[value]
        return (
            getattr(kind, "typing_key", None) is range
            and found.return_type == types.range_state64_type
            and len(found.args) < 3
            and len(value.args) == len(found.args)
            and all(isinstance(self.typeof(one.name), types.Integer) for one in value.args)
        )

    def lower_inst(self, inst):
        """Write one instruction."""
        if not isinstance(inst, ir.Assign):
            self._lower_other(inst)
            return
        name = inst.target.name
        if name in self._of_loops:
            self._state[name] = self._step_of_loop(inst.value)
        else:
            self.storevar(self.lower_assign(self.typeof(name), inst), name)

    def _lower_other(self, inst):
        """Write one instruction that assigns nothing to a variable."""
        if isinstance(inst, ir.StaticSetItem) and _is_pointer(self.typeof(inst.target.name)):
            kinds = self.fndesc.calltypes[inst]
            self.lower_setitem(inst.target, inst.index_var, inst.value, kinds)
        else:
            super().lower_inst(inst)

    def lower_expr(self, resty, expr):
        """Return the value of an expression."""
        if expr.op in ("pair_first", "pair_second") and expr.value.name in self._of_loops:
            return self._state[expr.value.name][expr.op == "pair_second"]
        kind = self.typeof(expr.value.name) if expr.op in ("getattr", "static_getitem") else None
        if expr.op == "getattr" and isinstance(kind, BaseNamedTuple):
            return self._field(resty, kind, expr)
        if expr.op == "static_getitem" and _is_pointer(kind):
            kinds = self.fndesc.calltypes[expr]
            return self.lower_getitem(resty, expr, expr.value, expr.index_var, kinds)
        return super().lower_expr(resty, expr)

    def lower_getitem(self, resty, expr, value, index, signature):
        """Return an item."""
        kind = signature.args[0]
        if not _is_pointer(kind):
            return super().lower_getitem(resty, expr, value, index, signature)
        given = self._given((value, index), signature)
        item = kind.get_item(self.context, self.builder, signature, given)
        return self.context.cast(self.builder, item, signature.return_type, resty)

    def lower_setitem(self, target_var, index_var, value_var, signature):
        """Write an item."""
        kind, variables = signature.args[0], (target_var, index_var, value_var)
        if _is_pointer(kind):
            given = self._given(variables, signature)
            kind.set_item(self.context, self.builder, signature, given)
        else:
            super().lower_setitem(*variables, signature)

    def lower_call(self, resty, expr):
        """Return the result of a call: a boolean is one already."""
        signature = self.fndesc.calltypes[expr]
        if signature == TRUTH and getattr(self.typeof(expr.func.name), "typing_key", 0) is bool:
            return self._given(expr.args, signature)[0]
        return super().lower_call(resty, expr)

    def _given(self, variables, signature):
        """Return the values of variables as those of a signature's types."""
        return [
            self._cast_var(one, kind) for one, kind in zip(variables, signature.args, strict=True)
        ]

    def _field(self, resty, kind, expr):
        """Return a field of a NamedTuple."""
        at = kind.fields.index(expr.attr)
        value = self.builder.extract_value(self.loadvar(expr.value.name), at)
        self.incref(kind[at], value)
        return self.context.cast(self.builder, value, kind[at], resty)

    def lower_binop(self, resty, expr, op):
        """Return the result of an operator: of two numbers of one type, without a search."""
        signature = self.fndesc.calltypes[expr]
        kind, other = signature.args
        instruction = INSTRUCTIONS.get(kind, {}).get(op) if kind == other else None
        if instruction is None:
            return super().lower_binop(resty, expr, op)
        name, *sign = instruction
        given = self._given((expr.lhs, expr.rhs), signature)
        value = getattr(self.builder, name)(*sign, *given)
        return self.context.cast(self.builder, value, signature.return_type, resty)

    def _cast_var(self, var, ty):
        """Return a variable's value as one of this type: those of constants are known."""
        kind = self.typeof(var.name) if isinstance(var, ir.Var) else None
        if isinstance(kind, types.IntegerLiteral) and ty == types.int64:
            return WORD(kind.literal_value)
        if isinstance(kind, types.BooleanLiteral) and ty == types.boolean:
            return cgutils.true_bit if kind.literal_value else cgutils.false_bit
        return super()._cast_var(var, ty)

    def _step_of_loop(self, value):
        """Return the state of a variable of a loop: a range, a counter, or a number and whether it
        is one."""
        if isinstance(value, ir.Var):
            return self._state[value.name]
        if value.op == "call":
            given = self._given(value.args, self.fndesc.calltypes[value])
            return Range(None if len(given) == 1 else given[0], given[-1])
        if value.op == "getiter":
            return self._counter(self._state[value.value.name])
        return self._next(self._state[value.value.name])

    def _counter(self, over):
        """Return the counter of a loop over a range."""
        build = self.builder
        counter = Counter(alloca(build, WORD), alloca(build, WORD))
        left = over.stop if over.start is None else build.sub(over.stop, over.start)
        some = build.icmp_signed(">", left, WORD(0))
        build.store(build.select(some, left, WORD(0)), counter.left)
        build.store(WORD(0) if over.start is None else over.start, counter.following)
        return counter

    def _next(self, counter):
        """Return a loop's next number, and whether it is one."""
        build = self.builder
        left, number = build.load(counter.left), build.load(counter.following)
        valid = build.icmp_signed(">", left, WORD(0))
        with build.if_then(valid):
            build.store(build.sub(left, WORD(1), flags=["nsw"]), counter.left)
            build.store(build.add(number, WORD(1)), counter.following)
        return number, valid

    def storevar(self, value, name, argidx=None):
        """Store the value of a variable: what it held needs no release if nothing counts it."""
        if name in self._singly_assigned_vars or not self._plain(name):
            super().storevar(value, name, argidx)
        else:
            self._alloca_var(name, self.typeof(name))
            self.builder.store(value, self.getvar(name))

    def incref(self, typ, val):
        """Count a reference, where one is released."""
        if self._counts:
            super().incref(typ, val)

    def decref(self, typ, val):
        """Release a reference, where one is counted."""
        if self._counts:
            super().decref(typ, val)

    def alloca_lltype(self, name, lltype, datamodel=None):
        """Return the place of a variable."""
        if self._plain(name):
            return alloca(self.builder, lltype, name)
        return cgutils.alloca_once(self.builder, lltype, name=name, zfill=False)


class OfFormula(OfKernel):
    """Write the code of a formula, as its callers call it."""

    @property
    def call_conv(self):
        """How it is called."""
        return FormulaCall(self.context)

    def setup_function(self, fndesc):
        """Begin the function."""
        self.function = self.call_conv.declared(self.module, fndesc)
        self.entry_block = self.function.append_basic_block("entry")
        self.builder = IRBuilder(self.entry_block)
        self.call_helper = self.call_conv.init_call_helper(self.builder)

    def lower_normal_function(self, fndesc):
        """Write the function, and tell its library whether it may raise."""
        super().lower_normal_function(fndesc)
        self.library.raises = raises(self.function)


def _is_pointer(kind: types.Type | None) -> bool:
    """Return whether a type says itself how its items are read and written."""
    return hasattr(kind, "get_item")


def _loop(name: str, once: dict, uses: dict) -> set[str]:
    """Return the variables of the loop over a range, if nothing else uses the range, its iterator
    or what that returns; all are assigned once."""
    found: set[str] = set()
    work: list[tuple[str, tuple[str, ...]]] = [(name, ("getiter",))]
    while work:
        name, allowed = work.pop()
        found.add(name)
        for at, one in uses[name]:
            value = one.value if isinstance(one, ir.Assign) else None
            following: tuple[str, ...]
            if isinstance(value, ir.Var) and allowed == ("iternext",):
                following = allowed
            elif isinstance(value, ir.Expr) and value.op in allowed:
                following = NEXT.get(value.op, ())
            else:
                return set()
            if not following:  # a number, or whether it is one: read where it is found
                if at != once[name][0]:
                    return set()
            elif one.target.name in once:
                work.append((one.target.name, following))
            else:
                return set()
    return found


#: What may be done with the result of a step of a loop.
NEXT = {"getiter": ("iternext",), "iternext": ("pair_first", "pair_second")}
