#!/bin/sh
# Build sdist and wheel of the committed sources, install the wheel into an empty environment of $PYTHON (default python3) and
# try it there, away from the repository. With Python 3.12 or newer on x86-64 Linux the continuum is installed by pip, too.
set -eu
umask 022  # modes of files are part of a wheel
python=${PYTHON:-python3}
root=$(git rev-parse --show-toplevel)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct)
export SOURCE_DATE_EPOCH
git -C "$root" -c tar.umask=022 archive --prefix=source/ HEAD | tar x -C "$work"
"$python" -m venv "$work/build" "$work/env"
"$work/build/bin/pip" install -q build
build() { (cd "$1" && "$work/build/bin/python" -m build -q --outdir "$2" .); }  # sources, into
build "$work/source" "$root/dist"
wheel=$(ls -t "$root"/dist/jointwave-*.whl | head -1)
sum=$(sha256sum <"$wheel")
# Again from files of another time in another folder: the same, bit for bit.
cp -r "$work/source" "$work/again"
build "$work/again" "$work/dist"
test "$sum" = "$(sha256sum <"$work/dist/$(basename "$wheel")")"
echo "${sum%% *}  $(basename "$wheel")"
extra='' engines='not continuum'
if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 12))'; then extra='[continuum]' engines=''; fi
"$work/env/bin/pip" install -q "$wheel$extra" pytest pytest-xdist hypothesis
cd "$work"
PATH="$work/env/bin:$PATH"
jointwave doctor || [ -z "$extra" ]
jointwave compare guo-li-2002/fig-03
shipped=$(python -c 'from jointwave import cases; print(cases.__path__[0])')
mkdir scenes
cp "$shipped"/guo-li-2002/fig-0[37].toml scenes
python -m pytest -q scenes -k "$engines"
# Tests that need no checkout, with the closed forms that they share.
cp -r "$work/source/tests" tests
PYTHONPATH="$work/tests/theory" python -m pytest -q -n auto --import-mode=importlib -m 'not slow' -k 'not imports_nothing_of' tests/cases tests/joints tests/results tests/test_jointwave.py
if [ -n "$extra" ]; then mpiexec -n 2 jointwave run guo-li-2002/fig-07 --engine continuum --out ranks; fi
jointwave report scenes/fig-07.toml --out page
ls -l page/index.html
