#!/bin/bash
# tuft.sh: installs what is missing, builds, runs. `./tuft.sh help` lists the verbs.
# SPDX-License-Identifier: GPL-2.0-or-later
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$root/build/release
jobs=$(nproc)
programs=(tuft_app liggghts_host)  # targets of what a user runs

# Everything a bare Debian 12 lacks to build, test and run. One place: README and CI rely on this list.
packages=(
  g++ cmake ninja-build ccache pkg-config           # compiler and build
  libeigen3-dev libfmt-dev libspdlog-dev             # vectors, formatting, logging
  libtomlplusplus-dev libcli11-dev nlohmann-json3-dev # scenes, command line, summaries
  libudunits2-dev libudunits2-data                   # units
  libhdf5-dev                                        # results
  libzmq3-dev cppzmq-dev                             # the wire to the DEM host
  libnlopt-cxx-dev                                   # calibration
  libliggghts-dev libopenmpi-dev openmpi-bin         # the DEM host, and its ranks
  libgtest-dev libgmock-dev libbenchmark-dev                  # tests and benchmarks
)

usage() {
  cat <<'TEXT'
./tuft.sh demo                  the Clegg drop on both kinds of infill, with a report (some minutes)
./tuft.sh test [CTEST ARGS]     builds and runs the tests
./tuft.sh build                 installs what is missing, configures, builds
./tuft.sh bench [--json FILE]   measures speed
./tuft.sh validate | hard       long checks of the physics, minutes each | the hard cases
./tuft.sh VERB ...              anything else goes to the built program: tuft run, check, explain, compare, ...
TEXT
}

fail() {
  echo "tuft.sh: $*" >&2
  exit 1
}

missing_packages() {
  local installed package
  # The status too: dpkg-query also knows packages that were removed but left their settings behind. It fails when one
  # name is unknown to it, and prints the others.
  # shellcheck disable=SC2016
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null || true)
  for package in "${packages[@]}"; do
    [[ $'\n'$installed$'\n' == *$'\n'"$package installed"$'\n'* ]] || echo "$package"
  done
}

install_packages() {
  command -v dpkg-query >/dev/null || fail "this is not a Debian system; install the equivalents of: ${packages[*]}"
  local missing
  mapfile -t missing < <(missing_packages)
  ((${#missing[@]})) || return 0
  local as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || fail "packages are missing and there is no sudo; as root: apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  echo "tuft.sh: installing ${missing[*]}"
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" </dev/null
}

# build [TARGET...]: all, or what a verb needs; tests take longer to compile than the rest.
build() {
  install_packages
  # Presets are looked up in the working directory.
  cd "$root"
  [[ -f $build/build.ninja ]] || cmake --preset release
  cmake --build --preset release --parallel "$jobs" ${1:+--target "$@"}
}

run_tests() {
  cd "$root"
  ctest --preset release --parallel 2 "$@"
}

demo() {
  local out=$root/out/demo
  # Only a folder that an earlier demo made is removed: it carries this mark.
  local mark=$out/.made_by_demo
  if [[ -e $out ]]; then
    [[ -f $mark ]] || fail "$out is in the way and was not made by the demo; move it"
    rm -r "$out"
  fi
  # Also when the run is interrupted, so that the next demo can start.
  # shellcheck disable=SC2064
  trap "[[ ! -d '$out' ]] || touch '$mark'" EXIT
  cd "$root"
  "$build/bin/tuft" compare inputs/clegg_small.toml --out out/demo
  echo
  echo "The report: $out/report.html"
}

bench() {
  local caller=$PWD json=
  if [[ ${1:-} == --json ]]; then
    [[ -n ${2:-} ]] || fail "bench --json needs a file name"
    json=$2
    [[ $json == /* ]] || json=$caller/$json
    shift 2
  fi
  (($# == 0)) || fail "bench takes --json FILE only, not: $*"
  build "${programs[@]}" bench/all
  "$build/bin/bench_driver" --programs "$build/bin" --tuft "$build/bin/tuft" \
    --scene "$root/inputs/clegg_small.toml" ${json:+--json "$json"}
}

verb=${1:-help}
case $verb in
  help | -h | --help) usage ;;
  build) build ;;
  test) shift; build; run_tests --label-exclude '^validation$' "$@" ;;
  validate) shift; build; run_tests --label-regex '^validation$' --no-tests=error "$@" ;;
  hard) shift; build; run_tests --label-regex '^hard_cases$' --no-tests=error "$@" ;;
  bench) shift; bench "$@" ;;
  demo) build "${programs[@]}"; demo ;;
  *)
    # Relative paths among the arguments are the caller's, so the program starts where the caller is.
    [[ -x $build/bin/tuft && -x $build/bin/liggghts_host ]] || (build "${programs[@]}" >&2)
    exec "$build/bin/tuft" "$@"
    ;;
esac
