#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds and tests a fresh clone of this repository in a bare Debian of another release, as root:
#
#     tests/debian.sh SUITE [TARGET...]
#
# SUITE: bookworm, trixie, ...; TARGET: of make, by default demo and check, with JOBS of them at a time.
# MIRROR: where packages come from, by default where apt gets those of this machine. The folder below TMPDIR is
# removed at the end, and mounts and processes end with the script, because they are in a namespace of its own.
set -eu

suite=${1:?expected a suite, such as trixie}
shift
(($#)) || set -- demo check
source=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Label: Debian' | head -n 1)}
root=$(mktemp -d "${TMPDIR:-/tmp}/debian-$suite.XXXXXX")
command=
trap 'rm -rf --one-file-system "$root" "$root.log"' EXIT
# bash handles signals while it waits, and --kill-child ends the processes in the namespace
trap '[ -z "$command" ] || kill "$command"; wait; exit 130' INT TERM HUP

apart() {
    unshare --mount --pid --fork --kill-child "$@" &
    command=$!
    wait "$command"
}

apart debootstrap --variant=minbase --include=make,gcc "$suite" "$root" "${mirror:-http://deb.debian.org/debian}" \
    >"$root.log" 2>&1 || { cat "$root.log" >&2; exit 1; }
git clone --quiet --no-local "$source" "$root/ehdrom"
# shellcheck disable=SC2016
apart bash -euc '
    root=$1 jobs=$2
    shift 2
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    for target; do
        chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
            make -C /ehdrom "$target" JOBS="$jobs" </dev/null
    done' - "$root" "${JOBS:-2}" "$@"
