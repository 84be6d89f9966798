#!/usr/bin/env bash
# Makes .venv, a Python that imports dolfinx and this project; does nothing when that is done already.
#   usage: tools/setup.sh [browser | docs]    ("browser": also the headless Chromium that the tests of the report's page drive,
#                                              and what the tests of `view` and of the examples need;
#                                              "docs": also mkdocs, which builds the documentation)
# In the environment, kept for this .venv until they are given anew:
#   DOLFINX=active|apt|pip|conda  dolfinx in this way alone; any: in the first that there is
#   LOCKED=1                      the versions of constraints.txt; 0: the newest that pyproject.toml admits
set -euo pipefail
cd "$(dirname "$0")/.."
asked=$(cat .venv/.setup-asked 2>/dev/null || echo any 0)
way=${DOLFINX:-${asked% *}} locked=${LOCKED:-${asked#* }}

say() { printf 'setup: %s\n' "$*"; }
fail() { printf 'setup: %s\n' "$*" >&2; exit 1; }

case $way in
    any | active | apt | pip | conda) ;;
    *) fail "DOLFINX=$way: must be active, apt, pip, conda or any" ;;
esac

every=30  # s

# Runs a command; every half minute that it takes, a line on standard error says what it does.
telling() {  # what, command ...
    local what=$1 code=0 began=$SECONDS teller
    shift
    # What sleeps on after the end holds no pipe open.
    while sleep "$every" </dev/null >/dev/null 2>&1; do say "$what, for $((SECONDS - began)) s" >&2; done &
    teller=$!
    "$@" || code=$?
    kill "$teller"
    wait "$teller" 2>/dev/null || true
    return "$code"
}

# Judge the user's own Python, not a .venv made here before that happens to be active.
PATH=$(printf %s "$PATH" | tr : '\n' | grep -vFx -e "$PWD/.venv/bin" | paste -sd: -)
unset PYTHONHOME

# pip's wheel of dolfinx brings an MPI that must be loaded first.
find='from importlib.util import find_spec as f'
dolfinx="$find
if f('dolfinx_solver'): import dolfinx_solver
import dolfinx"
imports_dolfinx() { "$1" -c "$dolfinx, ensurepip, sys; sys.exit(sys.version_info < (3, 11))" >/dev/null 2>&1; }

in_log() { local log=$1; shift; "$@" >"$log" 2>&1; }

# apt-get, as root or through sudo; fails where there is neither.
apt_install() {
    local admin=() missing=() package
    for package in "$@"; do
        dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null || return 1
        admin=(sudo)
    fi
    say "${admin[*]:+sudo }apt-get install ${missing[*]}"
    local get=("${admin[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=600)
    # A bare image has no package lists.
    apt-cache show "${missing[@]}" >/dev/null 2>&1 || telling 'apt-get update' "${get[@]}" update >&2 || return 1
    local log
    log=$(mktemp)
    # Packages chat on standard error too: show its end only if it matters.
    if telling 'apt-get install' in_log "$log" "${get[@]}" install -y --no-install-recommends "${missing[@]}"; then rm "$log"; return 0; fi
    tail -n 5 "$log" >&2
    say "apt-get failed, see $log"
    return 1
}

# Prints a Python that pip has a wheel of dolfinx for: 3.12 or newer on x86-64 Linux.
wheel_python() {
    local python
    for python in python3 python3.13 python3.12; do
        "$python" -c 'import ensurepip, platform, sys; sys.exit(sys.version_info < (3, 12) or
            (sys.platform, platform.machine()) != ("linux", "x86_64"))' >/dev/null 2>&1 || continue
        "$python" -c 'import sys; print(sys.executable)'
        return
    done
    return 1
}

make_venv() {  # over a Python that has dolfinx
    say ".venv over $1, which has dolfinx $("$1" -c "$dolfinx; print(dolfinx.__version__)")"
    "$1" -m venv --system-site-packages .venv
    # A venv made from another venv sees neither that one's packages nor its dolfinx: name them.
    "$1" -c 'import site, sys; print(*(site.getsitepackages() if sys.prefix != sys.base_prefix else []), sep="\n")' \
        >"$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/active-environment.pth"
}

# The ways to a .venv with dolfinx; each fails where it is not to be had.
by_active() {
    local python
    python=$(command -v python3) && imports_dolfinx "$python" || return 1
    make_venv "$("$python" -c 'import sys; print(sys.executable)')"
}

by_apt() {
    command -v apt-get >/dev/null && apt_install python3-dolfinx python3-gmsh python3-venv &&
        imports_dolfinx /usr/bin/python3 && make_venv /usr/bin/python3
}

