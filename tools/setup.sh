# Shared by tools/quickstart, tools/test, tools/bench, tools/tidy, tools/site and .ci/run: installs the packages that are missing, then
# configures, builds and installs a preset.
# Sourced, not run. Needs bash and, on Debian, apt.

rodwake_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n==> %s\n' "$*"; }

# wanted_packages SECTION...
wanted_packages() {
    awk -v wanted=" $* " '/^\[/ { on = index(wanted, " " substr($1, 2, length($1) - 2) " "); next } on && NF && !/^#/ { print $1 }' \
        "$rodwake_root/tools/packages.txt" | sort -u
}

missing_packages() {
    wanted_packages "$@" | while read -r package; do
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

# install_packages SECTION... of packages.txt
install_packages() {
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "this is not a Debian system: install the counterparts of these Debian 12 packages, then build with cmake --preset release"
        wanted_packages "$@"
        exit 1
    fi
    local missing
    missing=$(missing_packages "$@")
    if [ -z "$missing" ]; then
        say "packages: all present"
        return
    fi
    say "packages: installing these and what they need; some minutes, and no word until it is done:" $missing
    as_root apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq -o DPkg::Lock::Timeout=300 --no-install-recommends $missing >/dev/null
}

# build_preset PRESET [-D...] [ARGS of cmake --build]...; counts what is compiled.
build_preset() {
    say "build: preset $*"
    local preset=$1 settings=()
    shift
    while [[ ${1:-} == -D* ]]; do settings+=("$1"); shift; done
    (cd "$rodwake_root" && cmake --preset "$preset" "${settings[@]}" >/dev/null &&
        NINJA_STATUS="[compiling %f of %t, %es] " cmake --build --preset "$preset" "$@")
}

# The program and the benchmarks, in build/release.
build_benchmarks() {
    build_preset release -DRODWAKE_BENCH=ON --target rodwake benchmarks
}

# Where CMake, shells and Python look by themselves.
default_prefix() { if [ "$(id -u)" -eq 0 ]; then echo /usr/local; else echo "$HOME/.local"; fi; }

# install_preset PRESET PREFIX
install_preset() {
    say "install: $2"
    cmake --install "$rodwake_root/build/$1" --prefix "$2" >/dev/null
}
