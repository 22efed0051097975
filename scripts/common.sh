# SPDX-License-Identifier: Apache-2.0
# Shared by the scripts of this folder; sourced, not run. Leaves the shell in the project's root.
set -Eeuo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly logs=build/logs
doing="starting"
advice="read the lines above"
may_ask_password=no
if [ -t 0 ] && [ -t 2 ]; then may_ask_password=yes; fi

say() { printf '== %s\n' "$*"; }

fail() {
  trap - ERR
  printf '\n%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

trap 'fail "failed while $doing (exit code $?). What to do: $advice"' ERR

# step <what, as "doing this"> <what to do if it fails>: announces, and is named by a failure.
step() {
  doing=$1
  advice=$2
  say "$doing"
}

# quietly <log name> <command...>: output goes to a log; its end is shown if the command fails.
quietly() {
  local log=$logs/$1.log
  shift
  mkdir -p "$logs"
  if ! "$@" >"$log" 2>&1 </dev/null; then
    tail -n 40 "$log" >&2
    fail "failed while $doing (log: $log). What to do: $advice"
  fi
}

is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Runs a command of apt or dpkg as root, whoever we are; it never waits for an answer.
as_root() {
  local silent=(env DEBIAN_FRONTEND=noninteractive NEEDRESTART_MODE=a LC_ALL=C)
  if [ "$(id -u)" = 0 ]; then
    "${silent[@]}" "$@"
  elif [ "$may_ask_password" = yes ]; then
    sudo "${silent[@]}" "$@"
  else
    sudo -n "${silent[@]}" "$@"
  fi
}

apt() {
  as_root apt-get -y -q -o DPkg::Lock::Timeout=300 -o Dpkg::Options::=--force-confold "$@"
}

# Configures what an interrupted installation left behind, else apt refuses to work.
repair_dpkg() {
  if [ -n "$(dpkg --audit 2>/dev/null)" ]; then as_root dpkg --configure -a; fi
}

# One unreachable source of many fails the update; whether that matters, the install tells.
refresh_package_lists() { apt update || true; }

# install_packages <section...>: installs what is missing of these sections of packages.txt.
install_packages() {
  local missing=() section package
  if ! command -v dpkg-query >/dev/null; then
    say "no apt on this system: the libraries of scripts/packages.txt must be there already"
    return
  fi
  while read -r section package _; do
    case " $* " in
      *" ${section:-#} "*) is_installed "$package" || missing+=("$package") ;;
    esac
  done <scripts/packages.txt
  if [ ${#missing[@]} = 0 ]; then
    say "all packages are installed"
    return
  fi
  local by_hand="apt-get update && apt-get install --no-install-recommends ${missing[*]}"
  if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
    fail "packages are missing, and there is no sudo to install them. As root, run:
  $by_hand"
  fi
  step "installing what is missing, a few minutes at most: ${missing[*]}" \
    "check the network and the package sources, then run as root:
  $by_hand"
  quietly dpkg-repair repair_dpkg
  quietly apt-update refresh_package_lists
  quietly apt-install apt install --no-install-recommends "${missing[@]}"
}

# As many compilers at once as there are cores, and no more than memory has room for.
job_count() {
  local cores free_kb by_memory
  cores=$(nproc)
  free_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  by_memory=$((${free_kb:-0} / 1500000))
  if [ "$by_memory" -lt 1 ]; then by_memory=1; fi
  echo $((cores < by_memory ? cores : by_memory))
}

# configure [cmake argument...]
configure() {
  step "configuring build/release" \
    "read the error above; if this checkout was moved or the compiler changed, remove build/release"
  quietly configure cmake --preset release "$@"
}

# build [target...]: everything where no target is named.
build() {
  step "building ${*:-everything}, $(job_count) at a time" "read the first compiler error above"
  local target targets=() tool=()
  for target in "$@"; do targets+=(--target "$target"); done
  if ! [ -t 1 ]; then tool=(-- --quiet); fi
  cmake --build --preset release -j "$(job_count)" "${targets[@]}" "${tool[@]}" </dev/null
}

# write_block NAME [PAGE]: replaces the block NAME that this script writes in the page (README.md) by
# standard input.
write_block() {
  local page=${2:-README.md} begin block
  begin="<!-- scripts/$(basename "$0") writes from here: $1 -->"
  block=$(cat)
  [ -n "$block" ] || fail "nothing to write as block $1 of $page"
  grep -qxF -e "$begin" "$page" || fail "$page has no block $1"
  BLOCK=$block awk -v begin="$begin" '
    $0 == begin {print; print ENVIRON["BLOCK"]; skip = 1; next}
    skip && $0 == "<!-- to here -->" {skip = 0}
    !skip {print}' "$page" >"$page.part"
  mv "$page.part" "$page"
}

# read_block NAME PAGE: prints that block.
read_block() {
  awk -v begin="<!-- scripts/$(basename "$0") writes from here: $1 -->" '
    $0 == "<!-- to here -->" {inside = 0}
    inside {print}
    $0 == begin {inside = 1}' "$2"
}
