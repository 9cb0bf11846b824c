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

# Runs every test of the CMake build folder $1, and ends with the line `N passed, N failed`.
run_tests() {
  local results=$1/test_results/omnitag
  rm -rf "$results"
  mkdir -p "$results"
  ctest --test-dir "$1" --parallel "$(nproc)" --timeout 900 --output-on-failure \
    --output-junit "$results/ctest.xml" || true
  /usr/bin/python3 "$root/scripts/summarize_tests.py" "$results"
}
