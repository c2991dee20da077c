#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Gives make the information that it needs about a plan, but none of the names in the plan (training.mk):
#     plan.sh PLAN STAMP
# Prints `region` and `histories` if the plan, or the plan of which it is a part, has these keys. Sets the time of STAMP
# to that of the newest file that the training reads: these plans, their scenes, and the tables in the current folder.
set -u

plan=$1 stamp=$2

# texts KEY FILE: prints the values of a key in a plan. They are file names, with or without the quotes of YAML. A NUL
# ends each of them.
texts() {
    local key=$1 line pattern
    pattern="^[^#]*$key:[[:space:]]*(\"(([^\"\\]|\\\\.)*)\"|'(([^']|'')*)'|([^][,{}\"'[:space:]#]([^],{}#]|[^[:space:]]#)*))"
    while IFS= read -r line || [[ -n $line ]]; do
        [[ $line =~ $pattern ]] || continue
        case ${BASH_REMATCH[1]} in
            \"*) printf '%b\0' "${BASH_REMATCH[2]//\\\"/\\x22}" ;;
            \'*) printf '%s\0' "${BASH_REMATCH[4]//\'\'/\'}" ;;
            *) printf '%s\0' "${BASH_REMATCH[6]%"${BASH_REMATCH[6]##*[![:space:]]}"}" ;;
        esac
    done <"$2"
}

# beside FILE NAME: sets `path` to the path of NAME, which is relative to the folder of FILE.
beside() {
    path=$2
    [[ $1 != */* || $2 == /* ]] || path=${1%/*}/$2
}

if [[ ! -f $plan ]]; then
    rm -f -- "$stamp"
    exit
fi
plans=("$plan")
while IFS= read -r -d '' name; do
    beside "$plan" "$name"
    [[ ! -f $path ]] || plans+=("$path")
done < <(texts part_of "$plan")

read_by_training=("${plans[@]}")
for plan in "${plans[@]}"; do
    while IFS= read -r -d '' name; do
        beside "$plan" "$name"
        read_by_training+=("$path")
    done < <(texts scene "$plan")
done
for table in *.csv; do
    [[ $table == cases.csv ]] || read_by_training+=("./$table")
done

newest=
for file in "${read_by_training[@]}"; do
    [[ ! -f $file || ( -n $newest && ! $file -nt $newest ) ]] || newest=$file
done
touch -r "$newest" -- "$stamp"

for word in region histories; do
    ! grep -qE "^[^#]*$word:" -- "${plans[@]}" || echo "$word"
done
