"""The commands: the import of each module puts its own into the app."""

from jointwave.compare.cli.commands import (
    animation,
    experiments,
    fit,
    installation,
    picture,
    scenes,
    solutions,
)
from jointwave.compare.cli.options import app

__all__ = [
    "animation",
    "app",
    "experiments",
    "fit",
    "installation",
    "picture",
    "scenes",
    "solutions",
]
