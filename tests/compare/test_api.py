"""The names of `import compare`: functions and modules, imported when they are asked for."""

import subprocess
import sys

import pytest

import compare
from compare import engines
from compare.misfit import metrics, pairs


def test_functions_are_those_of_their_modules():
    assert compare.compare is pairs.compare and compare.distance is metrics.distance
    assert compare.solve is engines.solve and compare.misfit.metrics is metrics


def test_every_name_is_there_and_listed():
    for name in compare.__all__:
        assert getattr(compare, name) is not None and name in dir(compare)


def test_an_unknown_name_is_no_attribute():
    with pytest.raises(AttributeError, match="module 'compare' has no attribute 'misfits'"):
        _ = compare.misfits


def test_importing_it_imports_nothing_else():
    """The command begins with it; a name imports what it needs and no more."""
    script = (
        "import sys; before = set(sys.modules); import compare\n"
        "heavy = {'numpy', 'xarray', 'matplotlib', 'scipy', 'pydantic', 'dolfinx'}\n"
        "print(sorted(heavy & (set(sys.modules) - before)))\n"
        "compare.find('guo-li-2002/fig-03')\n"
        "print(sorted({'xarray', 'matplotlib', 'dolfinx'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.splitlines() == ["[]", "[]"], done.stderr
