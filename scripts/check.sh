#!/bin/sh
# Everything that must hold before a change lands: style, types, layers, tests, published tables.
# Run it with the package and its extra [test] installed; the README has the line.
# Tests and tables go side by side, in as many processes that no core waits for the end of another.
set -eu
cd "$(dirname "$0")/.."
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
unset PYTHONDONTWRITEBYTECODE # the tests start some two hundred processes
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

static() {
    ruff check .
    ruff format --check .
    lint-imports
    mypy
    if python -c "import furo, myst_parser, sphinx" 2>/dev/null; then
        sphinx-build -q -W --keep-going -b html docs "$(mktemp -d)"
    fi
}

sweep() {
    debrisest sweep --jobs 1 --quiet --out "$results" "$@" >>"$results/tables.txt"
}

# Ten runs of what is cheap, then four of all, and last every case of every scenario at least once
# but for images, of which the tests have a short chain; what has run already is not run again.
# By loops where there is numba, which tests hold to numpy, and a first part by numpy.
points() {
    cd configs
    DEBRISEST_COMPILED=0 sweep first_steps.yaml --runs 10 --check
    DEBRISEST_COMPILED=0 sweep random_observers.yaml --runs 20 --check
    sweep biondi2017.yaml --estimator printed --estimator reproduction --estimator wahba \
        --estimator direction_cosines --estimator direction_cosines_joint --estimator line_spectrum \
        --estimator best --estimator bound --estimator smoother_bound --runs 10 --check
    sweep biondi2017.yaml biondi2017-noise.yaml biondi2017-robust.yaml random_targets.yaml \
        --runs 4 --check
    debrisest plot biondi2017.yaml --case 1 --case fig4 --runs 10 --out "$results" >/dev/null
}

cameras() {
    cd configs
    sweep li2011.yaml pesce2017.yaml --runs 20 --check
    sweep volpe2017.yaml --case nominal --case spin-free --runs 20 --check
    # Four runs cannot tell what a hundred say of "far".
    sweep random_stereo.yaml --estimator best --case slow --case slower --case 3-deg-s --case 9-deg-s \
        --case 20-deg-s --case slender --case sphere --case spin --case three-points --case near \
        --case noisy --case vague --runs 4 --check
    sweep pesce2017-robust.yaml --runs 4 --check
    sweep $(ls *.yaml | grep -Ev 'images|biondi|first_steps|random_observers|random_targets') --runs 1
    debrisest table random_shapes.yaml --runs 1 --check --out "$results" >>"$results/tables.txt"
    debrisest plot li2011.yaml pesce2017.yaml volpe2017.yaml \
        --case B --case nominal --runs 10 --out "$results" >/dev/null
}

tests() {
    static
    pytest -n auto --dist worksteal
}

points &
running=$!
cameras &
running="$running $!"
tests &
running="$running $!"
failed=
for each in $running; do
    wait "$each" || failed=yes
done
[ -z "$failed" ]
echo "all checks passed"
