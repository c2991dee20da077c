#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures what each term of a scene costs (a term is a law or an effect, such as a density law, sliding or the change
# in time). The costs are instructions (callgrind) and heap (massif), which do not depend on other programs. Fails if a
# scene runs functions of a term that the scene does not have. `make costs` calls this script with BIN set.
set -eu
: "${BIN:?folder of the programs}" "${BENCH:?folder of the benchmark programs}"
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OPENBLAS_NUM_THREADS=1
failed=0
cd "$work"

section() { printf '\n== %s\n' "$*"; }

# ---- scenes

# scene NAME: writes NAME.yml; the words of the name are the differences from `base`
scene() {
    local viscosity='law: barus, alpha: 22e-9' density=incompressible regime=stationary closure=load
    case $1 in *roelands*) viscosity='law: roelands, eta0: 0.04, alpha: 22e-9' ;; *wlf*) viscosity='law: wlf, preset: no1' ;; esac
    case $1 in *compressible*) density=dowson-higginson ;; esac
    case $1 in *approach*) closure=approach ;; esac
    case $1 in *time*) regime=transient ;; esac
    cat >"$1.yml" <<YML
contact: line
regime: $regime
closure: $closure
moes: {M: 120, L: 10}
lubricant: {viscosity: {$viscosity}, density: {law: $density}}
YML
    case $1 in
    # transport along the path would need more modes than so few steps give
    *time*) echo 'transport: upwind
transient: {speed: {law: sine, amplitude: 0.1, period: 1}, end_time: 0.05, fixed_step: 0.005}' >>"$1.yml" ;;
    esac
}
stationary='base compressible roelands wlf'
in_time='time time-compressible time-approach'
for name in $stationary $in_time; do scene "$name"; done

# the contact of `base` in SI units, which sliding needs, and a ball; the options below add other terms
cat >si.yml <<'YML'
contact: line
regime: stationary
physical: {load: 1.1266e6, radius: 0.01, speed: 0.501, modulus: 220e9, viscosity: 0.04}
lubricant: {viscosity: {law: barus, alpha: 22e-9}}
YML
cat >ball.yml <<'YML'
contact: point
regime: stationary
physical: {load: 40, radius: 0.0127, speed: 0.8, modulus: 230e9, viscosity: 0.05}
lubricant: {viscosity: {law: barus, alpha: 18e-9}}
grid: {x_min: -3, x_max: 1.5, step: 0.125, y_max: 2}
YML
slides='--set slide_roll=0.1 --set lubricant.shear.law=eyring --set lubricant.shear.tau0=5e6'
thinned="$slides --set lubricant.shear.in_film=true"
heated='--set lubricant.thermal_conductivity=0.14 --set lubricant.viscosity.temperature_coefficient=0.03'
elliptical='--set contact=ellipse --set ellipticity=2'
dented='--set surface.kind=dent --set surface.depth=0.01 --set surface.radius=0.2'
# patterns of the functions of each term and of the far field of points; inlet heating has no function of its own
of_sliding='contact_(shear_stress|traction_of|surface_stresses)|eyring|nodes_traction'
of_thinning='thinned_link|thin|eyring_gradient_of|eyring_along|eyring_across'
of_ellipses='shape_of|integral_(along|across)|ellipse_[a-z_]*'
of_surfaces='surface_(heights?|position)|dent_height'
of_points='far_angle_[a-z]*'

# ---- measurements

# calls NAME TOGGLE COMMAND...: writes NAME.calls with the functions that run inside the function TOGGLE (-: in the
# whole program)
calls() {
    local name=$1 toggle=$2 status=0
    shift 2
    [ "$toggle" = - ] && toggle= || toggle=--toggle-collect=$toggle
    # shellcheck disable=SC2086
    valgrind --tool=callgrind --callgrind-out-file="$name.callgrind" $toggle "$@" >"$name.log" 2>&1 || status=$?
    # an untrusted result (exit code 4) is accepted too
    [ $status -eq 0 ] || [ $status -eq 4 ] || { cat "$name.log" >&2; exit 1; }
    awk -f "$here/calls.awk" "$name.callgrind" >"$name.calls"
    rm "$name.callgrind"
}

