"""What the tests share: the paper's pillar with any key changed, and a look at compiled code."""

import atexit
import ctypes
import fcntl
import gc
import importlib
import json
import os
import pickle
import re
import shutil
import sys
import tomllib
import warnings
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from resource import RUSAGE_SELF, getpagesize, getrusage
from threading import current_thread, main_thread

import numba
import pytest
from hypothesis import settings

from jointwave import cases
from jointwave.cases.errors import InterruptedRun
from jointwave.numerics import jit
from jointwave.results.arrays import copied, fill

# The first example compiles a kernel, which no deadline foresees. Every run has the same examples;
# JOINTWAVE_EXAMPLES=night looks for a thousand others of every test.
settings.register_profile("jointwave", deadline=None, max_examples=50, derandomize=True)
settings.register_profile("night", deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("JOINTWAVE_EXAMPLES", "jointwave"))
# Constants of the project's modules would be among them, of those that are imported by then.
if providers := sys.modules.get("hypothesis.internal.conjecture.providers"):
    providers.is_local_module_file = lambda file: False

# Workers of xdist inherit them. Threads of BLAS would wait for one another, a millisecond for every
# small matrix, and those of MUMPS would for every front.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
# Open MPI would start a daemon for every process that imports it on its own, and wait for it.
os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")

# As in the command: most of what would be looked through has been imported, and stays.
gc.set_threshold(100_000)
atexit.register(gc.freeze)

# Nor does a test how long it takes: no command that it runs speaks of its progress.
os.environ["JOINTWAVE_PROGRESS"] = "0"

LARGE = 1 << 30  # bytes, of a process
LITTLE = 1 << 26  # bytes, that a process may grow before garbage is looked for
MALLOC_TRIM = getattr(ctypes.CDLL(None), "malloc_trim", lambda keep: 0)

PILLAR = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"

