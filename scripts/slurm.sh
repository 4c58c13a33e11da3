#!/usr/bin/env bash
# Starts a small Slurm cluster on this machine, for tests: munge, slurmctld and two slurmd of one core
# each, n1 and n2, in a folder of their own. Installs Debian's packages where they are missing.
#
#     export SLURM_CONF=$(scripts/slurm.sh start FOLDER)
#     sbatch --array=1-10 job.sh
#     scripts/slurm.sh node FOLDER n2     starts a node again, after its slurmd has ended
#     scripts/slurm.sh stop FOLDER        ends what was started, and only that
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
command=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
export SLURM_CONF=$folder/slurm.conf
socket=$folder/run/munge.socket

install_packages() {
    local missing=() tool
    for tool in munged slurmctld slurmd sbatch; do
        command -v "$tool" >/dev/null || missing+=("$tool")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    echo "slurm: no ${missing[*]}: installing slurm-wlm and munge with apt-get" >&2
    { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm munge; } >&2
}

configure() {
    local host port user
    host=$(hostname -s) user=$(id -un) port=$((20000 + RANDOM % 10000))
    cat >"$SLURM_CONF" <<CONF
ClusterName=skiagraph
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
CredType=cred/munge
# A task of a lost node waits so many seconds before it begins again.
AuthInfo=socket=$socket,cred_expire=5
MailProg=/bin/true
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=5,bf_interval=5
JobRequeue=1
ReturnToService=2
SlurmdTimeout=10
SlurmctldTimeout=10
KillWait=5
StateSaveLocation=$folder/ctl
SlurmctldPidFile=$folder/ctl/pid
SlurmctldLogFile=$folder/ctl/log
SlurmdSpoolDir=$folder/%n
SlurmdPidFile=$folder/%n/pid
SlurmdLogFile=$folder/%n/log
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=512
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=512
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
}

failed() {
    printf 'slurm: %s; the ends of the logs:\n' "$1" >&2
    tail -n 20 "$folder"/munge/log "$folder"/ctl/log "$folder"/n?/log >&2 || true
    exit 1
}

# Waits for a command to succeed, at most half a minute.
wait_for() {
    for _ in $(seq 300); do
        "$@" >/dev/null 2>&1 && return 0
        sleep 0.1
    done
    return 1
}

all_idle() { [ "$(sinfo -h -t idle -o %D)" = 2 ]; }

case $command in
    start)
        install_packages
        mkdir -p "$folder"/{munge,run,ctl,n1,n2}
        chmod 700 "$folder/munge"
        chmod 755 "$folder" "$folder/run"
        (umask 077 && head -c 1024 /dev/urandom >"$folder/munge/key")
        configure
        # --force: a folder above may be writable by others.
        munged --force --key-file="$folder/munge/key" --socket="$socket" --pid-file="$folder/munge/pid" \
            --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" >&2
        wait_for test -S "$socket" || failed "munged does not start"
        slurmctld >&2
        wait_for scontrol ping || failed "slurmctld does not start"
        slurmd -N n1 >&2
        slurmd -N n2 >&2
        wait_for all_idle || failed "the nodes are not idle: $(sinfo -h -N -o '%N %T' | tr '\n' ' ')"
        echo "$SLURM_CONF"
        ;;
    node) slurmd -N "$3" >&2 ;;
    stop)
        for part in n1 n2 ctl munge; do
            if [ -s "$folder/$part/pid" ]; then kill "$(cat "$folder/$part/pid")" 2>/dev/null || true; fi
        done
        ;;
    *) echo "slurm: no command $command; there are start, node and stop" >&2 && exit 2 ;;
esac