# heap COMMAND...: prints the peak of its heap in kilobytes
heap() {
    valgrind --tool=massif --massif-out-file=massif "$@" >massif.log 2>&1 || [ $? -eq 4 ] || { cat massif.log >&2; exit 1; }
    awk -F= '/^mem_heap_B/ && $2 > most { most = $2 } END { printf "%.0f\n", most / 1000 }' massif
}

# table PER UNIT NAME...: prints thousands of instructions in NAME.calls per call of the function PER; UNIT is the
# heading of the number of calls
table() {
    local per=$1 unit=$2
    shift 2
    printf '%-18s %10s %6s %9s %9s %9s %9s %9s %9s %9s %9s %8s\n' scene "$unit" rows all solver rows previous rest fluid viscosity density heap/kB
    for name; do
        awk -v name="$name" -v per="$per" -v heap="$(cat "$name.heap")" '
            { calls[$1] = $2; cost[$1] = $3 }
            $1 ~ /^(barus|roelands|wlf)$/ { viscosity += $3 }
            $1 ~ /^previous_(prepare|mass|film_prepare|film_masses)$/ { previous += $3 }
            $1 ~ /^(full_solve_gmres|least_squares_(solve|factorise|again))$/ { solver += $3 }
            function share(x) { return sprintf(" %9.1f", x / calls[per] / 1000) }
            END {
                fluid = cost["reynolds_fluid_evaluate"]
                rows = cost["reynolds_rows"]
                printf "%-18s %10d %6d", name, calls[per], calls["reynolds_rows"]
                print share(cost["total"]) share(solver) share(rows) share(previous) share(cost["total"] - solver - rows - previous - fluid) \
                    share(fluid) share(viscosity) share(cost["dowson_higginson"]) sprintf(" %8d", heap)
            }' "$name.calls"
    done
}

# none NAME PATTERN: fails if a function in NAME.calls matches PATTERN
none() {
    local found
    found=$(awk -v pattern="$2" '$1 ~ pattern { printf " %s", $1 }' "$1.calls")
    if [ -n "$found" ]; then
        printf '%-18s calls%s\n' "$1" "$found"
        failed=1
    else
        printf '%-18s none of %s\n' "$1" "$2"
    fi
}

# some NAME PATTERN: fails if no function in NAME.calls matches PATTERN
some() {
    awk -v pattern="$2" '$1 ~ pattern { found = 1 } END { exit !found }' "$1.calls" && return
    printf '%-18s calls none of %s\n' "$1" "$2"
    failed=1
}

# check_terms KIND: checks for whole runs (KIND-NAME.calls) that no function belongs to a term that the scene does not
# have
check_terms() {
    local kind=$1
    none "$kind-base" '^(dowson_higginson|roelands|wlf)(_|$)'
    none "$kind-wlf" '^(dowson_higginson|roelands|barus)(_|$)'
    # these checks fail if a function in the patterns was renamed in the sources
    some "$kind-base" '^barus$'
    some "$kind-wlf" '^wlf$'
    some "$kind-time" '^(histories_at|previous_(mass|film_masses))$'
    none "$kind-base" '^(histories_(at|next)|frame_|march_|bdf_|previous_|film_splines_build|time_run|gsl_spline|full_march|reduced_march)'
    none "$kind-time" '^dowson_higginson'
    none "$kind-base" "^($of_sliding|$of_thinning|$of_ellipses|$of_surfaces|$of_points)\$"
    none "$kind-time" "^($of_sliding|$of_thinning|$of_ellipses|$of_surfaces|$of_points)\$"
}

# more TEXT WITH WITHOUT: prints by how much the whole run WITH costs more than the whole run WITHOUT
more() { awk -v what="$1" '$1 == "total" { cost[FILENAME] = $3 } END { printf "%-34s %+9.0f of %.0f\n", what, (cost[ARGV[1]] - cost[ARGV[2]]) / 1000, cost[ARGV[2]] / 1000 }' "$2.calls" "$3.calls"; }

# ---- the full model

