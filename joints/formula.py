"""Formulas that are plain Python, and that numba compiles into the kernels that call them.

`flags` marks a NamedTuple of booleans that is a constant of kernels: formulas know it beforehand.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import numba
from numba.extending import register_jitable

#: Versions of numba whose inside the short pass list is known to fit; with others it takes longer.
KNOWN = ((0, 68),)

options: dict[str, Any] = {"forceinline": True, "error_model": "numpy", "no_cfunc_wrapper": True}
kernel_options: dict[str, Any] = {}
#: What lasts while a kernel compiles: shortcuts through numba, where its version is known.
shortcuts: Callable[[], AbstractContextManager] = nullcontext
if numba.version_info.short in KNOWN:
    from joints.compiler.passes import FormulaCompiler, KernelCompiler, flags
    from joints.compiler.shortcuts import taken

    shortcuts = taken
    options["pipeline_class"] = FormulaCompiler
    kernel_options["pipeline_class"] = KernelCompiler
else:

    def flags(kind: type) -> type:
        """Return a NamedTuple of booleans as it is: what is untrue is left to the optimiser."""
        return kind


formula = register_jitable(**options)
#: A formula that stays a function of its own: LLVM optimises it apart from the kernel that calls.
#: With another numba it does not, since kernels of two processes might call the same one.
apart = register_jitable(**(options | {"forceinline": numba.version_info.short not in KNOWN}))
