"""gmsh without its side effects: silent, with its own defaults, and gone when it is done."""

import inspect
import locale
import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def gmsh_session() -> Iterator:
    """Start gmsh with its own defaults and an empty model, and yield its module.

    Raises RuntimeError where a session is open already, whose options would change the mesh; before
    4.9 gmsh cannot tell, and that session ends with this one.
    """
    with _process_as_it_was():
        import gmsh

        if getattr(gmsh, "isInitialized", int)():
            raise RuntimeError("gmsh is in use: call gmsh.finalize() first")
        takes_interrupts = "interruptible" in inspect.signature(gmsh.initialize).parameters
        gmsh.initialize(
            readConfigFiles=False, **({"interruptible": False} if takes_interrupts else {})
        )
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("jointwave")
        yield gmsh
    finally:
        with _process_as_it_was():
            gmsh.finalize()


@contextmanager
def _process_as_it_was() -> Iterator[None]:
    """Undo what gmsh does to the notation of numbers and, when old, to interrupts."""
    notation, interrupt = locale.setlocale(locale.LC_NUMERIC), signal.getsignal(signal.SIGINT)
    try:
        yield
    finally:
        locale.setlocale(locale.LC_NUMERIC, notation)
        if signal.getsignal(signal.SIGINT) is not interrupt:
            signal.signal(signal.SIGINT, interrupt)
