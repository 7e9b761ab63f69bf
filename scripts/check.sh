#!/bin/sh
# Everything that must hold before a change lands: style, types, layers, tests, published tables.
# Run it with the package and its extra [test] installed; the README has the line.
set -eu
cd "$(dirname "$0")/.."
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

ruff check .
ruff format --check .
mypy
lint-imports
pytest -n auto

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
debrisest sweep configs/*.yaml --runs 20 --check --out "$results" >"$results/tables.txt"
debrisest plot configs/*.yaml --runs 20 --case 1 --case fig4 --case B --case nominal --out "$results" >/dev/null
echo "all checks passed"