by_pip() {
    local python
    # A bare machine has no Python, and Debian's no venv.
    python=$(wheel_python) || { command -v apt-get >/dev/null && apt_install python3-venv && python=$(wheel_python); } || return 1
    say ".venv of $python, with dolfinx by pip"
    "$python" -m venv .venv
}

by_conda() {
    local conda
    conda=$(command -v micromamba || command -v mamba || command -v conda) || return 1
    say "$(basename "$conda") creates .venv from environment.yml (some minutes)"
    case $(basename "$conda") in
        micromamba) telling 'micromamba create' micromamba create -y -q -p ./.venv -f environment.yml ;;
        *) telling 'conda env create' "$conda" env create -q -p ./.venv -f environment.yml ;;
    esac
}

# Debian 12's dolfinx comes before the wheel, which its Python is too old for; any other apt's after it.
ways() {
    if [ "$way" != any ]; then
        echo "$way"
    elif grep -qs '^VERSION_CODENAME=bookworm' /etc/os-release; then
        echo active apt pip conda
    else
        echo active pip apt conda
    fi
}

make_environment() {
    local one
    for one in $(ways); do
        rm -rf .venv
        if "by_$one"; then return 0; fi
    done
    rm -rf .venv
    return 1
}

install_project() {  # with these extras
    # Strings, not arrays: macOS's bash 3.2 takes an empty array for an unset variable.
    local numpy='' lock=''
    # dolfinx and petsc4py are compiled against one numpy major version, and must keep it.
    if .venv/bin/python -c 'import numpy, sys; sys.exit(numpy.__version__.split(".")[0] != "1")' 2>/dev/null; then
        numpy='numpy<2'
    fi
    if [ "$locked" != 0 ]; then lock='-c constraints.txt'; fi
    say "pip install -e .[$1] $numpy $lock (about a minute)"
    # shellcheck disable=SC2086
    telling 'pip install' .venv/bin/python -m pip --disable-pip-version-check install -q -e ".[$1]" $numpy $lock
}

# What gmsh's wheel and forms of dolfinx's need of the system; without it their tests fail.
install_libraries() {
    .venv/bin/python -c 'import dolfinx_solver' 2>/dev/null && command -v apt-get >/dev/null || return 0
    apt_install gcc libc6-dev python3-dev libglu1-mesa libxcursor1 libxft2 libxinerama1 || say "tests of gmsh and of forms will fail"
}

install_browser() {
    command -v chromium >/dev/null && return
    if grep -qs '^ID=debian' /etc/os-release && apt_install chromium; then return; fi
    say "no chromium here: the page tests will not run"
}

install_extras() {
    .venv/bin/python -c 'import ipykernel, jupytext, nbclient, pyvista' 2>/dev/null || install_project view,examples
}

install_docs() {
    .venv/bin/python -c 'import ipykernel, jupytext, latex2mathml, material, mkdocs, nbclient' 2>/dev/null ||
        install_project docs,examples
}

# The folder is part of both keys because a venv does not survive being moved or copied. They are asked for anew each time:
# a bare machine has no Python before Debian's is installed.
base_key() { echo "$PWD $way $(python3 -c 'import sys; print(sys.executable, sys.version)' 2>/dev/null || echo none)"; }
key() { echo "$(base_key) $locked $(cat pyproject.toml constraints.txt environment.yml tools/setup.sh | cksum)"; }

ready() {
    [ "$(cat .venv/.setup-done 2>/dev/null)" = "$(key)" ] &&
        .venv/bin/python -c "$find; assert f('dolfinx') and f('compare')" 2>/dev/null
}

if ready; then
    say ".venv is up to date"
else
    rm -f .venv/.setup-done
    if [ "$(cat .venv/.setup-base 2>/dev/null)" != "$(base_key)" ] || ! imports_dolfinx .venv/bin/python; then
        make_environment || fail "no dolfinx ($way): activate an environment that has it, or install Python 3.12 or newer (x86-64 Linux), conda or Debian/Ubuntu's python3-dolfinx python3-gmsh python3-venv, then run make again"
        base_key >.venv/.setup-base
    fi
    extras=test,check
    # Only pip's dolfinx is ours to install.
    .venv/bin/python -c "$find; import sys; sys.exit(bool(f('dolfinx')) and not f('dolfinx_solver'))" && extras=$extras,continuum
    echo "$way $locked" >.venv/.setup-asked
    install_project "$extras"
    .venv/bin/python -c "$dolfinx, numba, compare" || fail ".venv does not import dolfinx, numba and compare"
    key >.venv/.setup-done
    say "done: .venv/bin/jointwave, or activate it by: . .venv/bin/activate"
fi
case "${1:-}" in
    browser) install_libraries; install_browser; install_extras ;;
    docs) install_docs ;;
esac
