#!/bin/sh
# Installs the system packages that Caustica needs, if they are missing. The Makefile, the Dockerfile and the CI all call
# this script, so that there is one list.
#
#   deploy/install-deps.sh --build       what compiling needs: a C and C++ compiler and linker, make
#   deploy/install-deps.sh --run         what running needs: the Vulkan loader and a driver (software if there is no other)
#   deploy/install-deps.sh --container   --run, and what a GPU driver mounted into a container links against
#   deploy/install-deps.sh --lint        what `make lint` needs: rustfmt and clippy, which a minimal Rust toolchain lacks
#
# Options can be combined; the default is --build --run. If nothing is missing, nothing is installed and root is not needed.
set -eu

usage() {
    sed -n '2,10s/^# \{0,1\}//p' "$0"
}

build=no run=no container=no lint=no
[ $# -gt 0 ] || { build=yes run=yes; }
for option in "$@"; do
    case $option in
        --build) build=yes ;;
        --run) run=yes ;;
        --container) run=yes container=yes ;;
        --lint) lint=yes ;;
        -h | --help) usage && exit 0 ;;
        *) echo "install-deps: unknown option $option" >&2 && usage >&2 && exit 2 ;;
    esac
done

has_command() { command -v "$1" >/dev/null 2>&1; }

# Compiles, finds the C library's headers and links: gcc without libc6-dev fails here.
has_c_compiler() {
    has_command cc && printf '#include <stdio.h>\nint main(void) { return 0; }\n' |
        cc -x c -o /dev/null - >/dev/null 2>&1
}

# The same check for C++: g++ without libstdc++-dev fails here.
has_cxx_compiler() {
    has_command c++ && printf '#include <cmath>\nint main() { return 0; }\n' |
        c++ -x c++ -o /dev/null - >/dev/null 2>&1
}

has_library() {
    for ldconfig in ldconfig /sbin/ldconfig /usr/sbin/ldconfig; do
        has_command "$ldconfig" && "$ldconfig" -p 2>/dev/null | grep -q "[[:space:]]$1 " && return 0
    done
    return 1
}

# A driver registers with the Vulkan loader by a JSON file.
has_vulkan_driver() {
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    for file in /usr/share/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json; do
        [ -e "$file" ] && return 0
    done
    return 1
}

# 1. Check what is needed; collect the Debian packages of what is missing.
missing=
need() { # need PACKAGES TEST...
    packages=$1
    shift
    "$@" || missing="$missing $packages"
}

if [ $build = yes ]; then
    # The build of blake3 compiles assembly; Rust links through cc.
    need "gcc libc6-dev" has_c_compiler
    # The build of nv-flip compiles C++.
    need g++ has_cxx_compiler
    need make has_command make
fi
# macOS brings Metal, and needs nothing to run.
if [ $run = yes ] && [ "$(uname -s)" != Darwin ]; then
    need libvulkan1 has_library libvulkan.so.1
    # What C++ code of the program links against.
    need libstdc++6 has_library libstdc++.so.6
    need mesa-vulkan-drivers has_vulkan_driver
fi
if [ $container = yes ]; then
    need libegl1 has_library libEGL.so.1
    need libxext6 has_library libXext.so.6
fi

# 2. Install it, where the packages have these names.
if [ -n "$missing" ]; then
    if ! has_command apt-get; then
        echo "install-deps: missing here, by the names of the Debian packages:$missing" >&2
        echo "install-deps: please install their equivalents (a C and a C++ compiler, make, the Vulkan loader, a Vulkan driver)" >&2
        # On such a system a driver may be registered elsewhere, and make exists if it called this script.
        if [ $build = yes ] && ! { has_c_compiler && has_cxx_compiler; }; then exit 1; fi
        if [ $run = yes ] && ! has_library libvulkan.so.1; then exit 1; fi
        echo "install-deps: going on with what is here" >&2
    else
        sudo=
        if [ "$(id -u)" -ne 0 ]; then
            if ! has_command sudo; then
                echo "install-deps: please run as root: apt-get install --no-install-recommends$missing" >&2
                exit 1
            fi
            sudo=sudo
        fi
        echo "install-deps: installing$missing" >&2
        $sudo apt-get update -q >&2
        # shellcheck disable=SC2086 # a list of words
        $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing >&2
    fi
fi

# 3. Rust comes from rustup, not from the system: Debian's is too old.
if [ $build = yes ] && ! has_command cargo; then
    echo "install-deps: cargo is missing; please install Rust from https://rustup.rs" >&2
    exit 1
fi

# 4. rustfmt and clippy are components of the toolchain.
has_lint_tools() { cargo fmt --version >/dev/null 2>&1 && cargo clippy --version >/dev/null 2>&1; }

if [ $lint = yes ] && ! has_lint_tools; then
    if has_command rustup; then
        echo "install-deps: adding rustfmt and clippy to the Rust toolchain" >&2
        rustup component add rustfmt clippy >&2
    fi
    if ! has_lint_tools; then
        echo "install-deps: \`cargo fmt\` or \`cargo clippy\` is missing; please install rustfmt and clippy for this toolchain" >&2
        exit 1
    fi
fi
