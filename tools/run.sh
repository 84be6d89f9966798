#!/bin/sh
# Runs a command in .venv, or another environment in this folder, as after activating it.
#   usage: [VENV=.venv] tools/run.sh COMMAND...
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=$root/${VENV:-.venv}/bin:$PATH
exec "$@"
