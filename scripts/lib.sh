# Shared by the scripts beside it; source it, do not run it.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=$(basename "$0")

say() { printf '%s: %s\n' "$program" "$*"; }

# die CODE MESSAGE: one line on stderr. Codes are those of the executables: 1 it ran and fell short,
# 2 unusable arguments or input, 3 the machine.
die() {
  local code=$1
  shift
  printf '%s: %s\n' "$program" "$*" >&2
  exit "$code"
}

# How many compilers may run at once: one a core, and 1.5 GB of memory for each (Ceres and Eigen need it).
build_jobs() {
  local cores memory_kb limit
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
  if [[ $limit != max ]] && ((limit / 1024 < memory_kb)); then memory_kb=$((limit / 1024)); fi
  local by_memory=$((memory_kb / 1500000))
  local jobs=$((cores < by_memory ? cores : by_memory))
  echo $((jobs > 0 ? jobs : 1))
}

# start_control_view LOG READY_S COMMAND...: starts the daemon in the background, waits until it says where it
# listens, and leaves its process id in control_view_pid and its endpoint in control_view_endpoint.
# The caller stops it (stop_process), also when this fails.
start_control_view() {
  local log=$1 ready_s=$2
  shift 2
  "$@" >"$log" 2>&1 &
  control_view_pid=$!
  local deadline=$((SECONDS + ready_s)) status
  until control_view_endpoint=$(sed -n 's/^control_view: listening on //p;' "$log" | head -n 1) &&
    [[ -n $control_view_endpoint ]]; do
    if ! kill -0 "$control_view_pid" 2>/dev/null; then
      wait "$control_view_pid" && status=3 || status=$?
      control_view_pid=
      [[ -s $log ]] || die "$status" "control_view ended before it was ready and said nothing"
      tail -n 1 "$log" >&2
      exit "$status"
    fi
    ((SECONDS < deadline)) || die 3 "control_view was not ready within $ready_s s; its output is in $log"
    sleep 0.05
  done
}

# stop_process PID: asks, waits up to 5 s, then insists. Nothing to do where PID is empty or gone.
stop_process() {
  local pid=$1 tries=0
  [[ -n $pid ]] || return 0
  kill -TERM "$pid" 2>/dev/null || return 0
  while kill -0 "$pid" 2>/dev/null; do
    if ((++tries > 100)); then
      kill -KILL "$pid" 2>/dev/null
      break
    fi
    sleep 0.05
  done
  wait "$pid" 2>/dev/null || true
}

# our_sources FIND_TEST...: the sources of this repository that pass the test, each ended by a NUL.
our_sources() {
  find common protocol control_view main_view tests docs -type f \( "$@" \) -print0 | sort -z
}
