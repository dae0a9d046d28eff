# Shared by tools/quickstart, tools/test, tools/tidy and .ci/run: installs the packages that are missing, then configures and builds a preset.
# Sourced, not run. Needs bash and, on Debian, apt.

rodwake_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n==> %s\n' "$*"; }

wanted_packages() { sed 's/#.*//' "$rodwake_root/tools/packages.txt" | tr -s ' \n' '\n' | sed '/^$/d'; }

missing_packages() {
    wanted_packages | while read -r package; do
        status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
        [ "$status" = "install ok installed" ] || echo "$package"
    done
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        echo "packages are missing and this user is neither root nor able to sudo; as root run: $*" >&2
        exit 1
    fi
}

install_packages() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "this is not a Debian system: install the counterparts of these Debian 12 packages, then build with cmake --preset release"
        wanted_packages
        exit 1
    fi
    local missing
    missing=$(missing_packages)
    if [ -z "$missing" ]; then
        say "packages: all present"
        return
    fi
    say "packages: installing" $missing
    as_root apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq -o DPkg::Lock::Timeout=300 --no-install-recommends $missing >/dev/null
}

# build_preset PRESET [ARGS of cmake --build]...
build_preset() {
    say "build: preset $*"
    (cd "$rodwake_root" && cmake --preset "$1" >/dev/null && cmake --build --preset "$@")
}
