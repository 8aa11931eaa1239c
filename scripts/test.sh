#!/usr/bin/env bash
# Installs what trueblade needs (Debian packages only), builds everything and runs all tests.
#   scripts/test.sh [PRESET]     dev (default: warnings are errors), release, or asan (sanitizers)
# May be run again at any time: what is there already is not done twice.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
preset=${1:-dev}

install_packages

echo "== build: build/$preset"
cmake --preset "$preset" $(compiler_cache_options) --log-level=WARNING
cmake --build --preset "$preset"

echo "== tests: $preset"
log=build/$preset/Testing/Temporary/LastTest.log
passed=0
ctest --preset "$preset" --parallel "$(nproc)" || passed=$?
# Why tests were left out, which ctest itself keeps to its log.
grep "^skipped: " "$log" || true
exit "$passed"
