"""What the tests share: the paper's pillar with any key changed, and a look at compiled code."""

import re
from pathlib import Path

import numba
import pytest
from hypothesis import settings

import cases

# The first example compiles a kernel, which no deadline foresees.
settings.register_profile("jointwave", deadline=None)
settings.load_profile("jointwave")

PILLAR = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"


@pytest.fixture
def pillar():
    """Return a function that gives the paper's free pillar with dotted keys changed."""

    def scene(**changes):
        overrides = {key.replace("__", "."): value for key, value in changes.items()}
        return cases.load_variant(PILLAR, "", {"variants": []} | overrides)

    return scene


@pytest.fixture
def instructions():
    """Return a function that counts one kind of instruction in a kernel for given arguments.

    The kernel is compiled afresh, because the cache hands back machine code without its text.
    """

    def count(kernel, arguments, kind):
        fresh = numba.njit(error_model="numpy")(kernel.py_func)
        fresh(*arguments)
        return len(re.findall(rf"= {kind} ", "\n".join(fresh.inspect_llvm().values())))

    return count
