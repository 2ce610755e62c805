#!/usr/bin/env bash
#SBATCH --job-name=irsig
#SBATCH --signal=TERM@300
# A sweep computed by the tasks of a Slurm job: a coordinator on the first node, one worker a task.
#
# usage, in the folder of the repository, which all nodes see:
#   sbatch --ntasks=64 --cpus-per-task=1 --mem-per-cpu=2G --time=8:00:00 ops/slurm/farm.sh SWEEP DATABASE
#
# Five minutes before the time limit (--signal above; `sbatch --signal=TERM@600` for jobs that take
# longer) Slurm asks the workers to end: each finishes its job, the database becomes one plain file,
# and the exit code is 1. The same command goes on where it stopped. 0: every job is done.
#
# Coordinator and workers talk over TLS, with certificates that are made for this job and go with
# it. DATABASE should be on a file system with locks that work (SQLite's).
#
# IRSIG_ROOT (the folder of sbatch): where ops/ and build/release/bin are.
# IRSIG_FARM_HOST (this node's name): the name under which the other nodes reach this one.
set -euo pipefail
if (($# != 2)); then
  echo "usage: sbatch ops/slurm/farm.sh SWEEP DATABASE" >&2
  exit 2
fi
sweep=$1 database=$2
root=${IRSIG_ROOT:-${SLURM_SUBMIT_DIR:-$PWD}}
bin=$root/build/release/bin
host=${IRSIG_FARM_HOST:-${SLURMD_NODENAME:-$(hostname)}}
for program in irsig irsig-coordinator irsig-worker; do
  [[ -x $bin/$program ]] || { echo "farm.sh: $bin/$program is missing; IRSIG_ROOT says where" >&2; exit 2; }
done

# On the file system that all nodes see; the keys are of mode 0600.
scratch=$(mktemp -d "$PWD/.irsig-farm-XXXXXX")
coordinator= workers=
finish() {
  local code=$?
  trap '' TERM INT
  if [[ -n $workers ]]; then kill -TERM "$workers" 2> /dev/null || :; wait "$workers" || :; fi
  if [[ -n $coordinator ]]; then kill -TERM "$coordinator" 2> /dev/null || :; wait "$coordinator" || code=1; fi
  rm -rf -- "$scratch"
  exit "$code"
}
trap finish EXIT
trap 'exit 1' TERM INT

# One certificate for the coordinator, one for workers, one for the commands below.
tls=$scratch/tls
"$bin/irsig" ca init "$tls" --days 366
"$bin/irsig" ca issue "$tls" coordinator --out "$tls" --days 365 --host "$host"
"$bin/irsig" ca issue "$tls" worker --out "$tls" --days 365 --role work
"$bin/irsig" ca issue "$tls" user --out "$tls" --days 365 --role submit --role read
said=$scratch/coordinator
"$bin/irsig-coordinator" --db "$database" --listen "$host:0" --tls-cert "$tls/coordinator.pem" \
  --tls-key "$tls/coordinator.key" --tls-ca "$tls/ca.pem" > "$said" &
coordinator=$!
until address=$(sed -n 's/.*listening on //p' "$said") && [[ -n $address ]]; do
  kill -0 "$coordinator" 2> /dev/null || { coordinator=; exit 1; }  # it has said why
  sleep 0.1
done
reach=(--coordinator "$address" --tls-ca "$tls/ca.pem")
as_user=("${reach[@]}" --tls-cert "$tls/user.pem" --tls-key "$tls/user.key")
as_worker=("${reach[@]}" --tls-cert "$tls/worker.pem" --tls-key "$tls/worker.key")

"$bin/irsig" submit "$sweep" "${as_user[@]}"
# A task that fails is one worker less; the others go on.
srun --kill-on-bad-exit=0 "$bin/irsig-worker" --exit-when-finished --spool "$scratch/spool" "${as_worker[@]}" &
workers=$!
# Signals come through while it is waited for, and workers that were asked to end do so by themselves.
trap 'kill -TERM "$workers" 2> /dev/null || :' TERM INT
while kill -0 "$workers" 2> /dev/null; do wait "$workers" || :; done
workers=
trap 'exit 1' TERM INT

"$bin/irsig" status "${as_user[@]}"
open=$("$bin/irsig" status --format csv "${as_user[@]}" |
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
           { open += $at["jobs"] - $at["done"] - $at["cancelled"] } END { print open + 0 }')
if ((open > 0)); then
  echo "farm.sh: $open jobs are not done; the same command goes on with them" >&2
  exit 1
fi
