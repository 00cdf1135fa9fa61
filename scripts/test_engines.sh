#!/usr/bin/env bash
# Tests the scripts of the RL libraries in scripts/examples/engines, in temporary environments:
#   bash scripts/test_engines.sh
#   bash scripts/test_engines.sh agilerl
# engines is the extra of that name; agilerl and tianshou need environments of their own. Takes minutes for each.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || set -- engines agilerl tianshou

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# torch is always pinned: another version may bring gigabytes of CUDA
failed=()
for name in "$@"; do
    cp constraints.txt "$folder/$name.txt"
    case $name in
        engines) packages=('.[train,engines]') ;;
        # without a version, pip tries all of them
        agilerl) packages=(. agilerl==2.58.0) ;;
        # it asks for a virtualenv that needs an older filelock than ours
        tianshou) packages=(. tianshou==2.0.1) && grep -E '^(torch|numpy|numba|gymnasium)==' constraints.txt > "$folder/$name.txt" ;;
        *) echo "usage: bash scripts/test_engines.sh [engines] [agilerl] [tianshou]" >&2 && exit 2 ;;
    esac
    echo "== $name"
    "${PYTHON:-python3}" -m venv "$folder/$name"
    python="$folder/$name/bin/python"
    install=("$python" -m pip install --quiet --disable-pip-version-check --constraint "$folder/$name.txt")
    "${install[@]}" torch "${packages[@]}"
    # AgileRL imports peft, and does not ask for it
    "${install[@]}" pytest hypothesis $([ "$name" != agilerl ] || echo peft)
    "$python" -m pip list --disable-pip-version-check |
        grep -iE '^(torch|gymnasium|numpy|sb3.contrib|sbx-rl|skrl|torchrl|agilerl|tianshou) '
    PYTHONPATH=$PWD "$python" -m pytest -p no:cacheprovider -rs tests/test_engines.py || failed+=("$name")
    rm -rf "${folder:?}/$name"
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "== failed: ${failed[*]}" >&2
    exit 1
fi
