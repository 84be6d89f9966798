#!/usr/bin/env bash
# Makes .venv, a Python that imports dolfinx and this project; does nothing when that is done already.
#   usage: tools/setup.sh [browser | docs]    ("browser": also headless Chromium, and what the tests of `view` and of the examples need;
#                                              "docs": also mkdocs, which builds the documentation)
# dolfinx is that of the active environment, else apt's on Debian 12, else pip's wheel, else any other apt's.
#   LOCKED=1   the versions of constraints.txt, also in later calls until LOCKED=0: the newest that pyproject.toml admits
set -euo pipefail; every=30  # s
cd "$(dirname "$0")/.."
locked=${LOCKED:-$(cat .venv/.setup-locked 2>/dev/null || echo 0)}
say() { printf 'setup: %s\n' "$*"; }
fail() { say "$*" >&2; exit 1; }

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
has() { .venv/bin/python -c "import $1" 2>/dev/null; }
imports_dolfinx() { "$1" -c "$dolfinx, ensurepip, sys; sys.exit(sys.version_info < (3, 11))" >/dev/null 2>&1; }

# apt-get, as root or through sudo; fails where there is neither.
apt_install() {
    local admin=() missing=() package
    command -v apt-get >/dev/null || return 1
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
    apt-cache show "${missing[@]}" >/dev/null 2>&1 || telling 'apt-get update' "${get[@]}" update >&2 || return 1
    telling 'apt-get install' "${get[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null || { say "apt-get failed"; return 1; }
}

# The ways to a .venv with dolfinx; each fails where it is not to be had.
over() {  # a Python that has dolfinx
    imports_dolfinx "$1" || return 1
    say ".venv over $1, which has dolfinx $("$1" -c "$dolfinx; print(dolfinx.__version__)")"
    "$1" -m venv --system-site-packages .venv
    # A venv made from another venv sees neither that one's packages nor its dolfinx: name them.
    "$1" -c 'import site, sys; print(*(site.getsitepackages() if sys.prefix != sys.base_prefix else []), sep="\n")' \
        >"$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/active-environment.pth"
}
by_active() {
    over "$(command -v python3)" || return 1
    # pip's wheel in a venv finds its MPI from there alone: .venv gets a wheel of its own.
    imports_dolfinx .venv/bin/python || { rm -rf .venv && by_pip; }
}
by_apt() { apt_install python3-dolfinx python3-gmsh python3-venv && over /usr/bin/python3; }
by_pip() {
    # A bare machine has no Python, and Debian's no venv.
    python3 -c 'import ensurepip' 2>/dev/null || apt_install python3-venv || return 1
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 12))' && [ "$(uname -sm)" = 'Linux x86_64' ] || return 1
    say ".venv of $(command -v python3), with dolfinx by pip"
    python3 -m venv .venv
}
make_environment() {
    local way ways='active pip apt'
    if grep -qs '^VERSION_CODENAME=bookworm' /etc/os-release; then ways='active apt'; fi  # its Python is too old for the wheel
    for way in $ways; do
        rm -rf .venv
        if "by_$way"; then return; fi
    done
    fail "no dolfinx: activate an environment that has it (conda's is one), or install Python 3.12 or newer (x86-64 Linux) or Debian's python3-dolfinx python3-gmsh python3-venv, then run make again"
}

install_project() {  # with these extras
    local options=()
    # dolfinx and petsc4py are compiled against one numpy major version, and must keep it.
    if has 'numpy; assert numpy.__version__ < "2"'; then options=('numpy<2'); fi
    if [ "$locked" != 0 ]; then options+=(-c constraints.txt); fi
    say "pip install -e .[$1] ${options[*]:-} (about a minute)"
    # macOS's bash 3.2 takes an empty array for an unset variable.
    telling 'pip install' .venv/bin/python -m pip --disable-pip-version-check install -q -e ".[$1]" ${options[@]+"${options[@]}"}
}

base_key() { echo "$PWD $(python3 -c 'import sys; print(sys.executable, sys.version)' 2>/dev/null || echo none)"; }
key() { echo "$(base_key) $locked $(cat pyproject.toml constraints.txt tools/setup.sh | cksum)"; }

if [ "$(cat .venv/.setup-done 2>/dev/null)" = "$(key)" ] && .venv/bin/python -c "$find; assert f('dolfinx') and f('jointwave')" 2>/dev/null; then
    say ".venv is up to date"
else
    if [ "$(cat .venv/.setup-base 2>/dev/null)" != "$(base_key)" ] || ! imports_dolfinx .venv/bin/python; then
        make_environment
        base_key >.venv/.setup-base
    fi
    rm -f .venv/.setup-done
    echo "$locked" >.venv/.setup-locked
    extras=test,check
    if ! has dolfinx || has dolfinx_solver; then extras=$extras,continuum; fi
    install_project "$extras"
    .venv/bin/python -c "$dolfinx, numba, jointwave.compare" && key >.venv/.setup-done || fail ".venv does not import dolfinx, numba and compare"
    say "done: .venv/bin/jointwave, or activate it by: . .venv/bin/activate"
fi
case "${1:-}" in
    browser)
        # What gmsh's wheel and forms of dolfinx's need of the system.
        if has dolfinx_solver; then apt_install gcc libc6-dev python3-dev libglu1-mesa libxcursor1 libxft2 libxinerama1 || say "tests of gmsh and of forms will fail"; fi
        command -v chromium >/dev/null || apt_install chromium || say "no chromium here: the page tests will not run"
        has 'ipykernel, jupytext, nbclient, pyvista' || install_project view,examples ;;
    docs) has 'ipykernel, jupytext, latex2mathml, material, mkdocs, nbclient' || install_project docs,examples ;;
esac
