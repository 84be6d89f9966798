"""Compilation of dolfinx's forms, and in old versions elements, with a C compiler."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from time import time
from typing import TypeVar

import cffi

from jointwave.continuum.space.fenicsx import dolfinx
from jointwave.numerics.cache import one_process

Made = TypeVar("Made")
LINE = "dolfinx compiles the elements and forms of the rock; later runs load them"
WAIT = 0.5  # s, after which compiling is announced: cached forms load in less
FAILED = 10.0  # s, after which dolfinx treats an unfinished compilation as failed
INSTALL = "apt install gcc python3-dev, or conda install c-compiler"


def compiled(make: Callable[[], Made]) -> Made:
    """Return the result of a dolfinx call that compiles, in one process at a time, and announce it.

    Raises ImportError, with installation instructions, if the compiler is missing or fails.
    """
    with _quiet(), one_process(_cache() / "jointwave.lock", WAIT, announce):
        try:
            return make()
        except TimeoutError:  # a killed run has left its source
            _forget_unfinished()
            return make()
        except cffi.VerificationError:
            raise ImportError(f"dolfinx needs a C compiler that works: {INSTALL}") from None


@contextmanager
def _quiet() -> Iterator[None]:
    """Hide the compilers' messages, and restore the root logger, which they change."""
    root, disabled = logging.getLogger(), logging.root.manager.disable
    handlers, level = list(root.handlers), root.level
    logging.disable(max(disabled, logging.INFO))
    try:
        yield
    finally:
        root.handlers[:] = handlers
        root.setLevel(level)
        logging.disable(disabled)


@cache
def announce() -> None:
    """Log once that compiling takes a while, even while `_quiet` hides messages."""
    log = logging.getLogger("jointwave")
    if log.getEffectiveLevel() <= logging.INFO:
        log.handle(log.makeRecord(log.name, logging.INFO, __file__, 0, LINE, (), None))


def _cache() -> Path:
    settings = getattr(dolfinx.jit, "get_options", None) or dolfinx.jit.get_parameters
    return Path(settings()["cache_dir"])


def _forget_unfinished() -> None:
    """Remove sources of unfinished compilations."""
    for source in _cache().glob("libffcx_*.c"):
        with suppress(OSError):
            old = time() - source.stat().st_mtime > FAILED
            if old and not source.with_suffix(".c.cached").exists():
                source.unlink()
