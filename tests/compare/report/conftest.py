"""Pages for the tests of the report, each made once, however many processes run the tests."""

import fcntl
import os
import pickle

import pytest


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