section "full model, on the grid of M and L: thousand instructions in a Newton iteration, from the solution at M = 115"
for name in $stationary; do
    "$BIN/fullrun" -q "$name.yml" --set moes.M=115 -f -o start.h5 >log
    calls "$name" full_solve_from "$BIN/fullrun" -q "$name.yml" --start start.h5 -f -o "$name.h5"
    heap "$BIN/fullrun" -q "$name.yml" --start start.h5 -f -o "$name.h5" >"$name.heap"
done
for name in $in_time; do
    calls "$name" march_run "$BIN/fullrun" -q "$name.yml" --set output.fields=false -f -o "$name.h5"
    heap "$BIN/fullrun" -q "$name.yml" --set output.fields=false -f -o "$name.h5" >"$name.heap"
done
echo "rows: calls, and their share; rest: deflection, exit, damping; viscosity and density are parts of fluid"
# shellcheck disable=SC2086
table full_solve_gmres iterations $stationary $in_time

section "full model, whole program from a cold start: thousand instructions"
calls full-short - "$BIN/fullrun" -q base.yml --set output.fields=false --set output.resolution=false -f -o base.h5
for name in base wlf time; do
    calls "full-$name" - "$BIN/fullrun" -q "$name.yml" --set output.fields=false -f -o "$name.h5"
done
calls full-fields - "$BIN/fullrun" -q base.yml -f -o fields.h5
awk 'FNR == 1 { total[FILENAME] = $3 }
     FILENAME == "full-base.calls" { if ($1 == "full_solve_cold") solve = $3; if ($1 == "full_resolution_estimate") estimate = $3 }
     END { printf "program %.0f, of it solution %.0f, estimates of the resolution %.0f (without them %+.0f); fields %+.0f\n",
           total["full-base.calls"] / 1000, solve / 1000, estimate / 1000, (total["full-short.calls"] - total["full-base.calls"]) / 1000, (total["full-fields.calls"] - total["full-base.calls"]) / 1000 }' full-base.calls full-fields.calls full-short.calls
check_terms full

section "sliding and heating, by the full model: thousand instructions more of whole programs"
full() {
    local name=$1 unwanted='--set output.resolution=false'
    shift
    [ "$1" = time.yml ] && unwanted= # a transient scene has no estimate of the resolution
    # shellcheck disable=SC2086
    calls "full-$name" - "$BIN/fullrun" -q "$@" --set output.fields=false $unwanted -f -o "$name.h5"
}
# shellcheck disable=SC2086
{
    full si si.yml
    full slides si.yml $slides
    full thinned si.yml $thinned
    full heated si.yml $heated
    full ball ball.yml
    full ball-slides ball.yml $slides
    full ellipse ball.yml $elliptical
    full dented time.yml $dented
}
more 'line that slides' full-slides full-si
more 'line whose flow is thinned' full-thinned full-si
more 'line with inlet heating' full-heated full-si
more 'ball that slides' full-ball-slides full-ball
more 'ellipse in place of the ball' full-ellipse full-ball
more 'dent in time' full-dented full-time
others="$of_thinning|$of_ellipses|$of_surfaces"
none full-si "^($of_sliding|$others|$of_points)\$"
none full-slides "^($others|$of_points)\$"
none full-heated "^($of_sliding|$others|$of_points)\$"
none full-ball "^($of_sliding|$others)\$"
none full-ellipse "^($of_sliding|$of_thinning|$of_surfaces)\$"
none full-dented "^($of_sliding|$of_thinning|$of_ellipses|$of_points)\$"
some full-slides '^contact_traction_of$'
some full-thinned '^(thinned_link|thin)$'
some full-ball '^far_angle_rise$'
some full-ellipse '^shape_of$'
some full-dented '^surface_heights$'

# ---- the reduced model

cat >plan.yml <<'YML'
groups:
  - scene: base.yml
    vary: {moes.M: [90, 100, 110, 125, 140, 155], moes.L: [8, 9, 10, 11, 12]}
  - scene: time.yml
    vary: {transient.speed.period: [0.5, 1]}
  - scene: time-compressible.yml
    vary: {transient.speed.period: [0.5, 1]}
