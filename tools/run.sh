#!/bin/sh
# Runs a command in .venv, as after activating it.
#   usage: tools/run.sh COMMAND...
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=$root/.venv/bin:$PATH
if [ -d "$root/.venv/conda-meta" ]; then
    # dolfinx compiles its forms with conda's compilers, which are found through these scripts only.
    export CONDA_PREFIX="$root/.venv"
    for script in "$root"/.venv/etc/conda/activate.d/*.sh; do
        # shellcheck disable=SC1090
        if [ -f "$script" ]; then . "$script"; fi
    done
fi
exec "$@"
