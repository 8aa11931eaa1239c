#!/usr/bin/env bash
# Hardware in the loop: the LinuxCNC controller with simulated drives, and a virtual part before the probe.
#   scripts/linuxcnc.sh start SCENARIO.yaml     waits until controller and sample stream answer
#   scripts/linuxcnc.sh stop
# LinuxCNC does not run as root: called by root, everything runs as the ordinary user "trueblade", who is made for it.
# TRUEBLADE_BUILD chooses the build folder (default: build/release, else build/dev); TRUEBLADE_LOOP the folder in which
# the controller keeps its files (default: /tmp/trueblade_loop); TRUEBLADE_CONFIG the controller's configuration (default:
# hardware/linuxcnc/config).
set -euo pipefail
cd "$(dirname "$0")/.."

loop=${TRUEBLADE_LOOP:-/tmp/trueblade_loop}
user=trueblade
usage() { sed -n '2,8p' "$0" | cut -c3-; exit 2; }

as_user() {
  if [ "$(id -u)" -eq 0 ]; then
    runuser -u "$user" -- env HOME="$loop" PATH="$loop/bin:/usr/bin:/bin" "$@"
  else
    env PATH="$loop/bin:$PATH" "$@"
  fi
}

answers() { (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }

stop() {
  [ -d "$loop" ] || { echo "linuxcnc: not running"; return 0; }
  if [ -s "$loop/pid" ] && kill -0 "$(cat "$loop/pid")" 2>/dev/null; then
    # As its own user interface would: the controller ends in order and takes its components along.
    if answers 5007; then
      { exec 3<>/dev/tcp/127.0.0.1/5007
        printf 'hello EMC stop 1.0\r\nset enable EMCTOO\r\nshutdown\r\n' >&3
        timeout 5 cat <&3 >/dev/null || true
        exec 3>&-; } 2>/dev/null || true
    fi
    for _ in $(seq 100); do kill -0 "$(cat "$loop/pid")" 2>/dev/null || break; sleep 0.1; done
    if kill -0 "$(cat "$loop/pid")" 2>/dev/null; then
      echo "linuxcnc: does not end by itself, killed"
      as_user bash -c 'kill -TERM -- -"$1"; sleep 2; kill -KILL -- -"$1" 2>/dev/null || true' _ "$(cat "$loop/pid")" || true
    fi
  fi
  # What a crashed session leaves: realtime threads and shared memory.
  as_user halrun -U >/dev/null 2>&1 || true
  rm -rf "$loop"
  echo "linuxcnc: stopped"
}

start() {
  local scenario=$1 build=${TRUEBLADE_BUILD:-}
  command -v linuxcnc >/dev/null || { echo "error: LinuxCNC is not installed: apt-get install linuxcnc-uspace linuxcnc-uspace-dev" >&2; exit 3; }
  [ -n "$build" ] || { build=build/release; [ -x "$build/trueblade-hal" ] || build=build/dev; }
  for program in trueblade-hal trueblade-listen-on.so trueblade-virtual-probe; do
    [ -x "$build/$program" ] || { echo "error: $build/$program is not built (linuxcnc-uspace-dev missing?)" >&2; exit 3; }
  done
  [ -f "$scenario" ] || { echo "error: $scenario is not there" >&2; exit 2; }
  ! answers 5007 || { echo "error: something answers on port 5007 already; scripts/linuxcnc.sh stop" >&2; exit 3; }
  scenario=$(realpath "$scenario")

  rm -rf "$loop"
  cp -r "${TRUEBLADE_CONFIG:-hardware/linuxcnc/config}" "$loop"
  cp "$build/trueblade-hal" "$build/trueblade-listen-on.so" "$build/trueblade-virtual-probe" "$loop/bin/"
  sed -i "s|^PROGRAM = .*|PROGRAM = $loop/trueblade.ngc|; s|^SCENARIO = .*|SCENARIO = $scenario|" "$loop/trueblade.ini"
  : > "$loop/trueblade.tbl"
  if [ "$(id -u)" -eq 0 ]; then
    id "$user" >/dev/null 2>&1 || useradd --system --no-create-home --shell /bin/bash "$user"
    chown -R "$user" "$loop"
  fi
  # It outlives this script, and must not keep the caller's end of a pipe open.
  (as_user setsid bash -c 'echo $$ > "$1/pid"; cd "$1"; exec linuxcnc -r trueblade.ini > linuxcnc.log 2>&1' _ "$loop" \
    </dev/null >/dev/null 2>&1 &)
  for _ in $(seq 600); do
    if answers 5007 && answers 5008; then
      echo "linuxcnc: running; commands on port 5007, samples on port 5008, log in $loop/linuxcnc.log"
      return 0
    fi
    sleep 0.1
    if [ -s "$loop/pid" ] && ! kill -0 "$(cat "$loop/pid")" 2>/dev/null; then break; fi
  done
  echo "error: the controller did not come up:" >&2
  tail -40 "$loop/linuxcnc.log" >&2
  exit 3
}

case ${1:-} in
  start) [ $# -eq 2 ] || usage; start "$2" ;;
  stop) [ $# -eq 1 ] || usage; stop ;;
  *) usage ;;
esac
