# Sourced: apt_install PACKAGE... installs Debian packages as root, through sudo where needed, or says what to do.

apt_install() {
    local as_root=()
    if ! command -v apt-get >/dev/null; then
        echo "set-up: this system has no apt-get; please install what Debian calls: $*" >&2
        return 1
    fi
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "set-up: not root, and no sudo; please run as root: apt-get install $*" >&2
            return 1
        fi
        as_root=(sudo)
    fi
    echo "set-up: apt-get install $*"
    # Lists that cannot be refreshed (a third party's server is down) need not stop the installation.
    "${as_root[@]}" apt-get update -qq || true
    if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"; then
        echo "set-up: that failed; please run as root: apt-get install $*" >&2
        return 1
    fi
}
