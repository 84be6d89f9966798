"""Shortcuts through numba that kernels allow.

Before it compiles anything, numba reads all that it knows: strings, sets, classes, random numbers,
linear algebra. At every statement it notes what an error there would be called, and it infers the
types of all statements until nothing changes. Kernels need numbers, tuples, arrays and loops; and a
statement is looked at again only if the type of something in it has changed. A kernel that does not
compile so has to be compiled without shortcuts: numba then says what is wrong.
"""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import cache
from importlib import import_module
from typing import Any

from numba.core import cpu, dispatcher, errors, event, lowering, typeinfer
from numba.core.runtime import rtsys
from numba.core.typing import context as typing

from joints.compiler.passes import Signatures

#: What kernels use: modules that enter what they know into numba's own registry, and those with one
#: of their own.
SHARED = (
    "cpython.builtins",
    "cpython.iterators",
    "cpython.numbers",
    "cpython.rangeobj",
    "cpython.slicing",
    "cpython.tupleobj",
    "core.optional",
    "misc.literal",
    "np.arrayobj",
)
OWN = ("cpython.mathimpl", "np.npyimpl")
TYPES = ("core.typing.mathdecl", "core.typing.npydecl")


@cache
def _modules(names: tuple[str, ...]) -> list[Any]:
    """Return modules of numba."""
    return [import_module(f"numba.{name}") for name in names]


def _read_lowering(context: Any) -> None:
    """Read how to lower what kernels use."""
    rtsys.initialize(context)
    _modules(SHARED)
    for one in _modules(OWN):
        context.install_registry(one.registry)


def _read_types(context: Any) -> None:
    """Read the types of what kernels use."""
    for one in _modules(TYPES):
        context.install_registry(one.registry)


class Variables(typeinfer.TypeVarMap):
    """The types of variables; `asked` has those that one statement has asked for."""

    def __init__(self, context: Any):
        super().__init__()
        self.set_context(context)
        self.asked: list[typeinfer.TypeVar] = []

    def __getitem__(self, name):
        """Return a variable's type."""
        found = super().__getitem__(name)
        self.asked.append(found)
        return found


class Constraints(typeinfer.ConstraintNetwork):
    """What each statement says of types."""

    def __init__(self):
        super().__init__()
        self._seen: dict[int, list] = {}  # of each statement: what it has asked for, and its type

    def propagate(self, typeinfer):
        """Follow each statement that something has changed for; return the errors."""
        failed, variables = [], typeinfer.typevars
        for k, one in enumerate(self.constraints):
            if k in self._seen and all(kind is found.type for found, kind in self._seen[k]):
                continue
            variables.asked = []
            try:
                one(typeinfer)
                self._seen[k] = [(found, found.type) for found in variables.asked]
            except errors.TypingError as error:  # it may yet become clear
                failed.append(error)
        return failed


class Inference(typeinfer.TypeInferer):
    """The inference of types that looks again only at what has changed."""

    def __init__(self, context, func_ir, warnings):
        super().__init__(context, func_ir, warnings)
        self.typevars, self.constraints = Variables(context), Constraints()


def _compiled(self, arguments, result):
    """Compile a function, and do not remember failures: it may yet compile without shortcuts."""
    return True, self._compile_core(arguments, result)


NO_CONTEXT = nullcontext()


def _nothing(*arguments: Any, **keywords: Any) -> Any:
    return NO_CONTEXT


REPLACED = (
    (dispatcher._FunctionCompiler, "_compile_cached", _compiled),  # type: ignore[attr-defined]
    (cpu.CPUContext, "load_additional_registries", _read_lowering),
    (typing.Context, "load_additional_registries", _read_types),
    (typeinfer, "TypeInferer", Inference),
    (typeinfer, "new_error_context", _nothing),
    (lowering, "new_error_context", _nothing),
    (event, "start_event", _nothing),
    (event, "end_event", _nothing),
)


@contextmanager
def taken() -> Iterator[None]:
    """Let numba take the shortcuts while this lasts."""
    kept = [(where, name, getattr(where, name)) for where, name, _ in REPLACED]
    for where, name, what in REPLACED:
        setattr(where, name, what)
    try:
        yield
    except Exception:
        Signatures.known.clear()  # there may be more of them once all is read
        raise
    finally:
        for where, name, what in kept:
            setattr(where, name, what)
