"""The compilers of formulas and of kernels: a short pass list, and no machine code of formulas.

A formula is typed once and becomes part of the kernels that call it. So numba is kept from
optimising it and from making machine code of it at every level of calls; the kernel as a whole is
optimised once. Only those passes are taken that change anything.

A tuple of flags that is a constant of the kernel is a type of its own, so that a formula knows its
flags before anything is typed: what stands behind an untrue one is not compiled at all.

It relies on the inside of numba: `joints.formula` asks for its version.
"""

from functools import cache, partial
from types import BuiltinFunctionType
from typing import Any, ClassVar

from llvmlite.binding import Linkage
from numba._dynfunc import make_function
from numba.core import (
    compiler,
    compiler_machinery,
    ir,
    postproc,
    transforms,
    typed_passes,
    types,
    untyped_passes,
)
from numba.core.codegen import JITCodeLibrary
from numba.core.imputils import lower_constant, lower_getattr_generic
from numba.core.rewrites.static_getitem import RewriteConstGetitems
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import models, register_model, typeof_impl

from joints.compiler.bytecode import Translation, arguments_of
from joints.compiler.calls import calling
from joints.compiler.live_ranges import LiveRanges
from joints.compiler.lowering import OfFormula, OfKernel


class Flags(types.Opaque):
    """The type of a NamedTuple of flags that have these values.

    Python cannot call a kernel with one: numba remembers types of arguments by the types of their
    members, and would take two tuples of other values for the same.
    """

    def __init__(self, values: Any):
        self.values = values._make(map(bool, values))
        super().__init__(repr(self.values))


register_model(Flags)(models.OpaqueModel)


def flags(kind: type) -> type:
    """Return a NamedTuple of booleans whose values kernels know when they are compiled."""

    @typeof_impl.register(kind)
    def typed(value, context):
        return Flags(value)

    return kind


@infer_getattr
class FlagsAttribute(AttributeTemplate):
    """A flag is a boolean."""

    key = Flags

    def generic_resolve(self, kind, attribute):
        """Return its type."""
        return types.boolean if attribute in kind.values._fields else None


@lower_getattr_generic(Flags)
def flag(context, builder, kind, value, attribute):
    """Return a flag's value."""
    return context.get_constant(types.boolean, getattr(kind.values, attribute))


@lower_constant(Flags)
def nothing(context, builder, kind, value):
    """Return what is there of flags when a kernel runs."""
    return context.get_dummy_value()


@compiler_machinery.register_pass(mutates_CFG=True, analysis_only=False)
class Canonical(untyped_passes.IRProcessing):
    """Bring loops into their canonical form; which variables live where, only generators ask."""

    _name = "canonical loops"

    def run_pass(self, state):
        """Return that the state has changed."""
        found = state.func_ir
        if found.is_generator:
            return super().run_pass(state)
        found.blocks = transforms.canonicalize_cfg(found.blocks)
        found.variable_lifetime = postproc.VariableLifetime(found.blocks)
        found.generator_info = None
        return True


@compiler_machinery.register_pass(mutates_CFG=False, analysis_only=False)
class KnownFlags(compiler_machinery.FunctionPass):
    """Put the values of flags in their places."""

    _name = "known flags"

    def __init__(self):
        super().__init__()

    def run_pass(self, state):
        """Return whether there are any."""
        known = {n: kind.values for n, kind in arguments_of(state) if isinstance(kind, Flags)}
        found = False
        for block in state.func_ir.blocks.values() if known else ():
            for one in block.find_insts(ir.Assign):
                value = one.value
                if (
                    isinstance(value, ir.Expr)
                    and value.op == "getattr"
                    and value.value.name in known
                ):
                    one.value = ir.Const(getattr(known[value.value.name], value.attr), value.loc)
                    found = True
        return found


@compiler_machinery.register_pass(mutates_CFG=False, analysis_only=False)
class ConstantIndices(compiler_machinery.FunctionPass):
    """Put constant indices in their places: of all that numba would rewrite, what is found here."""

    _name = "constant indices"

    def __init__(self):
        super().__init__()

    def run_pass(self, state):
        """Return whether there are any."""
        rewrite, blocks = RewriteConstGetitems(state), state.func_ir.blocks
        found = [at for at in blocks if rewrite.match(state.func_ir, blocks[at], None, None)]
        for at in found:
            rewrite.match(state.func_ir, blocks[at], None, None)
            blocks[at] = rewrite.apply()
        return bool(found)


class Signatures:
    """A typing context that remembers the signatures of functions: numba tries every overload of an
    operator, some twice, wherever it stands."""

    known: ClassVar[dict] = {}

    def __init__(self, context):
        self._context = context

    def __getattr__(self, name):
        return getattr(self._context, name)

    def resolve_function_type(self, function, arguments, keywords):
        """Return the signature of a function for arguments of these types."""
        find = partial(self._context.resolve_function_type, function, arguments, keywords)
        if keywords or not isinstance(function, types.Function | BuiltinFunctionType | str):
            return find()
        return self._remembered((function, *arguments), find)

    def resolve_static_getitem(self, value, index):
        """Return the signature of an item at a constant index, None if any index is the same."""
        find = partial(self._context.resolve_static_getitem, value, index)
        return find() if isinstance(index, slice) else self._remembered((value, index), find)

    def resolve_setitem(self, target, index, value):
        """Return the signature of an assignment to an item."""
        find = partial(self._context.resolve_setitem, target, index, value)
        return self._remembered(("setitem", target, index, value), find)

    def resolve_static_setitem(self, target, index, value):
        """Return the signature of an assignment at a constant index, None if any is the same."""
        find = partial(self._context.resolve_static_setitem, target, index, value)
        if isinstance(index, slice):
            return find()
        return self._remembered(("static_setitem", target, index, value), find)

    def _remembered(self, asked, find):
        if asked not in self.known:
            self.known[asked] = find()
        return self.known[asked]


