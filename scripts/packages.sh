# Sourced by the scripts beside it: installs the Debian packages that trueblade is built from, if any is missing.
# Debian packages only; nothing else is fetched. Works as root or with sudo; says what it does.

trueblade_packages=(
  # tools
  build-essential cmake ninja-build pkg-config git clang-format
  # geometry, search, random numbers, threads
  libeigen3-dev libopenmesh-dev libembree-dev libtbb-dev librandom123-dev libhwy-dev
  # CAD files (find_package(OpenCASCADE) wants the headers of all its modules)
  libocct-foundation-dev libocct-modeling-data-dev libocct-modeling-algorithms-dev
  libocct-data-exchange-dev libocct-ocaf-dev libocct-visualization-dev
  # cross-check of the registration
  libceres-dev
  # scenarios, reports, command line
  libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libspdlog-dev libfmt-dev libopenexr-dev libpng-dev
  libcairo2-dev fonts-dejavu-core libjs-three
  # studies: results, plots, more than one machine
  libsqlite3-dev libjs-chart.js libopenmpi-dev openmpi-bin
  # checksums of journals and sample streams
  zlib1g-dev
  # tests and benchmarks
  libgtest-dev libbenchmark-dev libnanoflann-dev python3-jsonschema chromium
)

package_is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

install_packages() {
  local missing=() package
  for package in "${trueblade_packages[@]}"; do
    package_is_installed "$package" || missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then
    echo "== packages: all ${#trueblade_packages[@]} are installed"
    return 0
  fi
  echo "== packages: installing ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "error: installing packages needs root. As root, run: apt-get install ${missing[*]}" >&2
      return 1
    }
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get -q update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "${missing[@]}"
}

# A compiler cache is used where the machine has one, and is not needed. It cannot answer for precompiled headers, and its
# answers serve every clone on the machine when paths are taken relative to the clone.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
compiler_cache_options() {
  if command -v ccache >/dev/null; then
    echo -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
  fi
}
