# SPDX-License-Identifier: GPL-3.0-or-later
# Cases of a cases.csv: a line each, under a header of settings of the scene (any keys, such as physical.load); an empty
# field leaves what the scene says. The column `name`, which there need not be, names the cases; columns published_...
# and title are no settings.
#     awk -f case.awk cases.csv                            their names
#     awk -f case.awk -v want=NAME cases.csv               the settings of one, for a program's command line
#     awk -f case.awk -v want=NAME -v title=1 cases.csv    what it is, for a picture
function is_setting(i) { return key[i] !~ /^(name|title|published_.*)$/ && $i != "" }

BEGIN { FS = " *, *" }
/^[ \t]*(#|$)/ { next }
!num_keys { num_keys = split($0, key); for (i = 1; i <= num_keys; i++) at[key[i]] = i; next }
{
    name = settings = text = ""
    for (i = 1; i <= num_keys; i++) {
        if (!is_setting(i)) continue
        short = key[i]
        sub(/.*\./, "", short)
        name = name (name == "" ? "" : "-") short $i
        settings = settings " --set " key[i] "=" $i
        text = text (text == "" ? "" : ", ") short " = " $i
    }
    if ("name" in at) name = $at["name"]
    gsub(/[^-A-Za-z0-9.+_]/, "_", name)
    if (want == "") print name
    else if (name == want) print title ? ("title" in at ? $at["title"] : text) : settings
}
