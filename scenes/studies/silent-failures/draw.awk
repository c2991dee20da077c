# SPDX-License-Identifier: GPL-3.0-or-later
# Random scenes around the training points of a model, whose M and alpha p_H it reads:
#     draw.awk -v seed=N -v count=N -v folder=FOLDER -v scene=SCENE.yml [-v own=1] TRAINED.txt
# Writes FOLDER/plan.yml with its scenes, and FOLDER/scenes.txt with a line each in the plan's order: where
# (inside, outside), whose lubricant (own, other), scene file, and the settings of the point. With own=1 all
# are inside and of the lubricant that the model was trained with. Half lie inside of the hull of the training
# points, half outside but within a rectangle of twice its extent. Kind of contact, grid and the lubricant called its own
# are those of the scene that was trained on.

# The same numbers with any awk (Park and Miller 1988).
function random() {
    state = 16807 * state % 2147483647
    return state / 2147483647
}

function turn(a, b, m, p) {
    return (M[b] - M[a]) * (p - P[a]) - (P[b] - P[a]) * (m - M[a])
}

# Hull of the points, ascending in M, by the monotone chain, counter-clockwise.
function find_hull(   i, lower) {
    for (i = 1; i <= n; i++) {
        while (size > 1 && turn(hull[size - 1], hull[size], M[i], P[i]) <= 0) size--
        hull[++size] = i
    }
    lower = size + 1
    for (i = n - 1; i >= 1; i--) {
        while (size >= lower && turn(hull[size - 1], hull[size], M[i], P[i]) <= 0) size--
        hull[++size] = i
    }
}

function inside(m, p,   i) {
    for (i = 1; i < size; i++)
        if (turn(hull[i], hull[i + 1], m, p) < 0) return 0
    return 1
}

# alpha: 1/Pa, 0: drawn; limit: Pa, most Hertz pressure, so that the spike stays below that of the law
function add_law(settings, alpha, limit) {
    law[++num_laws] = settings
    law_alpha[num_laws] = alpha
    law_limit[num_laws] = limit
}

# The law of the scene that was trained on, where it is none of those that are always drawn.
function add_own_law(   settings, alpha) {
    settings = scene_line["  viscosity"]
    sub(/^[^{]*{/, "", settings)
    sub(/}.*/, "", settings)
    if (settings ~ /preset: no1/) return
    alpha = settings
    if (!sub(/.*alpha: */, "", alpha)) { print scene ": found viscosity " settings ", expected an alpha" > "/dev/stderr"; exit 1 }
    add_law(settings, alpha + 0, 1e12)
}

# Moes' L of a place.
function moes_L(m, p) {
    return p / (contact == "point" ? (1.5 * m) ^ (1 / 3) / pi : sqrt(m / (2 * pi)))
}

function draw_place(want,   stretch) {
    stretch = want ? 1 : 2
    do {
        m = (least_M + most_M) / 2 + stretch * (random() - 0.5) * (most_M - least_M)
        p = (least_P + most_P) / 2 + stretch * (random() - 0.5) * (most_P - least_P)
    } while (m < 1 || p < 0 || inside(m, p) != want || moes_L(m, p) > most_L)
}

function draw(want,   which, density, alpha, key, L) {
    do {
        draw_place(want)
        which = own ? 1 : 1 + int(num_laws * random())
        density = own ? 1 : 1 + int(2 * random())
        alpha = law_alpha[which] ? law_alpha[which] : (1 + 2 * random()) * 1e-8
    } while (p / alpha > law_limit[which])
    key = which SUBSEP density
    L = moes_L(m, p)
    places[key] = places[key] sprintf("%.12g,%.12g%s\n", m, L,
        law_alpha[which] ? "" : sprintf(",%.12g", alpha))
    lines[key] = lines[key] sprintf("%s %s scene-%d-%d.yml moes.M=%.12g moes.L=%.12g%s\n",
        want ? "inside" : "outside", key == 1 SUBSEP 1 ? "own" : "other", which, density, m, L,
        law_alpha[which] ? "" : sprintf(" lubricant.viscosity.alpha=%.12g", alpha))
}

# Lines of a scene by their keys, indented as they are.
function read_scene(file,   line, key) {
    while ((getline line < file) > 0) {
        key = line
        if (sub(/:.*/, "", key)) scene_line[key] = line
    }
    contact = scene_line["contact"]
    sub(/^contact: */, "", contact)
    sub(/[ #].*/, "", contact)
}

function write_group(which, density,   name, key) {
    key = which SUBSEP density
    if (!(key in places)) return
    name = which "-" density
    printf "contact: %s\nregime: stationary\nlubricant:\n  viscosity: {%s}\n  density: {law: %s}\n%s\n", contact,
        law[which], density == 1 ? "dowson-higginson" : "incompressible", scene_line["grid"] > (folder "/scene-" name ".yml")
    printf "moes.M,moes.L%s\n%s", law_alpha[which] ? "" : ",lubricant.viscosity.alpha",
        places[key] > (folder "/points-" name ".csv")
    printf "  - {scene: scene-%s.yml, points: points-%s.csv}\n", name, name > (folder "/plan.yml")
    printf "%s", lines[key] > (folder "/scenes.txt")
}

BEGIN {
    pi = atan2(0, -1)
    most_L = 40
    read_scene(scene)
    state = seed % 2147483646 + 1
    for (i = 0; i < 10; i++) random() # seeds that are near one another start alike
    add_own_law()
    add_law("law: wlf, preset: no1", 23.60e-9, 9e9)
    add_law("law: wlf, preset: no2", 12.51e-9, 4e9)
    add_law("law: wlf, preset: no3", 18.05e-9, 3.8e9)
    add_law("law: barus", 0, 1e12)
    add_law("law: roelands, eta0: 0.04", 0, 1e12)
}

# Insertion keeps the points ascending.
{
    for (i = n++; i >= 1 && (M[i] > $1 || (M[i] == $1 && P[i] > $2)); i--) {
        M[i + 1] = M[i]
        P[i + 1] = P[i]
    }
    M[i + 1] = $1
    P[i + 1] = $2
    if (n == 1 || $1 < least_M) least_M = $1
    if (n == 1 || $1 > most_M) most_M = $1
    if (n == 1 || $2 < least_P) least_P = $2
    if (n == 1 || $2 > most_P) most_P = $2
}

END {
    find_hull()
    for (i = 0; i < count; i++) draw(own || i % 2 == 0)
    print "groups:" > (folder "/plan.yml")
    for (i = 1; i <= num_laws; i++)
        for (j = 1; j <= 2; j++) write_group(i, j)
}
