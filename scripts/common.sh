# shellcheck shell=bash
# Sourced by the scripts of this folder.

set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)

# Another Python in front of the system's (pyenv, conda) breaks catkin.
export PATH=/usr/bin:/bin:/usr/sbin:/sbin:$PATH

fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

# For a script without arguments: answers --help with the script's leading comment.
accept_only_help() {
  case ${1:-} in
    '') ;;
    -h | --help) sed -n '3,/^$/s/^# \{0,1\}//p' "$0" && exit ;;
    *) fail "unknown argument '$1' (see --help)" ;;
  esac
}

# How many compilers may run at a time: each may take 2 GB.
parallel_jobs() {
  local processors by_memory
  processors=$(nproc)
  by_memory=$(awk '/^MemTotal:/ { print int($2 / 2000000) }' /proc/meminfo)
  echo $((by_memory < 1 ? 1 : by_memory < processors ? by_memory : processors))
}

# Configures the core alone in the CMake build folder $1 with the sanitizers $2, unless it is, with
# CMake's further options. Built by clang, which warns of other things. What of undefined behaviour is
# not checked takes most of the time to compile, and stops by itself, or with the address sanitizer.
# A workspace that was sourced has a core of its own, which tests that follow are not to load.
configure_sanitized() {
  local unchecked=null,alignment,object-size,pointer-overflow,vptr
  local ignorelist=-fsanitize-ignorelist=$root/scripts/sanitizer_ignorelist.txt
  unset LD_LIBRARY_PATH
  [[ ! -f $1/build.ninja ]] || return 0
  cmake -S "$root" -B "$1" -G Ninja -DOMNITAG_ROS=OFF -DOMNITAG_SANITIZE="$2" \
    -DCMAKE_CXX_COMPILER=clang++ -DOMNITAG_WERROR=ON \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo "${@:3}" \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O2 -g1 -fno-sanitize=$unchecked $ignorelist"
}

# Runs the tests of the CMake build folder $1, $2 at a time, that the further arguments, which are
# ctest's, choose; all without. Ends with the line `N passed, N failed`.
run_tests() {
  local build=$1 jobs=$2
  shift 2
  local results=$build/test_results/omnitag
  local failed=$build/Testing/Temporary/LastTestsFailed.log
  local status=0
  rm -rf "$results" "$failed"
  mkdir -p "$results"
  cd "$build"
  ctest --show-only=json-v1 "$@" > "$results/ctest.json" || true
  ctest --parallel "$jobs" --timeout 900 --output-on-failure "$@" || status=$?
  [[ ! -f $failed ]] || cp "$failed" "$results/ctest_failed.log"
  echo "$status" > "$results/ctest_status"
  /usr/bin/python3 "$root/scripts/summarize_tests.py" "$results"
}
