#!/usr/bin/env bash
# Runs `make test` in a fresh Debian 13, whose Python and numpy are newer than Debian 12's, with pip's dolfinx and with
# Debian's own, one after the other, and compares waveforms with those of this machine's .venv, to 1e-9.
#   usage: [DOLFINX="pip apt"] tools/debian13.sh [COMMAND]    (default: make test, then tools/waveforms.py)
# The root is made once and kept under the user's cache directory; every run copies the working tree into it anew. pip
# comes first: what apt's dolfinx brings along might hide what the wheel lacks.
set -euo pipefail
cd "$(dirname "$0")/.."

say() { printf 'debian13: %s\n' "$*"; }

waveforms=build/waveforms.npz
if [ -z "${IN_NAMESPACE:-}" ] && [ $# -eq 0 ]; then
    rm -f "$waveforms"
    if [ -e .venv/.setup-done ]; then
        tools/run.sh python tools/waveforms.py "$waveforms"
    else
        say "no .venv here (make setup): no waveforms to compare with"
    fi
fi

cache=${JOINTWAVE_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/jointwave}
# Mounts below live in a mount namespace of their own, so the kernel undoes them however this script ends.
if [ -z "${IN_NAMESPACE:-}" ]; then
    command -v apt-get >/dev/null || { say "needs Debian or Ubuntu (debootstrap, apt-get)" >&2; exit 1; }
    admin=()
    if [ "$(id -u)" != 0 ]; then
        admin=(sudo --preserve-env)
        say "sudo: a chroot needs root"
    fi
    missing=()
    for package in debootstrap debian-archive-keyring; do
        dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
    done
    if [ ${#missing[@]} -gt 0 ]; then
        say "apt-get install ${missing[*]}"
        "${admin[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
    fi
    exec "${admin[@]}" env PATH="$PATH:/usr/sbin:/sbin" IN_NAMESPACE=1 JOINTWAVE_CACHE="$cache" \
        unshare --mount --pid --fork --kill-child "$0" "$@"
fi

root=$cache/debian13
complete=$root/.complete
mkdir -p "$cache"
exec 9>"$root.lock"
flock -n 9 || { say "another run is at work in $root" >&2; exit 1; }

# The host's own way to the network, so that apt and pip work in the root behind a mirror, a proxy or a company CA.
mirror=${DEBIAN_MIRROR:-}
if [ -z "$mirror" ]; then
    # shellcheck disable=SC2016  # apt's own placeholder
    mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -m1 '/debian/$' || true)
fi
mirror=${mirror:-http://deb.debian.org/debian/}

make_root() {
    say "building $root (debootstrap from $mirror, a minute)"
    rm -rf "$root"
    mkdir -p "$root"
    local log=$cache/debootstrap.log
    debootstrap --variant=minbase --include=make,ca-certificates trixie "$root" "$mirror" >"$log" 2>&1 ||
        { tail -n 5 "$log" >&2; say "debootstrap failed, see $log" >&2; exit 1; }
    touch "$complete"
}

share_network() {
    cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
    apt-config dump | grep -E '^Acquire::(http|https|ftp|Check|Retries|ForceIPv)' >"$root/etc/apt/apt.conf.d/90host" || true
    cp -L "${PIP_CERT:-${SSL_CERT_FILE:-/etc/ssl/certs/ca-certificates.crt}}" "$root/etc/host-ca.crt"
    for config in /etc/pip.conf "$HOME/.config/pip/pip.conf" "$HOME/.pip/pip.conf"; do
        if [ -f "$config" ]; then cp "$config" "$root/etc/pip.conf"; fi
    done
}

copy_sources() {  # into
    mkdir -p "$1"
    # .venv stays: its stamp knows whether it still fits, and a second run is quick.
    find "$1" -mindepth 1 -maxdepth 1 ! -name .venv -exec rm -rf {} +
    git -c safe.directory="$PWD" ls-files -z --cached --others --exclude-standard |
        while IFS= read -r -d '' file; do
            # A file deleted but not committed is still listed.
            if [ -e "$file" ] || [ -L "$file" ]; then printf '%s\0' "$file"; fi
        done | tar --create --file=- --no-recursion --null --files-from=- | tar --extract --no-same-owner --directory="$1"
    if [ -f "$waveforms" ]; then install -D "$waveforms" "$1/$waveforms"; fi
}

mount_kernel() {
    mount -t proc proc "$root/proc"
    mount --bind -o ro /sys "$root/sys"
    mount --rbind /dev "$root/dev"  # with its terminals
    mkdir -p "$root/dev/shm"
    mount -t tmpfs tmpfs "$root/dev/shm"
}

[ -f "$complete" ] || make_root
share_network
mount_kernel

environment=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 TERM="${TERM:-dumb}")
environment+=(PIP_CERT=/etc/host-ca.crt SSL_CERT_FILE=/etc/host-ca.crt REQUESTS_CA_BUNDLE=/etc/host-ca.crt)
for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY \
    PIP_INDEX_URL PIP_EXTRA_INDEX_URL PIP_TRUSTED_HOST PIP_DEFAULT_TIMEOUT; do
    if [ -n "${!name:-}" ]; then environment+=("$name=${!name}"); fi
done

compare="! [ -f $waveforms ] || tools/run.sh python tools/waveforms.py $waveforms"
[ $# -gt 0 ] || set -- sh -c "make test && { $compare; }"
failed=0
for way in ${DOLFINX:-pip apt}; do
    copy_sources "$root/src/$way"
    say "$* (in $root/src/$way)"
    began=$SECONDS outcome=passed
    chroot "$root" env -i "${environment[@]}" DOLFINX="$way" sh -c "cd /src/$way"' && exec "$@"' sh "$@" || { outcome=failed; failed=1; }
    say "dolfinx by $way: $outcome after $((SECONDS - began)) s"
done
exit $failed
