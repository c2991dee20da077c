#!/usr/bin/env bats
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the study of rough surfaces, a dimple and a waviness, on coarse grids, against physics and published curves.
# long_studies.bats runs them on the grids of the study.

load common

# bats test_tags=slow
@test "a dimple passes as it is in pure rolling; in sliding it is flattened and a patch of its film runs ahead" {
    copy_whole_study surfaces
    make dimple SET='--set grid.step=0.0703125' | tee table # 65 by 65 nodes
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy

def deeper(name, depth):
    """The film on the centre line above the undisturbed one, over the dimple's depth."""
    with h5py.File(f"out/{name}.h5") as file:
        line = abs(file["y"][...]).argmin()
        film = file["film_thickness"][:, line] * file.attrs["film_unit"]
        return file["time"][...], file["x"][...], file["surface_position"][...], (film - film[0]) / depth

# rolling: the lubricant in the dimple stays there, since so viscous a fluid moves only with the surfaces
_, x, place, more = deeper("ssr0", 175e-9)
moments = [k for k in numpy.where(abs(place) < 0.7)[0] if abs(x - place[k]).min() < 0.01] # its middle is at a node
left = [more[k, abs(x - place[k]).argmin()] for k in moments]
beside = [abs(more[k, (abs(x) < 0.9) & (abs(x - place[k]) > 0.5)]).max() for k in moments]
print(len(moments), min(left), max(left), max(beside))
assert len(moments) > 5 and 0.9 < min(left) and max(left) < 0.97, left
assert max(beside) < 0.02, beside

# sliding, with the dimple at half the mean speed: it flattens, and its change of the film moves on at the mean speed
time, x, place, more = deeper("ssr-05", 160e-9)
in_plug = (place > -0.3) & (place < 0.3)
left = [more[k, abs(x - place[k]) < 0.2].max() for k in numpy.where(in_plug)[0]]
ahead = (place > -0.4) & (place < -0.1)
tops = []
for k in numpy.where(ahead)[0]:
    at = numpy.where((x > place[k] + 0.2) & (x < 0.8))[0]
    i = at[more[k, at].argmax()]
    a, b, c = more[k, i - 1:i + 2]
    tops.append((time[k], x[i] + (x[1] - x[0]) * (a - c) / (2 * (a - 2 * b + c)), b)) # top of the parabola
tops = numpy.array(tops)
speed = numpy.polyfit(tops[:, 0], tops[:, 1], 1)[0]
speed_of_dimple = numpy.polyfit(time[ahead], place[ahead], 1)[0]
print(len(tops), min(left), max(left), speed, speed_of_dimple, tops[:, 2].min(), tops[:, 2].max())
assert abs(speed_of_dimple - 0.5) < 1e-9
assert len(tops) > 10 and abs(speed - 1) < 0.1, speed
assert 0.3 < tops[:, 2].min() and tops[:, 2].max() < 0.5, tops # as high as the dimple has become shallower
assert 0.3 < min(left) and max(left) < 0.6, left
PYTHON
    # L. Mourier et al., Tribology International 39 (2006): limits of the root mean square differences from their
    # simulation
    awk '$1 == "ssr0" { most = 6 } $1 == "ssr-05" { most = 4 }
         $1 == "ssr0" || $1 == "ssr-05" { found++; if (!($7 > 0 && $7 < most)) bad = 1 }
         END { exit bad || found != 10 }' table
}

# bats test_tags=slow
@test "short waves pass a contact that rolls and long ones are flattened, near the published curves" {
    copy_whole_study surfaces
    mkdir -p out
    PYTHONPATH=../../lib /usr/bin/python3 -B - >table <<'PYTHON'
import study
# lines of 301 and circles of 65 by 65 nodes
for contact, M, L, wavelengths, step in ("line", 100, 11, (2, 1, 0.5, 0.25), 0.02), ("point", 100, 10, (2, 1), 0.0703125):
    study.WAVES = {contact: [(M, L, wavelengths)]}
    study.waviness("out", 0.1, "--set", f"grid.step={step}", "--set", f"transient.fixed_step={step}")
PYTHON
    cat table
    # the remaining amplitudes of lines are near the values that Venner et al. (1997) computed, and those of circles are
    # near the fit of Venner and Lubrecht (2000). They are larger for shorter waves
    awk '$1 == "line" { off = $11; most = 5 } $1 == "point" { off = $8; most = 10 }
         $1 == "line" || $1 == "point" {
             found++
             if (!(off > -most && off < most) || ($1 == before && !($6 > left)) || !($6 > 0 && $6 < 1)) bad = 1
             before = $1; left = $6
         }
         END { exit bad || found != 6 }' table
}
