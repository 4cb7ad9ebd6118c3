#!/usr/bin/env bash
# Plays every scenario of launch-configs with two programs and compares all that they make of it, byte by byte: the traced
# signals (CSV), the events, and the bag, which holds every signal of every cycle, the outputs' messages and, once a second,
# the state of the machine. For changes that are to change nothing: build the program before and after, then
#
#   tests/same_runs.sh OLD_PROGRAM NEW_PROGRAM
set -euo pipefail
[ $# = 2 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
old=$(realpath "$1") new=$(realpath "$2")
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The cell of the command line in a scenario's comment, that of the folder's name, or the demo.
cell_of() {
    local named usual
    named=$(sed -n 's/^# *lineshaft sim \([^ ]*\).*/\1/p' "$1" | head -n 1)
    usual=launch-configs/$(basename "$(dirname "$1")").yaml
    if [ -n "$named" ]; then echo "$named"; elif [ -e "$usual" ]; then echo "$usual"; else echo launch-configs/demo.yaml; fi
}

play() { # PROGRAM CELL SCENARIO NAME
    mkdir -p "$folder/$4"
    local ended=0
    # One path for both, as what they print names it.
    ln -sfn "$folder/$4" "$folder/run"
    "$1" sim "$2" --scenario "$3" --events --csv "$folder/run/run.csv" --record "$folder/run/bag" \
        >"$folder/$4/said" 2>&1 || ended=$?
    # How fast it ran is no part of the run.
    sed -i 's/ in [0-9.]* s, [0-9.]* times real time//' "$folder/$4/said"
    echo "ended with $ended" >>"$folder/$4/said"
}

count=0 differ=0
while read -r scenario; do
    cell=$(cell_of "$scenario")
    play "$old" "$cell" "$scenario" old
    play "$new" "$cell" "$scenario" new
    count=$((count + 1))
    if [ ! -s "$folder/old/run.csv" ] || ! ls "$folder"/old/bag/*.mcap >/dev/null 2>&1; then
        echo "$scenario: the old program has made nothing to compare: $(tail -n 3 "$folder/old/said")" >&2
        differ=$((differ + 1))
    elif ! diff -rq "$folder/old" "$folder/new" >&2; then
        echo "$scenario on $cell differs" >&2
        differ=$((differ + 1))
    fi
    rm -rf "$folder/old" "$folder/new"
done < <(find launch-configs/scenarios -name '*.yaml' | sort)
echo "$count scenarios, $differ differ"
[ "$count" -gt 0 ] && [ "$differ" = 0 ]