YML
"$BIN/snapgen" -q plan.yml -f -o snapshots.h5
"$BIN/podbuild" -q snapshots.h5 -f -o basis.h5 --pressure-modes 40 >log
"$BIN/snapgen" -q plan.yml --basis basis.h5 -f -o residuals.h5 >log
"$BIN/deimselect" -q --no-check residuals.h5 --basis basis.h5 -f -o model.h5 --rows 70 >log
"$BIN/deimselect" -q --no-check residuals.h5 --basis basis.h5 -f -o without-control.h5 --rows 70 --control 0 >log

section "reduced model, 40 modes and 70 rows: thousand instructions in an iteration"
for name in $stationary; do
    calls "$name" reduced_solve "$BIN/romrun" -q --allow-untrusted "$name.yml" --model model.h5
    heap "$BIN/romrun" -q --allow-untrusted "$name.yml" --model model.h5 >"$name.heap"
done
# shellcheck disable=SC2086
table least_squares_solve iterations $stationary
for name in $in_time; do
    calls "$name" march_run "$BIN/romrun" -q --allow-untrusted "$name.yml" --model model.h5
    heap "$BIN/romrun" -q --allow-untrusted "$name.yml" --model model.h5 >"$name.heap"
done
echo 'in time, for a call of the rows, of which the exit has its own:'
# shellcheck disable=SC2086
table reynolds_rows "rows called" $in_time

section "reduced model, whole program: thousand instructions"
for name in base wlf time; do
    calls "reduced-$name" - "$BIN/romrun" -q --allow-untrusted "$name.yml" --model model.h5
done
calls reduced-fields - "$BIN/romrun" -q --allow-untrusted base.yml --model model.h5 --set output.fields=true -f -o fields.h5
calls reduced-file - "$BIN/romrun" -q --allow-untrusted base.yml --model model.h5 -f -o fields.h5
calls reduced-without-control - "$BIN/romrun" -q --allow-untrusted base.yml --model without-control.h5
awk 'FNR == 1 { total[FILENAME] = $3 }
     { cost[FILENAME, $1] = $3 }
     END { base = "reduced-base.calls"; without = "reduced-without-control.calls"
           printf "program %.0f, of it opening the model %.0f, solution %.0f, indicator %.0f (without control rows %.0f)\n",
               total[base] / 1000, cost[base, "online_open"] / 1000, cost[base, "reduced_solve"] / 1000,
               cost[base, "indicator_bound"] / 1000, cost[without, "indicator_bound"] / 1000
           printf "a result file takes %+.0f, fields in it %+.0f\n", (total["reduced-file.calls"] - total[base]) / 1000,
               (total["reduced-fields.calls"] - total["reduced-file.calls"]) / 1000 }' reduced-*.calls
printf 'heap: %d kB, with fields %d kB, without control rows %d kB\n' "$(heap "$BIN/romrun" -q --allow-untrusted base.yml --model model.h5)" \
    "$(heap "$BIN/romrun" -q --allow-untrusted base.yml --model model.h5 --set output.fields=true -f -o fields.h5)" \
    "$(heap "$BIN/romrun" -q --allow-untrusted base.yml --model without-control.h5)"
section "friction by the reduced model (goal: at most 10 % of a solution): thousand instructions"
# shellcheck disable=SC2086
for name in si slides; do
    [ $name = slides ] && options=$slides || options=
    calls "reduced-$name" - "$BIN/romrun" -q --allow-untrusted si.yml --model model.h5 $options
done
awk '{ cost[FILENAME, $1] = $3 }
     END { still = cost["reduced-si.calls", "online_solve"]; with = "reduced-slides.calls"
           printf "solution %.0f, of a scene that slides %.0f, its friction %.0f: %.2f %%\n", still / 1000,
               cost[with, "online_solve"] / 1000, cost[with, "online_traction"] / 1000, 100 * cost[with, "online_traction"] / still
           exit !(cost[with, "online_traction"] > 0 && cost[with, "online_solve"] + cost[with, "online_traction"] <= 1.1 * still) }' \
    reduced-si.calls reduced-slides.calls || failed=1
none reduced-si "^($of_sliding|$others|$of_points)\$"
some reduced-slides '^nodes_traction$'

# ---- the library and FMUs

