#!/bin/sh
# Everything that must hold before a change lands: style, types, layers, tests, published tables.
# Run it with the package and its extra [test] installed; the README has the line.
set -eu
cd "$(dirname "$0")/.."
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

static() {
    ruff check .
    ruff format --check .
    lint-imports
    mypy
    if python -c "import furo, myst_parser, sphinx" 2>/dev/null; then
        sphinx-build -q -W --keep-going -b html docs "$(mktemp -d)"
    fi
}

static &
pytest -n auto
wait $!

# The tests run what numba compiles, if it is there; the published tables are numpy's.
export DEBRISEST_COMPILED=0
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
cd configs
# Ten runs of what is cheap, then four of all: of the batch again and again, and of unknown points.
debrisest sweep biondi2017.yaml --estimator printed --estimator reproduction --estimator wahba \
    --estimator direction_cosines --estimator direction_cosines_joint --estimator line_spectrum \
    --estimator best --estimator bound --estimator smoother_bound \
    --runs 10 --check --out "$results" >"$results/tables.txt"
debrisest sweep first_steps.yaml --runs 10 --check --out "$results" >>"$results/tables.txt"
debrisest sweep li2011.yaml pesce2017.yaml random_observers.yaml --runs 20 --check --out "$results" >>"$results/tables.txt"
debrisest sweep volpe2017.yaml --case nominal --case spin-free \
    --runs 20 --check --out "$results" >>"$results/tables.txt"
# Four runs cannot tell what a hundred say of "far".
debrisest sweep random_stereo.yaml --estimator best --case slow --case slower --case 3-deg-s --case 9-deg-s \
    --case 20-deg-s --case slender --case sphere --case spin --case three-points --case near --case noisy \
    --case vague --runs 4 --check --out "$results" >>"$results/tables.txt"
debrisest sweep biondi2017.yaml biondi2017-noise.yaml biondi2017-robust.yaml pesce2017-robust.yaml \
    random_targets.yaml --runs 4 --check --out "$results" >>"$results/tables.txt"
# Every case of every scenario at least once, but for images, of which the tests have a short chain;
# what has run already is not run again.
debrisest sweep $(ls *.yaml | grep -v images) --runs 1 --out "$results" >>"$results/tables.txt"
debrisest table random_shapes.yaml --runs 1 --check --out "$results" >>"$results/tables.txt"
debrisest plot biondi2017.yaml li2011.yaml pesce2017.yaml volpe2017.yaml \
    --case 1 --case fig4 --case B --case nominal --runs 10 --out "$results" >/dev/null
echo "all checks passed"
