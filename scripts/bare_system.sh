# SPDX-License-Identifier: Apache-2.0
# A bare Debian in a folder, for scripts/bare and scripts/bare-package. Sourced after common.sh with the
# arguments of the script, of which `release` is one; starts the script again in namespaces of its own.
if [ "$(id -u)" != 0 ]; then fail "chroot and mount need root: run sudo scripts/$(basename "$0") $*"; fi
if ! command -v debootstrap >/dev/null; then
  fail "debootstrap is missing. Run: apt-get install --no-install-recommends debootstrap"
fi

# Mounts and processes live in namespaces of their own: both are gone when this script ends, however
# it ends.
if [ "${SEXTANT_BARE_INSIDE:-}" != yes ]; then
  SEXTANT_BARE_INSIDE=yes unshare --mount --pid --fork --kill-child --propagation private \
    "$PWD/scripts/$(basename "$0")" "$@" </dev/null &
  namespace=$!
  # Ends all that runs inside.
  trap 'kill -KILL "$namespace" 2>/dev/null || true' EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
  status=0
  wait "$namespace" || status=$?
  exit $status
fi

mkdir -p "${SEXTANT_BARE:-build/bare}"
folder=$(realpath -- "${SEXTANT_BARE:-build/bare}")
readonly folder base=$folder/$release.tar root=$folder/$release
times=()

# timed <name> <command...>: notes the wall time, also of a command that fails.
timed() {
  local name=$1 start=$SECONDS status=0
  shift
  "$@" || status=$?
  local took=$((SECONDS - start))
  times+=("$(printf '%-22s %3d min %02d s%s' "$name" $((took / 60)) $((took % 60)) \
    "$([ $status = 0 ] || echo ', FAILED')")")
  return $status
}

# The host's mirror of Debian; empty where the host is another system: debootstrap has a default.
host_mirror() {
  apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' \
    2>/dev/null | head -n 1
}

# How the host's apt reaches its mirror: proxies, certificates, checks of dates.
host_apt_settings() {
  apt-config dump |
    grep -E '^Acquire::((http|https|ftp)::|Retries|Check-Date|Check-Valid-Until|Max-ValidTime)' || true
}

bootstrap() {
  local mirror
  mirror=$(host_mirror)
  rm -rf --one-file-system "$root" "$base.part"
  debootstrap --variant=minbase "$release" "$root" ${mirror:+"$mirror"} &&
    tar -C "$root" -cf "$base.part" . && mv "$base.part" "$base"
}

unpack() {
  rm -rf --one-file-system "$root" && mkdir -p "$root" && tar -C "$root" -xpf "$base"
}

enter_host_settings() {
  local setting file
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  host_apt_settings >"$root/etc/apt/apt.conf.d/99host"
  # Certificates that these settings name.
  while read -r setting; do
    file=$(sed -nE 's/^[^ ]+ "(\/[^"]+)";$/\1/p' <<<"$setting")
    if [ -n "$file" ] && [ -f "$file" ]; then cp -L --parents "$file" "$root"; fi
  done <"$root/etc/apt/apt.conf.d/99host"
}

mount_all() {
  mount -t proc proc "$root/proc"
  mount --rbind /dev "$root/dev"
  mount --rbind /sys "$root/sys"
  local data=${SEXTANT_DATA:-../shared/data}
  if [ -d "$data" ]; then
    mkdir -p "$root/data"
    mount --bind "$data" "$root/data"
    mount -o remount,bind,ro "$root/data"
  fi
  if [ -n "${SEXTANT_BARE_CCACHE:-}" ]; then
    mkdir -p "$SEXTANT_BARE_CCACHE" "$root/ccache"
    mount --bind "$SEXTANT_BARE_CCACHE" "$root/ccache"
  fi
}

# inside COMMAND: in /srv/sextant of the bare system. Of the host's environment only proxies reach it.
inside() {
  local environment=(HOME=/root LC_ALL=C.UTF-8 TERM=dumb
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
  local name
  for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY; do
    if [ -n "${!name:-}" ]; then environment+=("$name=${!name}"); fi
  done
  if [ -d "$root/data" ]; then environment+=(SEXTANT_DATA=/data); fi
  if [ -d "$root/ccache" ]; then environment+=(CCACHE_DIR=/ccache); fi
  chroot "$root" env -i "${environment[@]}" bash -c "cd /srv/sextant && $1" </dev/null
}

# start_system: the base system, unpacked afresh and mounted.
start_system() {
  if ! [ -f "$base" ]; then
    step "bootstrapping $release into $base" "check the network and the mirror, read build/logs/bare-$release.log"
    timed "debootstrap" quietly "bare-$release" bootstrap
  fi
  step "unpacking $base afresh" "check the free space; remove $base where it is damaged"
  unpack
  enter_host_settings
  step "mounting /proc, /dev and /sys in $root" "this needs root and a kernel with namespaces"
  mount_all
}
