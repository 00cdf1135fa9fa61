# Sourced by the other scripts: makes .venv in the repository and installs pinned versions, once.
#   install_into_venv EXTRAS     EXTRAS as in pip: train,viz

install_into_venv() {
    local extras=$1 python=${PYTHON:-python3}
    if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
        echo "Python 3.11 or newer is needed; '$python' is not. Name another with PYTHON=/path/to/python3.11" >&2
        return 1
    fi
    if [ ! -x .venv/bin/python ]; then
        echo "Making .venv ..."
        "$python" -m venv .venv
    fi
    # stamp of the installed state: a second run does nothing
    local stamp=".venv/installed-$extras" state
    state=$(cat pyproject.toml constraints.txt | cksum)
    if [ "$(cat "$stamp" 2>/dev/null)" != "$state" ]; then
        echo "Installing elastica-gym[$extras] and its dependencies into .venv (a few minutes the first time) ..."
        .venv/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[$extras]"
        echo "$state" > "$stamp"
    fi
}