section "a step through the library against one inside of romrun (goal: at most 3 % more): thousand instructions"
cat >step.yml <<'YML'
contact: line
regime: transient
discretization: published
moes: {M: 20, L: 5}
grid: {step: 0.02}
lubricant: {viscosity: {law: barus, alpha: 22e-9}}
transient: {load: {law: sine, amplitude: 0.1, period: 1}, end_time: 1, fixed_step: 0.005}
YML
"$BIN/snapgen" -q step.yml -o step-s.h5
"$BIN/podbuild" -q step-s.h5 -o step-b.h5 --pressure-modes 40 >log
"$BIN/snapgen" -q step.yml --basis step-b.h5 -o step-r.h5 >log
"$BIN/deimselect" -q --no-check step-r.h5 --basis step-b.h5 -o step-m.h5 --rows 64 --method exits >log
calls inside march_run "$BIN/romrun" -q --allow-untrusted step.yml --model step-m.h5
calls through - "$BENCH/bench_many" step-m.h5 step.yml 200 1
# leaves out the writing of results
awk '{ cost[FILENAME, $1] = $3; calls[FILENAME, $1] = $2 }
     END { inside = "inside.calls"; through = "through.calls"; steps = calls[inside, "store"]
           romrun = (cost[inside, "march_run"] - cost[inside, "store"]) / steps
           library = (cost[through, "ehdrom_step"] + cost[through, "ehdrom_accept"]) / calls[through, "ehdrom_step"]
           printf "romrun %.1f a step (%d steps), the library %.1f (%d): %+.2f %%\n", romrun / 1000, steps, library / 1000,
               calls[through, "ehdrom_step"], 100 * (library / romrun - 1)
           exit !(library <= 1.03 * romrun) }' inside.calls through.calls || failed=1

if [ -n "${USE_FMU:-}" ]; then
    section "a step of an FMU against one of the library in it: instructions"
    cat >contact.yml <<'YML'
contact: line
regime: stationary
physical: {load: 300e3, radius: 0.0125, speed: 0.8, modulus: 226e9, viscosity: 0.08}
lubricant: {viscosity: {law: roelands, eta0: 0.08, alpha: 2.0e-8}, density: {law: dowson-higginson}}
grid: {x_min: -4, x_max: 2, step: 0.05}
YML
    printf 'groups:\n- {scene: contact.yml, vary: {physical.load: [240e3, 300e3, 360e3], physical.speed: [0.5, 0.8, 1.1]}}\n' >contacts.yml
    "$BIN/snapgen" -q contacts.yml -o fmu-s.h5
    "$BIN/podbuild" -q fmu-s.h5 -o fmu-b.h5 --pressure-modes 9 >log
    "$BIN/snapgen" -q contacts.yml --basis fmu-b.h5 -o fmu-r.h5 >log
    "$BIN/deimselect" -q --no-check fmu-r.h5 --basis fmu-b.h5 -o fmu-m.h5 >log
    "$BIN/romrun" -q --fmu contact.yml --model fmu-m.h5 -o contact.fmu
    mkdir fmu && python3 -m zipfile -e contact.fmu fmu
    calls by-fmu - "$USE_FMU" 3 fmu run 40
    calls by-library - "$USE_FMU" library fmu 40
    # counts the code for this processor (romrun/fmu/processor.c); 5000 instructions take less than 5 us at one
    # instruction in a nanosecond
    awk '$1 == "fmi3DoStep" { steps = $2; fmu = $3 }
         $1 ~ /^ehdrom_(step|accept)_(v3|any)$/ { library += $3 }
         END { if (!steps || !library) exit 1
               more = (fmu - library) / steps
               printf "fmi3DoStep %.0f, of which ehdrom_step and ehdrom_accept %.0f: %.0f more (goal: at most 5000, which is below 5 us at 1 GHz and one a cycle)\n",
                   fmu / steps, library / steps, more
               exit !(more <= 5000) }' by-fmu.calls by-library.calls || failed=1
fi

check_terms reduced
none full-short '^full_resolution'
none reduced-base '^(reduced_fields|model_read_modes|online_fields|result_write)'
none reduced-time '^(reduced_fields|online_fields|indicator_)'
none reduced-without-control '^reduced_model_complete_control'
exit $failed
