#!/usr/bin/env bash
# Tests sweeps and RLlib on Ray, in two temporary environments: Ray Tune with the newest Gymnasium, and RLlib with the
# Gymnasium that it is pinned to. Takes ten minutes and 4 GB of disk:
#   bash scripts/test_ray.sh [tune] [rllib]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || set -- tune rllib

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export RAY_USAGE_STATS_ENABLED=0

# the tested versions, without Gymnasium's and those of packages that Ray chooses
grep -vE '^(gymnasium|protobuf|click|grpcio|fsspec|filelock)==' constraints.txt > "$folder/constraints.txt"

test_with() {
    local venv="$folder/$1" packages=("${@:2}")
    echo "== $1"
    "${PYTHON:-python3}" -m venv "$venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --constraint "$folder/constraints.txt" \
        --editable '.[train,ray]' pytest hypothesis "${packages[@]}"
    "$venv/bin/python" -m pip list --disable-pip-version-check 2>/dev/null | grep -iE '^(ray|optuna|gymnasium|torch) '
    "$venv/bin/python" -m pytest -p no:cacheprovider tests/commands/test_sweep.py tests/commands/test_sweep_on_ray.py \
        tests/agents/test_rllib.py
}

for name in "$@"; do
    case $name in
        tune) test_with tune ;;
        rllib) test_with rllib 'ray[rllib]' ;;
        *) echo "usage: bash scripts/test_ray.sh [tune] [rllib]" >&2; exit 2 ;;
    esac
done
