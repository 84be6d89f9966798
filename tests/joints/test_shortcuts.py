"""Types are inferred as numba infers them where the compiler takes its shortcuts, and what the
shortcuts do not allow is compiled, or refused, as by numba itself."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from numba.core import errors, event, typeinfer
from numba.core.cpu import CPUContext

import joints
from joints.compiler import shortcuts
from joints.formula import KNOWN, formula, kernel_options
from numerics.jit import _in_one_process

pytestmark = pytest.mark.skipif(
    numba.version_info.short not in KNOWN, reason="this numba compiles without shortcuts"
)
ROOT = Path(joints.__file__).resolve().parent.parent


def whole_then_real(n):
    total = 0
    for i in range(n):
        total = total + 0.5 * i
    return total


def real_by_way_of_others(n):
    a = b = c = 0
    for i in range(n):
        c = b + i
        b = a
        a = a + 0.25
    return a + b + c


def pairs_of_either(n):
    pair = (0, 1.0)
    for i in range(n):
        pair = (pair[0] + 1, pair[1] * 2)
        if i == 3:
            pair = (pair[0], 7.0)
    return pair


@formula
def halved(x):
    return x / 2 if x > 1 else x


def formula_of_two_types(n):
    return halved(n) + halved(1.0 * n)


@pytest.mark.parametrize(
    "function",
    [whole_then_real, real_by_way_of_others, pairs_of_either, formula_of_two_types],
)
def test_types_are_those_of_numba(function, monkeypatch):
    """Also of variables that change after others have read them, by several rounds."""
    found, unify = [], typeinfer.TypeInferer.unify

    def unified(self, raise_errors=True):
        result = unify(self, raise_errors)
        found.append((type(self), self.func_id.func_name, result[:2]))
        return result

    monkeypatch.setattr(typeinfer.TypeInferer, "unify", unified)
    with shortcuts.taken():
        assert numba.njit(**kernel_options)(function)(5) == function(5)
    assert numba.njit(**kernel_options)(function)(5) == function(5)
    mine, theirs = (
        [rest for one, *rest in found if one is kind and rest[0] == function.__name__]
        for kind in (shortcuts.Inference, typeinfer.TypeInferer)
    )
    assert mine == theirs and len(mine) == 1 and len(mine[0][1][0]) > 5


def test_a_statement_is_looked_at_again_only_if_its_types_have_changed(monkeypatch):
    """Twice where a loop makes a whole number a real one, once where nothing changes."""
    times, follow = {}, typeinfer.IntrinsicCallConstraint.__call__

    def counted(self, inference):
        times[self.target] = times.get(self.target, 0) + 1
        follow(self, inference)

    monkeypatch.setattr(typeinfer.IntrinsicCallConstraint, "__call__", counted)
    for function, most in ((whole_then_real, 2), (math_alone, 1)):
        times.clear()
        with shortcuts.taken():
            numba.njit(**kernel_options)(function)(3)
        assert max(times.values()) == most


def math_alone(n):
    x = 1.5 * n
    return math.sqrt(x * x + 1.0)


BEYOND = """
import numba, numpy
from joints.formula import kernel_options, shortcuts
from numerics.jit import jitted

def beyond(a):
    return len(set(a)), str(a.size), a.cumsum()[-1]

try:
    with shortcuts():
        numba.njit(**kernel_options)(beyond)(numpy.array([1.0, 1.0, 3.0]))
except Exception as error:
    print("refused")
print(jitted(beyond)(numpy.array([1.0, 1.0, 3.0])))
"""


def test_what_shortcuts_do_not_allow_is_compiled_without_them(tmp_path):
    """Sets, strings and sums along an axis, which kernels do not use."""
    (tmp_path / "program.py").write_text(BEYOND)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, str(tmp_path / "program.py")]
    said = subprocess.check_output(command, env=environment, text=True)
    assert said.splitlines() == ["refused", "(2, '3', 5.0)"]


def test_errors_are_those_of_numba():
    """With the statement and its place."""

    def wrong(a):
        return a.no_such_thing

    kernel = numba.njit(**kernel_options)(wrong)
    kernel.compile = _in_one_process(kernel.compile, "wrong.lock")
    with pytest.raises(errors.TypingError, match=r"typing of get attribute at .*test_shortcuts"):
        kernel(1.0)


def test_numba_itself_is_left_as_it_was():
    """Whatever happens while shortcuts are taken."""
    before = event.start_event, typeinfer.TypeInferer, CPUContext.load_additional_registries
    with shortcuts.taken():
        assert event.start_event is not before[0]
    with pytest.raises(ValueError, match="ends"), shortcuts.taken():
        raise ValueError("ends")
    assert before == (
        event.start_event,
        typeinfer.TypeInferer,
        CPUContext.load_additional_registries,
    )
    assert numba.njit(lambda text: text.upper())("rock") == "ROCK"
