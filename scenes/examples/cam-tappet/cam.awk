# SPDX-License-Identifier: GPL-3.0-or-later
# Load, speed, radius and modulus of the contact between a cam and a flat-faced tappet during one lift, as
# factors on a scene's `physical` reference and over its time T = u_ref t / a_ref:
#     awk -f cam.awk scene.yml > history.csv
# Columns: T, load, speed, radius, modulus (factors), angle (of the cam, degrees from the nose), lift (mm).
#
# Lift: the 3-4-5-6 polynomial of a cam with a single dwell (R. L. Norton, Cam Design and Manufacturing
# Handbook, Industrial Press), s = 64 h (x (1 - x))^3 with x = theta/beta from 0 to 1 over rise and fall;
# velocity and acceleration start and end at zero.
# Contact, with derivatives by the angle: the radius of the cam's curvature is rho = r_b + s + s'', the
# contact lies s' from the tappet's axis, the surfaces pass it with omega rho (cam) and omega s'' (tappet),
# hence the mean speed u_m = omega (r_b + s + 2 s'')/2.
# At the nose s'' is negative. On a cam of short lift u_m then changes its sign between flank and nose; this
# one is a slow and flat one, so that u_m stays above zero, at 0.4 of what it is on the base circle.
# Load: spring and inertia, w = (F_0 + k s + m omega^2 s'')/b.
# Modulus: that of steel on steel at the tappet's axis; further out it falls with the square of the
# distance, as if the facing became softer to the rim. This law stands for no particular facing.
BEGIN {
    pi = atan2(0, -1)
    base_radius = 0.018     # m, r_b
    lift = 0.006            # m, h
    duration = 240          # degrees of the cam, beta
    preload = 1200          # N, F_0
    spring = 100e3          # N/m, k
    mass = 0.3              # kg, m, of all that moves with the tappet
    width = 0.012           # m, b
    softening = 0.05        # part of the modulus that is lost at the largest distance from the axis
    num_intervals = 480
}

# The reference: one line, physical: {load: ..., radius: ..., speed: ..., modulus: ..., viscosity: ...}
/^physical:/ {
    gsub("[{},:]", " ")
    for (i = 2; i < NF; i += 2) reference[$i] = $(i + 1)
}

# Lift and its derivatives by the angle, at x = theta/beta.
function polynomial(x, beta) {
    s = 64 * lift * (x * (1 - x)) ^ 3
    ds = 64 * lift * 3 * (x * (1 - x)) ^ 2 * (1 - 2 * x) / beta
    dds = 64 * lift * (6 * x - 36 * x ^ 2 + 60 * x ^ 3 - 30 * x ^ 4) / beta ^ 2
}

END {
    if (!(reference["load"] > 0 && reference["radius"] > 0 && reference["speed"] > 0 && reference["modulus"] > 0)) {
        print FILENAME ": found no `physical: {load: ..., radius: ..., speed: ..., modulus: ...}`, expected one line of it" > "/dev/stderr"
        exit 1
    }
    beta = duration * pi / 180
    omega = 2 * reference["speed"] / base_radius # the reference speed is that of the base circle
    half_width = sqrt(8 * reference["load"] * reference["radius"] / (pi * reference["modulus"]))
    for (i = 0; i <= num_intervals; i++) { # the largest distance from the axis
        polynomial(i / num_intervals, beta)
        if (ds > largest) largest = ds
    }
    print "T,load,speed,radius,modulus,angle,lift"
    for (i = 0; i <= num_intervals; i++) {
        x = i / num_intervals
        polynomial(x, beta)
        printf "%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g\n", reference["speed"] * x * beta / omega / half_width,
            (preload + spring * s + mass * omega ^ 2 * dds) / width / reference["load"],
            omega * (base_radius + s + 2 * dds) / 2 / reference["speed"], (base_radius + s + dds) / reference["radius"],
            1 - softening * (ds / largest) ^ 2, duration * (x - 0.5), 1000 * s
    }
}
