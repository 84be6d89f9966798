#!/usr/bin/env bash
# Makes .lowest: the oldest versions that pyproject.toml admits, over the dolfinx of .venv, or pip's where that has it.
# Transitive dependencies are the newest, as pip takes them.
set -euo pipefail
cd "$(dirname "$0")/.."
python=.lowest/bin/python pins=build/lowest.txt extras=(--extra test --extra check --extra view --extra examples)
rm -rf .lowest
mkdir -p build
if .venv/bin/python -c 'import dolfinx_solver' 2>/dev/null; then
    .venv/bin/python -m venv .lowest
    extras+=(--extra continuum)
else
    .venv/bin/python -m venv --system-site-packages .lowest
    find .venv -name active-environment.pth -exec cp {} "$($python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')" \;
fi
.uv/bin/uv pip compile -q pyproject.toml "${extras[@]}" --resolution lowest-direct --only-binary :all: --python $python --no-header -o $pins
$python -m pip --disable-pip-version-check install -q -r $pins
$python -m pip --disable-pip-version-check install -q --no-deps -e .