@compiler_machinery.register_pass(mutates_CFG=True, analysis_only=False)
class TypeInference(typed_passes.NopythonTypeInference):
    """Infer types, each signature once."""

    _name = "type inference"

    def run_pass(self, state):
        """Return that the state has changed."""
        context = state.typingctx
        state.typingctx = Signatures(context)
        try:
            return super().run_pass(state)
        finally:
            state.typingctx = context


@compiler_machinery.register_pass(mutates_CFG=False, analysis_only=True)
class Releases(typed_passes.IRLegalization):
    """Say where each variable ends, if any holds references of its own.

    What a function is given its caller holds: arrays that it only reads and writes are not counted.
    """

    _name = "releases"

    def run_pass(self, state):
        """Return whether one does."""
        models_of, kinds = state.targetctx.data_model_manager, state.typemap

        @cache
        def counted(kind):
            return models_of[kind].contains_nrt_meminfo()

        blocks = state.func_ir.blocks.values()
        owned = counted(state.return_type) or any(
            counted(kinds[one.target.name]) and not borrowed(one)
            for block in blocks
            for one in block.find_insts(ir.Assign)
        )
        if owned:
            super().run_pass(state)
            for block in blocks:
                block.body = [
                    one
                    for one in block.body
                    if not isinstance(one, ir.Del) or counted(kinds[one.value])
                ]
        return owned


def borrowed(one: ir.Assign) -> bool:
    """Return whether a statement only passes on what something else holds."""
    value = one.value
    return isinstance(value, ir.Arg | ir.Var) or (
        isinstance(value, ir.Expr) and value.op == "build_tuple"
    )


class FormulaLibrary(JITCodeLibrary):
    """The code of a formula, as it will be linked to that of its callers."""

    raises = False  # whether it may

    def _optimize_functions(self, ll_module):
        ll_module.data_layout = self._codegen._data_layout
        passes, builder = self._codegen._function_pass_manager()
        for one in ll_module.functions:
            if not one.is_declaration:
                passes.run(one, builder)

    def _optimize_final_module(self):
        pass

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._finalized = True


class KernelLibrary(JITCodeLibrary):
    """The code of a kernel. What it calls has no name outside: names number the functions of a
    process, so that in kernels that two processes compiled the same one may stand for two."""

    def _optimize_final_module(self):
        for one in self._final_module.functions:
            if not one.is_declaration and one.linkage == Linkage.linkonce_odr:
                one.linkage = Linkage.internal
        super()._optimize_final_module()


@compiler_machinery.register_pass(mutates_CFG=True, analysis_only=False)
class KernelLowering(typed_passes.NativeLowering):
    """Write the code of a kernel."""

    _name = "lowering of a kernel"

    @property
    def lowering_class(self):
        """The class that writes it."""
        return OfKernel

    def run_pass(self, state):
        """Return that the state has changed: by a library of its own."""
        state.library = KernelLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().run_pass(state)


@compiler_machinery.register_pass(mutates_CFG=True, analysis_only=False)
class Lowering(typed_passes.NativeLowering):
    """Write the code of a formula, and tell its callers where it is.

    Arrays of a type that is `distinct` do not overlap: loops over them need no check of that.
    """

    _name = "lowering of a formula"

    @property
    def lowering_class(self):
        """The class that writes it."""
        return OfFormula

    def run_pass(self, state):
        """Return that the state has changed: by a library that has no machine code."""
        state.library = FormulaLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        state.flags.noalias = any(getattr(kind, "distinct", False) for kind in state.args)
        super().run_pass(state)
        code, described = state.cr, state.cr.fndesc
        nowhere = make_function(described.lookup_module(), described.qualname, "", 0, code.env, ())
        call = calling(described, state.library, state.library.raises)
        state.targetctx.insert_func_defn([(call, nowhere, tuple(described.argtypes))])
        state.reload_init.extend(state.library._reload_init)
        state.cr = code._replace(cfunc=nowhere)
        return True


BEFORE_LOWERING = (
    Translation,
    untyped_passes.FixupArgs,
    Canonical,
    KnownFlags,
    untyped_passes.RewriteSemanticConstants,
    ConstantIndices,
    LiveRanges,
    untyped_passes.DeadBranchPrune,
    TypeInference,
    Releases,
)


class FormulaCompiler(compiler.CompilerBase):
    """The passes over a formula."""

    name, lowering = "formula", Lowering

    def define_pipelines(self):
        """Return its passes."""
        manager = compiler_machinery.PassManager(self.name)
        for one in (*BEFORE_LOWERING, self.lowering, typed_passes.NoPythonBackend):
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]


class KernelCompiler(FormulaCompiler):
    """The passes over a kernel: those over a formula, and machine code."""

    name, lowering = "kernel", KernelLowering
