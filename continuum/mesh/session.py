"""gmsh sessions without side effects: silent, with default options, finalised after use."""

import inspect
import locale
import signal
from collections.abc import Iterator
from contextlib import contextmanager

from jointwave.cases.gmsh_file import INSTALL


@contextmanager
def gmsh_session() -> Iterator:
    """Start gmsh with default options and an empty model, and yield its module.

    Raises ImportError, with installation instructions, if gmsh cannot be loaded.
    Raises RuntimeError if a session is already open, whose options would change the mesh. gmsh
    before 4.9 cannot detect this; the open session then ends with this one.
    """
    with _process_as_it_was():
        try:
            import gmsh
        except (ImportError, OSError) as error:
            raise ImportError(f"needs gmsh ({error}; {INSTALL})") from None
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
    """Restore the locale's number format and the interrupt handler, which gmsh may change."""
    notation, interrupt = locale.setlocale(locale.LC_NUMERIC), signal.getsignal(signal.SIGINT)
    try:
        yield
    finally:
        locale.setlocale(locale.LC_NUMERIC, notation)
        if signal.getsignal(signal.SIGINT) is not interrupt:
            signal.signal(signal.SIGINT, interrupt)
