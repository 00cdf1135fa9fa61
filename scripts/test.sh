#!/usr/bin/env bash
# Installs the test dependencies and runs the fast tests; --slow runs all tests. Other arguments go to pytest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
install_into_venv train,viz,test,bench,docs

select=(-m "not slow")
if [ "${1:-}" = --slow ]; then
    select=()
    shift
fi
.venv/bin/ruff check .
.venv/bin/ruff format --check .
.venv/bin/lint-imports
.venv/bin/mypy
.venv/bin/python -m sphinx -W --keep-going -q -b html docs docs/_build/html
.venv/bin/python scripts/benchmark.py --start
.venv/bin/python -m pytest -n 2 "${select[@]}" "$@"

# the contract of three environments with Gymnasium 1.2.2, to which RLlib is pinned
pinned=build/gymnasium-1.2.2
if [ ! -d "$pinned" ]; then
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --target "$pinned" gymnasium==1.2.2
fi
PYTHONPATH="$pinned" .venv/bin/python -m pytest -n 2 -m "not slow" -p no:cacheprovider \
    -k "(SnakeForward or OctopusReach-v1 or SnakeReachGoal) and not processes and not thousand" \
    tests/envs/test_contract.py tests/envs/test_episodes.py
