#!/bin/bash
# Tables of an experiment and of a run, read by pandas; exit code 77 where there is none.
#
#   tests/tables.sh WISPLAB
set -euo pipefail
wisplab=$1 here=$(dirname "${BASH_SOURCE[0]}") python=/usr/bin/python3 # Debian's packages are its
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" -c 'import pandas' 2>/dev/null || {
    echo "tables.sh: no python3-pandas here: not read"
    exit 77
}
export WISPLAB_HOST=tables-$$
"$wisplab" run sphere --duration 0.1 --diagnostics --no-progress --out "$work/run" >"$work/words"
"$wisplab" experiment circle --quick --stepper rk4 --stepper euler --no-progress --out "$work" >"$work/words"
"$python" "$here/tables.py" "$work/run" "$work/circle" "$work"/runs/*
