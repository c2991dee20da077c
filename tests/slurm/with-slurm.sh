#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a command with a Slurm of its own: one node with two processors on the loopback device, munge with a key and a
# socket of its own, everything in a temporary folder, no service of the system. All of its processes end with the
# command, also where it fails or is interrupted.
#
#     tests/slurm/with-slurm.sh COMMAND...
set -u
PATH=$PATH:/usr/sbin:/sbin

folder=$(mktemp -d) || exit
export SLURM_CONF=$folder/slurm.conf
daemons=()

# ours: prints the processes that have this configuration in their environment, jobs and what started them
ours() {
    local process
    for process in /proc/[0-9]*; do
        ((${process#/proc/} == $$)) && continue
        tr '\0' '\n' 2>/dev/null <"$process/environ" | grep -qxF "SLURM_CONF=$SLURM_CONF" && echo "${process#/proc/}"
    done
}

end() {
    local left
    trap '' INT TERM HUP
    # hides the shell's messages that they were killed
    exec 2>/dev/null
    ((${#daemons[@]} == 0)) || kill -KILL "${daemons[@]}"
    wait "${daemons[@]}"
    # the subshell that runs `ours` is among these processes, and gone when it is killed
    for left in $(ours); do kill -KILL "$left"; done
    rm -rf "$folder"
}
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

# start NAME COMMAND...: starts a daemon in the background, which lives no longer than this script.
start() {
    local name=$1
    shift
    setpriv --pdeathsig KILL "$@" >"$folder/$name.out" 2>&1 </dev/null &
    daemons+=($!)
}

# ready COMMAND...: waits until the command succeeds, at most half a minute.
ready() {
    local try
    for ((try = 0; try < 300; try++)); do
        "$@" >/dev/null 2>&1 && return
        sleep 0.1
    done
    echo "with-slurm.sh: found no answer of $1, expected one within 30 s" >&2
    tail -n 20 "$folder"/*.out "$folder"/*.log >&2
    exit 1
}

chmod 755 "$folder" # munge requires this mode
mkdir "$folder/state" "$folder/spool" || exit
(umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key") || exit
read -r controller_port node_port < <(python3 - <<'PYTHON'
import socket
free = [socket.socket() for _ in range(2)]
for s in free: s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in free))
PYTHON
) || exit

# A requeued task waits for the end of its credential, two minutes by default.
host=$(hostname -s)
cat >"$SLURM_CONF" <<CONF || exit
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
SlurmctldPort=$controller_port
SlurmdPort=$node_port
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=2
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
SchedulerType=sched/builtin
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=0
ReturnToService=2
KillWait=2
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=test Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF

start munged munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munge.pid" --log-file="$folder/munge.log" --seed-file="$folder/munge.seed"
ready test -S "$folder/munge.socket"
start slurmctld slurmctld -D -i
start slurmd slurmd -D
ready sh -c 'sinfo -h -o %T | grep -qx idle'

# in the background, so that a signal is handled before the command ends
"$@" &
wait $!
