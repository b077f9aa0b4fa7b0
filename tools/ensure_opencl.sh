#!/usr/bin/env bash
# ensure_opencl.sh VENV: an OpenCL device that builds and runs a kernel. Uses what is there; else tries PoCL from pip,
# and keeps it only if it works; else installs PoCL by apt. Says what it did.
set -euo pipefail
venv=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/apt.sh"

report=$(mktemp)
trap 'rm -f "$report"' EXIT

# 69 is thurston's exit code for "no device works"; anything else is not cured by installing a driver.
works() {
    local code=0
    "$venv/bin/thurston" devices --check >"$report" 2>&1 || code=$?
    if [ "$code" -ne 0 ] && [ "$code" -ne 69 ]; then
        cat "$report" >&2
        exit 1
    fi
    return "$code"
}

if works; then
    exit 0
fi

echo "set-up: no OpenCL device works yet; trying PoCL from pip"
if "$venv/bin/python" -m pip install --quiet pocl-binary-distribution; then
    if works; then
        echo "set-up: PoCL from pip builds and runs a kernel here; kept"
        exit 0
    fi
    echo "set-up: PoCL from pip does not work on this CPU; removed"
    "$venv/bin/python" -m pip uninstall --quiet --yes pocl-binary-distribution
else
    echo "set-up: pip has no PoCL for this system"
fi

apt_install pocl-opencl-icd
if ! works; then
    echo "set-up: pocl-opencl-icd is installed, but still no device works:" >&2
    cat "$report" >&2
    exit 1
fi
echo "set-up: PoCL from apt builds and runs a kernel here"