#: Open MPI refuses root and more processes than processors unless told otherwise, binds all jobs
#: to the same processors, spins while it waits, and may complain of the network, which nothing here
#: uses; others ignore these.
OPEN_MPI = {
    **dict.fromkeys(("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), "1"),
    **dict.fromkeys(("PRTE_ALLOW_RUN_AS_ROOT", "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM"), "1"),
    **dict.fromkeys(("OMPI_MCA_rmaps_base_oversubscribe", "OMPI_MCA_mpi_yield_when_idle"), "1"),
    "OMPI_MCA_btl": "^tcp",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}


def pytest_collection_modifyitems(items):
    """Test properties of every shipped scene together with its pairs."""
    if any(item.path.suffix == ".toml" for item in items):
        from shipped_scenes import added_to

        items[:] = added_to(items, release_memory)


def pytest_collection_finish():
    """Take what has been imported and collected from the garbage that is looked through."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def modules_of(monkeypatch):
    """Return a function of a folder that returns what imports its modules, until the test ends."""
    folders = []

    def importer(folder):
        monkeypatch.syspath_prepend(str(folder))
        folders.append(str(folder))
        return importlib.import_module

    yield importer
    for name, module in list(sys.modules.items()):
        if str(getattr(module, "__file__", None) or "").startswith(tuple(folders)):
            del sys.modules[name]


@pytest.fixture(scope="module", autouse=True)
def release_results(request):
    """Release after each file what it has cached, and the garbage in cycles: results of whole
    runs, figures and datasets that would stay until the tests end."""
    yield
    own = (value for value in vars(request.module).values() if hasattr(value, "cache_clear"))
    for cached in own:
        if cached.__module__ == request.module.__name__:
            cached.cache_clear()
    release_memory()


def release_memory():
    """Release garbage in cycles, and the pages of what was freed, where the process has grown."""
    if _resident() < _released[0] + LITTLE:
        return
    gc.collect()
    gc.freeze()  # what is left are kernels and types, which stay: no need to look at them again
    MALLOC_TRIM(0)  # glibc keeps the pages of arrays that were freed below others that were not
    _released[0] = _resident()


_released = [0]  # bytes of this process when its garbage was last released


@pytest.fixture(scope="session")
def once(tmp_path_factory):
    """Return a function of a name and of what makes a thing in a folder: the thing, made by the
    first process that asks for it while all others wait."""
    own = tmp_path_factory.getbasetemp()
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own

    def made(name, make):
        with (shared / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            file = shared / f"{name}.pickle"
            if not file.is_file():
                (folder := shared / name).mkdir()
                file.write_bytes(pickle.dumps(make(folder)))
            return pickle.loads(file.read_bytes())

    return made


@pytest.fixture(scope="session")
def pillar():
    """Return a function that gives the paper's free pillar with dotted keys changed, whose dots may
    be written as "__"."""

    def scene(**changes):
        overrides = {key.replace("__", "."): value for key, value in changes.items()}
        return cases.load_variant(PILLAR, "", {"variants": []} | overrides)

    return scene


@pytest.fixture
def plain(monkeypatch):
    """Let both engines take their steps as plain Python, on one thread: nothing is compiled."""
    from jointwave.continuum.stepping import balance, explicit
    from jointwave.continuum.stepping import leapfrog as rock
    from jointwave.dem.kernel import leapfrog, loop

    def in_python(kernel_for):
        return lambda *flags: getattr(kernel_for(*flags), "__wrapped__", kernel_for(*flags))

    for module, name in (
        *((leapfrog, "loop_for"), (rock, "leapfrog_for")),
        *((balance, "forces_for"), (balance, "tangents_for")),
    ):
        monkeypatch.setattr(module, name, in_python(getattr(module, name)))
    for module in (loop, explicit):
        monkeypatch.setattr(module, "flush_denormals", lambda: 0)
        monkeypatch.setattr(module, "restore_denormals", lambda old: None)
        monkeypatch.setattr(module, "borrowed", lambda values: values)


@pytest.fixture(scope="session")
def in_toml():
    """Return a function that spells a value as TOML does: tables inline, a scene's keys a line."""

    def inline(value):
        if isinstance(value, list):
            return f"[{', '.join(map(inline, value))}]"
        if isinstance(value, dict):
            return f"{{{', '.join(f'{json.dumps(k)} = {inline(v)}' for k, v in value.items())}}}"
        return json.dumps(value) if isinstance(value, str | bool) else str(value)

    def text(value):
        if isinstance(value, dict) and not value.keys().isdisjoint(("title", "time")):
            bare = [k if k.isascii() and k.isidentifier() else json.dumps(k) for k in value]
            each = zip(bare, value.values(), strict=True)
            return "".join(f"{key} = {inline(one)}\n" for key, one in each)
        return inline(value)

    return text


@pytest.fixture(scope="session")
def changed(in_toml):
    """Return a function that gives the text of a scene with changes by their keys, as in
    "rock.density = 0.0; no joint_sets[0].spacing"."""

    def text(good, changes):
        tables = tomllib.loads(good)
        for one in changes.split("; "):
            key = one.removeprefix("no ").partition(" = ")[0]
            *above, last = (int(k) if k.isdigit() else k for k in re.findall(r"[^.[\]]+", key))
            at = tables
            for part in above:
                at = at[part] if isinstance(at, list) else at.setdefault(part, {})
            if one.startswith("no "):
                del at[last]
            else:
                if isinstance(at, list) and last == len(at):
                    at.append({})
                at[last] = tomllib.loads(one.replace(key, "x", 1))["x"]
        return in_toml(tables)

    return text


@pytest.fixture(scope="session")
def spoilt(changed):
    """Return a function of a good scene's text and a mistake: the text with its changes, and what
    its line must begin with: the key with its value as changed last, or what follows an arrow."""

    def text(good, mistake):
        changes, _, named = mistake.partition(" -> ")
        return changed(good, changes), named or changes.rpartition("; ")[2].removeprefix("no ")

    return text


@pytest.fixture(scope="session")
def one_joint():
    """Return a function that gives the tables of rock with one joint at 30 degrees, which a P wave
    of 1 MPa and 200 Hz meets from below; quiet all around, tables replaced."""
    joint = {"name": "joint", "dip": 30.0, "through": [10.0, 15.0]}
    wave = {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker"}
    tables = {
        "title": "one joint",
        "domain": {"size": [20.0, 30.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": [joint | {"normal_stiffness": 1e10, "shear_stiffness": 4e9}],
        "waves": [wave | {"amplitude": 1e6, "period": 0.005}],
        "boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
        "time": {"duration": 0.03},
        "record": {"points": [[10.0, 5.0], [10.0, 25.0]], "joints": [[10.0, 15.0]]},
    }
    return lambda **changes: deepcopy(tables | changes)


def _resident():
    """Return the bytes of memory that this process has now, or has had where Linux cannot tell."""
    if (found := Path("/proc/self/statm")).is_file():
        return int(found.read_text().split()[1]) * getpagesize()
    return getrusage(RUSAGE_SELF).ru_maxrss * 1024


def _in_a_child(kernel, types):
    """Compile a kernel in a child process where this one has become large, and load it from the
    cache: numba never frees what it compiles with, several MB a kernel."""
    alone = current_thread() is main_thread()  # a child would keep the locks of another thread
    if alone and _resident() > LARGE:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which only wait
            child = os.fork()
        if child == 0:
            with suppress(BaseException):
                COMPILE_FOR(kernel, types)
            os._exit(0)
        os.waitpid(child, 0)
    COMPILE_FOR(kernel, types)


COMPILE_FOR, jit.compile_for = jit.compile_for, _in_a_child


@pytest.fixture(scope="session")
def keeper_at():
    """Return a function of a count of samples: what ends a run there, and lets it go on."""
    return Checkpointer


class Checkpointer:
    """Keeps what a run was when some samples were done, and ends it there once."""

    def __init__(self, at):
        self.at, self.done, self.kept = at, 0, None

    def restore(self, parts):
        fill(parts, self.kept)

    def look(self, samples, parts):
        if self.kept is None and samples >= self.at:
            self.kept, self.done = copied(parts), samples
            error = InterruptedRun("enough")
            error.samples = samples
            raise error


@pytest.fixture
def jointwave(monkeypatch, capsys, tmp_path_factory):
    """Return a function that runs the command in this process, checks its exit status, and returns
    what it has printed: `out` and `err`. Results are stored in a folder of this test."""
    from jointwave.compare.cli import inputs
    from jointwave.compare.cli.program import main

    monkeypatch.setattr(inputs, "RESULTS", tmp_path_factory.mktemp("out"))

    def run(*arguments, code=0):
        monkeypatch.setattr(sys, "argv", ["jointwave", *map(str, arguments)])
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main()
        said = capsys.readouterr()
        assert end.value.code == code and "Traceback" not in said.err, said.err
        return said

    return run


@pytest.fixture(scope="session")
def without_warnings():
    """Return a function that gives the lines of a text but for warnings of what a scene says."""
    warned = "jointwave: warning: "
    return lambda text: [line for line in text.splitlines() if not line.startswith(warned)]


@pytest.fixture(scope="module")
def instructions():
    """Return a function that counts one kind of instruction in a kernel for given arguments, once
    it is optimised. Copies that unrolling makes, whose names only end differently, count once."""
    texts = {}

    def count(kernel, arguments, kind):
        types = tuple(map(numba.typeof, arguments))
        key = kernel, types, numba.config.LOOP_VECTORIZE
        if key not in texts:
            options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "nogil": True}
            compiled = numba.njit(error_model="numpy", **options)(kernel.__wrapped__)
            compiled.compile(types)
            texts[key] = compiled.inspect_llvm(types)
        found = re.findall(rf"(?m)^ +(?:(%\.?\w+)[.\w]* = )?{kind} ", texts[key])
        return len(set(found))

    return count


@pytest.fixture(scope="session")
def mpiexec():
    """Return the command that starts MPI processes, and the environment that it is started in:
    without what MPI left there, or mpiexec would take itself for a part of it.

    They spin while they wait for one another. What else runs goes first: at equal priority each
    wait of theirs takes a time slice of it, and a test ten times as long."""
    launcher = shutil.which("mpiexec")
    if launcher is None:
        pytest.skip("no mpiexec here")
    own = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_"))}
    return ("nice", "-n", "10", launcher), {**own, **OPEN_MPI}
