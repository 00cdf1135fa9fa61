#!/usr/bin/env bash
# Tests the lowest or the newest versions that pyproject.toml allows, in a temporary environment:
#   bash scripts/test_versions.sh lowest
#   bash scripts/test_versions.sh newest 3.12 3.13
# Pythons default to 3.11, 3.12 and 3.13; missing ones are skipped. Takes minutes per Python.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
which=${1:-}
if [ "$which" != lowest ] && [ "$which" != newest ]; then
    echo "usage: bash scripts/test_versions.sh lowest|newest [3.11 3.12 ...]" >&2
    exit 2
fi
shift
[ $# -gt 0 ] || set -- 3.11 3.12 3.13

# a representative selection: compiled code, errors, bodies, and the snake's environments
tests=(tests/test_import.py tests/test_versions.py tests/engine/test_compiler.py tests/engine/test_errors.py
       tests/engine/test_bodies.py tests/envs/test_episodes.py)

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

find_python() {
    local candidate
    for candidate in "python$1" "$HOME/.pyenv/versions/$1".*/bin/python; do
        if "$candidate" -c "import sys; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" 2>/dev/null; then
            echo "$candidate"
            return
        fi
    done
}

# pins numpy>=2.0 as numpy==2.0.* for the lowest versions; if a version has no wheel for a Python, the first with one
constraints() {
    "$1" - "$which" "$2" <<'PY'
import re, sys, tomllib
which, target = sys.argv[1:]
lines = tomllib.load(open("pyproject.toml", "rb"))["project"]["dependencies"]
# the first releases with wheels for a Python
first = {"3.12": {"scipy": "1.13"}, "3.13": {"numpy": "2.1", "scipy": "1.14.1"}}.get(target, {})
for line in lines if which == "lowest" else ():
    name, lowest = re.match(r"([\w.-]+)>=([\d.]+)", line).groups()
    print(f"{name}=={first.get(name, lowest)}")
PY
}

failed=()
for version in "$@"; do
    python=$(find_python "$version")
    if [ -z "$python" ]; then
        echo "== Python $version: skipped, not installed"
        continue
    fi
    echo "== Python $version with the $which versions"
    venv="$folder/$version"
    "$python" -m venv "$venv"
    constraints "$python" "$version" > "$venv/constraints.txt"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --constraint "$venv/constraints.txt" \
        --editable . pytest hypothesis
    "$venv/bin/python" -m pip list --disable-pip-version-check | grep -iE '^(numpy|numba|llvmlite|scipy|gymnasium) '
    ELASTICA_GYM_CACHE_DIR="$venv/cache" NUMBA_CACHE_DIR="$venv/cache" "$venv/bin/python" -m pytest -p no:cacheprovider -k "not Octopus" "${tests[@]}" || failed+=("$version")
    rm -rf "$venv"
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "== failed with the $which versions: Python ${failed[*]}" >&2
    exit 1
fi
