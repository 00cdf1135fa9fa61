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
