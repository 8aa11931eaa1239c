#!/usr/bin/env bash
# Installs what trueblade needs (Debian packages only), builds it, and inspects the demonstration blade.
# Further options go to `trueblade inspect`, as in: scripts/inspect.sh --seed 7
# May be run again at any time: what is there already is not done twice.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh

install_packages

echo "== build: build/release"
cmake --preset release $(compiler_cache_options) --log-level=WARNING
cmake --build --preset release --target trueblade

echo "== inspect: scenarios/turbine_blade_front.yaml"
exec build/release/trueblade inspect scenarios/turbine_blade_front.yaml "$@"
