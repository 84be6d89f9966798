"""The commands: the import of each module puts its own into the app."""

from jointwave.compare.cli.commands import (  # noqa: F401 (each adds its own)
    animation,
    experiments,
    fit,
    installation,
    picture,
    scenes,
    solutions,
)
from jointwave.compare.cli.options import app as app
