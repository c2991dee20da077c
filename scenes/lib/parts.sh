#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Trains a region. If it is too wide for one model, the script trains it in parts (training.mk):
#     parts.sh MAKE MAKEFILE PLAN OUT SNAPGEN PARTS ONE_GRID INPUTS [--set KEY=VALUE]...
# PARTS is the number of parts; if it is empty, the training finds the number (snapgen --parts). The script writes
#     OUT/parts.mk            names of the parts; none if there is one model
#     OUT/parts-grid.txt      settings of the grid, if all parts have the same grid
#     OUT/parts.txt           list of the parts with their ranges of M
#     OUT/NAME.yml, OUT/NAME  plan and folder of a part
# After an interruption it continues with the parts that are not trained, unless one of the INPUTS has changed. INPUTS
# is a list of files whose names have no blanks.
set -euo pipefail

make=$1 makefile=$2 plan=$3 out=$4 snapgen=$5 wanted=$6 one_grid=$7 inputs=$8
shift 8
settings=("$@")
list=$out/parts.txt
found=$out/two-parts.txt
# largest number of models in a list, from the error message of snapgen
most=$({ "$snapgen" --num-parts 0 2>&1 || true; } | sed -n 's/.* to \([0-9]*\) .*/\1/p')
if [[ ! $wanted =~ ^([1-9][0-9]?)?$ ]] || ((${wanted:-1} > most)); then
    echo "SPLIT: found $wanted, expected a whole number from 1 to $most, or nothing" >&2
    exit 64
fi

# train NAME: trains a part, or the whole region if NAME is empty. If snapgen finds that NAME needs several models, the
# smaller parts that it writes replace NAME in the list.
train() {
    local folder=$out${1:+/$1} part=() silent=() more=
    [[ -n $1 ]] && part=(PLAN="$out/$1.yml" PART="$1" PARTS_OF="${names[*]}")
    [[ -z $wanted ]] && ((${#names[@]} < most)) && more=$found
    rm -f "$found"
    [[ ${V:-0} == 0 ]] && silent=(-s)
    "$make" "${silent[@]}" -f "$makefile" PLAN="$plan" SPLIT=1 PARTS_LIST="$more" "${part[@]}" OUT="$folder" "$folder/snapshots.h5"
    if [[ -e $found ]]; then
        divide "$1"
        rm -f "$folder"/snapshots.h5.{partial,saved}
    fi
}

# divide NAME: replaces the part NAME in the list by the parts that snapgen has written.
divide() {
    local kind grid
    sed -n '/^[^#]/ s/\.yml / /p' "$found" >"$found.named"
    if [[ -n $1 ]]; then
        sed -e "/^${1//./\\.} /{" -e "r $found.named" -e 'd' -e '}' "$list" >"$list.new"
    else
        # only line contacts may have different grids
        read -r _ kind grid <"$found"
        [[ $kind == line && -z $one_grid ]] && grid=
        echo "$grid" >"$out/parts-grid.txt"
        cp "$found.named" "$list.new"
    fi
    mv "$list.new" "$list"
    rm "$found" "$found.named"
    read_names
}

# Reads the names of the parts. Each name is a range of numbers, so that make and the shell can use it safely.
read_names() {
    mapfile -t names < <(cut -d ' ' -f 1 "$list")
    [[ ! ${names[*]} =~ [^-+.0-9eM\ ] ]] || { echo "parts.sh: $list: found other names than of ranges of M" >&2; exit 65; }
}

names=()
for input in $inputs; do [[ ! $input -nt $list ]] || rm -f "$list"; done
if [[ -s $list ]]; then
    read_names
elif [[ -n $wanted ]]; then
    "$snapgen" "${settings[@]}" "$plan" --num-parts "$wanted" -o "$found" --force
    divide ''
else
    train ''
fi

k=0
while ((k < ${#names[@]})); do
    name=${names[k]}
    train "$name"
    [[ ${names[k]} != "$name" ]] || ((++k)) # otherwise smaller parts have replaced it
done
if ((${#names[@]})); then
    echo "  parts      ${#names[@]} of the region, along M: $(awk '{ printf "%s%s to %s", s, $2, $3; s = ", " }' "$list")"
fi
echo "REGION_PARTS := ${names[*]}" >"$out/parts.mk"
