#!/usr/bin/env bash
# Start a Slurm of one node on this machine, for the checks that need one, from Debian's slurm-wlm and munge.
#
# usage: slurm_of_one_node.sh FOLDER start|stop      as root
#
# FOLDER gets the configuration, state and logs; SLURM_CONF=FOLDER/slurm.conf makes sbatch and the like use it. Where the
# machine has no configuration of its own a link to it is made, for Snakemake starts jobs without that variable.
set -euo pipefail
folder=$(realpath -m "$1")
conf=$folder/slurm.conf

if [ "${2:-}" = stop ]; then
    # One after another, each to its end: they write their state into the folder when they stop.
    for daemon in slurmd slurmctld munged; do
        [ -f "$folder/$daemon.pid" ] || continue
        pid=$(cat "$folder/$daemon.pid")
        kill "$pid" 2>/dev/null || true
        for _ in $(seq 150); do
            kill -0 "$pid" 2>/dev/null || break
            sleep 0.2
        done
    done
    [ "$(readlink /etc/slurm/slurm.conf)" = "$conf" ] && rm /etc/slurm/slurm.conf
    exit 0
fi

mkdir -p "$folder"/{state,spool,munge}
chown -R munge:munge "$folder/munge"
chmod 755 "$folder" "$folder/munge"
if [ ! -S "$folder/munge/socket" ]; then
    dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
    chown munge:munge "$folder/munge/key"
    chmod 400 "$folder/munge/key"
    runuser -u munge -- munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
        --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
    cp "$folder/munge/pid" "$folder/munged.pid"
fi
host=$(hostname -s)
cat >"$conf" <<CONF
ClusterName=knotdock
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_min_interval=100000,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MinJobAge=300
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=3000 State=UNKNOWN
PartitionName=batch Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
mkdir -p /etc/slurm
[ -e /etc/slurm/slurm.conf ] || ln -sf "$conf" /etc/slurm/slurm.conf
export SLURM_CONF=$conf
slurmctld -c -f "$conf"
slurmd -f "$conf"
for _ in $(seq 100); do
    [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ] && exit 0
    sleep 0.2
done
sinfo || true
tail -n 20 "$folder"/*.log >&2
exit 1
