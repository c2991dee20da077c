# SPDX-License-Identifier: GPL-3.0-or-later
# The scenes that a model was calibrated on, of one regime, as files FOLDER/scene-001.yml, …, without keys that
# alternatives choose themselves:
#     romrun --print CALIBRATED.h5 settings | awk -f scenes.awk -v folder=FOLDER -v regime=stationary -v kept=N [-v without=KEY]
# The settings name those of the first scene, then what changes from one to the next (schemas/plan.md).
function write_scene(   name, i) {
    if (!started || value["regime"] != regime) return
    name = sprintf("%s/scene-%03d.yml", folder, ++count)
    for (i = 1; i <= num_keys; i++)
        if (value[keys[i]] != "" && keys[i] != without) print keys[i] ": " value[keys[i]] > name
    close(name)
}

{ sub(/^"/, "") } # a text of several lines is quoted
/^# calibrated on/ { calibrated = 1; next }
!calibrated { next }
/^# point/ { write_scene(); started = 1; next }
/^#/ { next }

started && /^[a-z_]+[.:]/ {
    key = $0
    sub(/:.*/, "", key)
    sub(/^[^:]*: */, "")
    if (!(key in value)) keys[++num_keys] = key
    value[key] = $0
}

END {
    write_scene()
    if (count != kept || !count) {
        print "check-plan.yml: found " count + 0 " " regime " scenes, expected the " kept " that the calibration kept," \
            " inside of the trained range (TRADE_REGIME)" > "/dev/stderr"
        exit 1
    }
}
