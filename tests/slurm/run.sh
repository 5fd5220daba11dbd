#!/usr/bin/env bash
# tests/slurm/run.sh PROGRAM [ARGUMENT...]: runs a program, such as the tests of the launcher, beside a Slurm of one
# machine that lasts as long: munged, slurmctld and slurmd with files below a temporary folder and ports that are free.
# No accounts are kept and no control groups are used. Exit code 77 where Slurm is not installed (Debian: slurm-wlm,
# munge) or cannot be started by this user.
set -euo pipefail

if (($# == 0)) || [[ $1 == --help ]]; then
  sed -n '2,5s/^# //p' "$0"
  exit $(($# == 0 ? 2 : 0))
fi
for program in munged slurmctld slurmd sbatch squeue scancel scontrol; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null && continue
  echo "tests/slurm/run.sh: skipped, $program is not installed (Debian: apt-get install slurm-wlm munge)"
  exit 77
done
export PATH=$PATH:/usr/sbin

folder=$(mktemp -d "${TMPDIR:-/tmp}/oraclegs-slurm-XXXXXX")
daemons=()
stop() {
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${daemons[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$folder"
}
trap stop EXIT

skip() {
  echo "tests/slurm/run.sh: skipped, $1; its last lines:"
  tail -n 5 "$2" || true
  exit 77
}

free_ports() {
  python3 - <<'PORTS'
import socket
sockets = [socket.socket() for _ in range(2)]
for one in sockets:
    one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in sockets))
PORTS
}
read -r control_port node_port <<<"$(free_ports)"
user=$(id -un)
host=$(hostname -s)
cores=$(nproc)

chmod 755 "$folder"
mkdir -p "$folder"/{munge,state,spool,log}
chmod 700 "$folder/munge"
head -c 1024 /dev/urandom >"$folder/munge/key"
chmod 600 "$folder/munge/key"
cat >"$folder/slurm.conf" <<CONF
ClusterName=oraclegs_test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$control_port
SlurmdPort=$node_port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/linux
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
MailProg=/bin/true
ReturnToService=2
MinJobAge=${ORACLEGS_TEST_SLURM_AGE:-300}
KillWait=5
MpiDefault=none
SwitchType=switch/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$((cores < 4 ? 4 : cores)) State=UNKNOWN
PartitionName=test Nodes=$host Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
CONF
export SLURM_CONF=$folder/slurm.conf

munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
  --pid-file="$folder/munge/pid" --log-file="$folder/log/munged" --seed-file="$folder/munge/seed" \
  >"$folder/log/munged.out" 2>&1 &
daemons+=($!)
# A loaded machine takes its time.
for ((i = 0; i < 1200; ++i)); do
  [[ -S $folder/munge/socket ]] && break
  kill -0 "${daemons[0]}" 2>/dev/null || break
  sleep 0.1
done
[[ -S $folder/munge/socket ]] || skip "munged does not start" "$folder/log/munged.out"
# Slurm's programs run as others, too
chmod 711 "$folder/munge"

slurmctld -D -f "$SLURM_CONF" >"$folder/log/slurmctld.out" 2>&1 &
daemons+=($!)
slurmd -D -f "$SLURM_CONF" -N "$host" >"$folder/log/slurmd.out" 2>&1 &
daemons+=($!)
for ((i = 0; i < 1200; ++i)); do
  state=$(sinfo --noheader --format=%T 2>/dev/null || true)
  [[ $state == idle ]] && break
  sleep 0.1
done
[[ $state == idle ]] || skip "the machine is '$state' in Slurm after two minutes" "$folder/log/slurmd.out"

code=0
ORACLEGS_TEST_SLURM=${ORACLEGS_TEST_SLURM:-1} "$@" || code=$?
if ((code != 0)); then tail -n 20 "$folder"/log/slurm{ctld,d}; fi
exit "$code"
