#!/bin/sh
# Runs a command in .venv, or another environment in this folder, as after activating it.
#   usage: [VENV=.venv] tools/run.sh COMMAND...
root=$(cd "$(dirname "$0")/.." && pwd)
venv=$root/${VENV:-.venv}
PATH=$venv/bin:$PATH
if [ -d "$venv/conda-meta" ]; then
    # dolfinx compiles its forms with conda's compilers, which are found through these scripts only.
    export CONDA_PREFIX="$venv"
    for script in "$venv"/etc/conda/activate.d/*.sh; do
        # shellcheck disable=SC1090
        if [ -f "$script" ]; then . "$script"; fi
    done
fi
exec "$@"
