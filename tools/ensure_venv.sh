#!/usr/bin/env bash
# ensure_venv.sh VENV: a virtual environment of Python 3.11 or newer. PYTHON names the interpreter to take.
set -euo pipefail
venv=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/apt.sh"

new_enough() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; }

if [ -x "$venv/bin/python" ] && "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
    exit 0
fi

python=
for candidate in ${PYTHON:-python3 python3.14 python3.13 python3.12 python3.11}; do
    if new_enough "$candidate"; then
        python=$candidate
        break
    fi
done
if [ -z "$python" ]; then
    echo "set-up: ${PYTHON:-python3} is not a Python >= 3.11. Install one (Debian 12, Ubuntu 24.04 and newer:" >&2
    echo "    apt-get install python3 python3-venv), or name one: make PYTHON=/path/to/python3.11" >&2
    exit 1
fi

echo "set-up: virtual environment $venv of $("$python" --version)"
# Debian's Python lacks ensurepip until its package python3.N-venv is there; a half-made environment must go.
if ! log=$("$python" -m venv --clear "$venv" 2>&1); then
    rm -rf "$venv"
    if "$python" -c 'import ensurepip' 2>/dev/null; then
        echo "$log" >&2
        exit 1
    fi
    apt_install "$("$python" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')"
    "$python" -m venv "$venv"
fi
