#!/usr/bin/env bash
# Fuzzes what reads from the network and from torn journals (tests/fuzz/network_input_fuzz.cpp) with libFuzzer and the
# sanitizers; needs clang.
#   scripts/fuzz.sh [SECONDS]     default: 600
# New inputs that reach new code go to build/fuzz/corpus; a finding ends with exit code 1 and leaves the input there.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-600}
command -v clang++ >/dev/null || { echo "skipped: clang is not installed (apt-get install clang)" >&2; exit 77; }
mkdir -p build/fuzz/corpus
clang++ -std=c++20 -O1 -g -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined -I. -isystem /usr/include/eigen3 \
  tests/fuzz/network_input_fuzz.cpp geometry/error.cpp hardware/bytes.cpp hardware/machine_driver.cpp hardware/scan_plan.cpp \
  hardware/linuxcnc/{driver_request,line_reader,rsh_reply,sample_frame,sample_picker,scan_program}.cpp hardware/recorded/journal.cpp \
  -lfmt -lz -o build/fuzz/network_input_fuzz
exec build/fuzz/network_input_fuzz -max_total_time="$seconds" -max_len=4096 -artifact_prefix=build/fuzz/ \
  build/fuzz/corpus tests/fuzz/corpus
