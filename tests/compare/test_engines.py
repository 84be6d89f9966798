"""The registry: an entry for each engine and exact solution, imported on demand."""

import subprocess
import sys

import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.engines import ENGINES, names, solver


@pytest.mark.parametrize("kind", ["pillar", "rock mass"])
@pytest.mark.parametrize("name", ENGINES)
def test_a_run_is_prepared_as_it_is_made(pillar, one_joint, name, kind):
    scene = pillar(time__duration=2e-3, record__velocity=[20.25])
    if kind == "rock mass":
        tables = one_joint(numerics={"dem": {"block": 4.0, "threads": 2}}, time={"duration": 2e-3})
        tables["joint_sets"][0]["spacing"] = 5.0
        scene = load_tables(tables)
    found, made = solver(name).prepare(scene), solver(name).run(scene).attrs
    keys = ("steps", "dt", "critical_dt", "degrees_of_freedom", "scheme")
    prepared = found.steps, found.dt, found.critical, found.freedoms, found.scheme
    assert prepared == tuple(made[key] for key in keys) and found.bytes > 0
    settings = {"processes": 1} | dict(found.settings)  # their number is the command's
    assert all(made[key] == settings[key] for key in solver(name).cost)


def test_names_are_known_without_what_solves():
    for kind in ("pillar", "rock mass"):
        assert set(names(kind)) == {name for name in names() if kind in solver(name).kinds}
    script = (
        "import sys; from jointwave.compare.engines import names; names()\n"
        "heavy = {'xarray', 'matplotlib', 'scipy', 'numba', 'dolfinx', 'dem', 'continuum'}\n"
        "print(sorted(heavy & set(sys.modules)), [m for m in sys.modules if '.exact.' in m])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.strip() == "[] []", done.stderr
