#!/usr/bin/env bash
# Installs missing packages on a Debian machine. Does nothing, without network access, if none is
# missing.
#
# usage: tests/support/setup.sh [test] [lint] [can] [fuzz] [vcan] [firmware] [validate] [eigen]
#        [mutate] [browser] [python]
#   test: g++, Eigen (EIGEN_DIR), cmocka, cmake, pkg-config, gcc-arm-none-eabi, Unity (UNITY_DIR,
#         else fetched into third_party/unity)
#   lint: clang, clang-tidy, cppcheck, binutils, python3
#   can:  python3 with the packages of tests/can/requirements.txt, in third_party/venv
#   validate: python3 with tools/python_validation and its packages, in third_party/validation
#   browser: Chromium and a font, which show the page of `auvid fit --report`
#   python: python3 with tools/python and its packages, in third_party/python
#   mutate: python3 with the packages of tests/mutation/requirements.txt, in third_party/mutation
#   fuzz: clang with libFuzzer
#   vcan: can-utils and, unless this machine's kernel has vcan, QEMU and a kernel in third_party/vm
#   firmware: compilers for ARM and RISC-V with their C libraries, QEMU for both, clang
#   eigen: what `make bench-eigen` needs: Eigen, and a C++ library for ARM
# The compiler and make are always checked.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Unity 2.4.3 (MIT) from the Debian source package cjson.
unity_sha256=5308fd4bd90cef7aa060558514de6a1a4a0819974a26e6ed13973c5f624c24b2
unity_default=third_party/unity/src
unity=${UNITY_DIR:-$unity_default}
eigen=${EIGEN_DIR:-/usr/include/eigen3}

die() {
    echo "setup: $*" >&2
    exit 1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    else
        sudo "$@"
    fi
}

# libFuzzer is a separate package of the same version as clang.
fuzzer_is_there() {
    command -v clang >/dev/null &&
        echo 'int LLVMFuzzerTestOneInput(void); int LLVMFuzzerTestOneInput(void) { return 0; }' |
        clang -fsanitize=fuzzer -xc -o /dev/null - 2>/dev/null
}

fuzzer_package() {
    local version
    version=$(clang -dumpversion 2>/dev/null || echo 14)
    echo "libclang-rt-${version%%.*}-dev"
}

# Requirements of a virtual machine with CAN, for a kernel without CAN (tests/vcan).
look_for_machine() {
    command -v qemu-system-x86_64 >/dev/null || missing+=(qemu-system-x86)
    command -v cpio >/dev/null || missing+=(cpio)
    command -v xz >/dev/null || missing+=(xz-utils)
    { command -v busybox && ! ldd "$(command -v busybox)"; } >/dev/null 2>&1 ||
        missing+=(busybox-static)
}

# Fills missing[] with packages.
look() {
    missing=()
    command -v gcc >/dev/null || missing+=(gcc)
    command -v make >/dev/null || missing+=(make)
    [ -e /usr/include/stdio.h ] || missing+=(libc6-dev)
    for part in "$@"; do
        case $part in
        test)
            command -v g++ >/dev/null || missing+=(g++)
            [ -e "$eigen/Eigen/Core" ] || missing+=(libeigen3-dev)
            [ -e /usr/include/cmocka.h ] || missing+=(libcmocka-dev)
            command -v cmake >/dev/null || missing+=(cmake)
            command -v pkg-config >/dev/null || missing+=(pkg-config)
            command -v arm-none-eabi-gcc >/dev/null || missing+=(gcc-arm-none-eabi)
            [ -e /usr/include/newlib/string.h ] || missing+=(libnewlib-arm-none-eabi)
            ;;
        vcan)
            command -v candump >/dev/null || missing+=(can-utils)
            command -v ip >/dev/null || missing+=(iproute2)
            tests/vcan/run.sh --native || look_for_machine
            ;;
        browser)
            command -v chromium >/dev/null || missing+=(chromium)
            [ -e /usr/share/fonts/truetype/dejavu ] || missing+=(fonts-dejavu-core)
            ;;
        lint)
            for tool in clang clang-tidy cppcheck python3; do
                command -v "$tool" >/dev/null || missing+=("$tool")
            done
            command -v objdump >/dev/null || missing+=(binutils)
            ;;
        can | validate | mutate | python)
            python3 -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3-venv)
            ;;
        firmware)
            command -v arm-none-eabi-gcc >/dev/null || missing+=(gcc-arm-none-eabi)
            [ -d /usr/lib/arm-none-eabi/newlib ] || missing+=(libnewlib-arm-none-eabi)
            command -v riscv64-unknown-elf-gcc >/dev/null || missing+=(gcc-riscv64-unknown-elf)
            [ -e /usr/lib/picolibc/riscv64-unknown-elf/picolibc.specs ] ||
                missing+=(picolibc-riscv64-unknown-elf)
            command -v qemu-system-arm >/dev/null || missing+=(qemu-system-arm)
            command -v qemu-system-riscv32 >/dev/null || missing+=(qemu-system-misc)
            command -v clang >/dev/null || missing+=(clang)
            ;;
        eigen)
            [ -e "$eigen/Eigen/Core" ] || missing+=(libeigen3-dev)
            compgen -G '/usr/include/newlib/c++/*/cmath' >/dev/null ||
                missing+=(libstdc++-arm-none-eabi-newlib)
            ;;
        fuzz)
            command -v clang >/dev/null || missing+=(clang)
            fuzzer_is_there || missing+=("$(fuzzer_package)")
            ;;
        *) die "unknown part '$part'" ;;
        esac
    done
}

install_missing() {
    echo "setup: installing ${missing[*]}"
    command -v apt-get >/dev/null || die "no apt-get here; please install: ${missing[*]}"
    [ "$(id -u)" = 0 ] || command -v sudo >/dev/null ||
        die "neither root nor sudo; please run as root: apt-get install ${missing[*]}"
    as_root apt-get -qq update
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o DPkg::Lock::Timeout=120 \
        install --no-install-recommends "${missing[@]}" >/dev/null
}

# The mirror in the apt configuration of this machine.
debian_mirror() {
    apt-get indextargets --no-release-info --format '$(REPO_URI) $(COMPONENT) $(RELEASE)' \
        'Created-By: Packages' |
        awk '$2 == "main" && $3 !~ /-/ { print $1; exit }'
}

# apt uses separate lists in third_party/, so the configuration of the machine does not change.
fetch_unity() {
    echo "setup: fetching Unity (Debian source package cjson)"
    command -v apt-get >/dev/null || die "no apt-get here; set UNITY_DIR to a copy of Unity's src/"
    local mirror keyring=/usr/share/keyrings/debian-archive-keyring.gpg top=$PWD/third_party/apt
    mirror=$(debian_mirror)
    [ -n "$mirror" ] || die "no mirror in apt's configuration; set UNITY_DIR to Unity's src/"
    rm -rf "$top"
    mkdir -p "$top/lists/partial" "$top/cache/archives/partial"
    echo "deb-src [signed-by=$keyring] $mirror bookworm main" >"$top/sources.list"
    local options=(-qq -o "Dir::Etc::sourcelist=$top/sources.list"
        -o Dir::Etc::sourceparts=/dev/null -o "Dir::State::lists=$top/lists"
        -o "Dir::Cache=$top/cache" -o "APT::Sandbox::User=$(id -un)")
    # One chain of &&: the shell does not stop at errors on the left of ||.
    (
        cd "$top" &&
            apt-get "${options[@]}" update &&
            apt-get "${options[@]}" source --download-only --tar-only cjson &&
            echo "$unity_sha256  $(echo cjson_*.orig.tar.gz)" | sha256sum --check --quiet &&
            tar xf cjson_*.orig.tar.gz --wildcards --strip-components=3 \
                '*/tests/unity/src' '*/tests/unity/examples/unity_config.h'
    ) || die "could not fetch Unity; set UNITY_DIR to a copy of Unity's src/"
    rm -rf third_party/unity
    mkdir third_party/unity
    mv "$top/src" "$top/examples" third_party/unity/
    rm -rf "$top"
}

# python_environment FOLDER REQUIREMENTS [ARGUMENTS of a second pip install]
# The stamp holds the installed list: a changed list is installed again.
python_environment() {
    local folder=$1 requirements=$2
    shift 2
    ! cmp -s "$requirements" "$folder/installed.txt" || return 0
    # Tests that run at the same time may need the same folder.
    mkdir -p third_party
    exec 9>third_party/environments.lock
    flock 9
    ! cmp -s "$requirements" "$folder/installed.txt" || return 0
    echo "setup: making $folder ($(grep -v '^#' "$requirements" | tr '\n' ' '))"
    rm -rf "$folder"
    # One pip serves all folders: a copy of it in each takes five seconds.
    local tool=third_party/pip
    local pip=("$tool/bin/pip" --python "$folder/bin/python" install -q --no-compile
        --disable-pip-version-check)
    [ -x "$tool/bin/pip" ] || python3 -m venv "$tool" || die "could not make $tool"
    python3 -m venv --without-pip "$folder" && "${pip[@]}" -r "$requirements" &&
        { [ $# = 0 ] || "${pip[@]}" "$@"; } || die "could not install $requirements with pip"
    cp "$requirements" "$folder/installed.txt"
}

look "$@"
if [ ${#missing[@]} -gt 0 ]; then
    install_missing
    look "$@"
    [ ${#missing[@]} = 0 ] || die "still missing: ${missing[*]} (is EIGEN_DIR right?)"
fi
if [[ " $* " == *" test "* && ! -e $unity/unity.c ]]; then
    [ "$unity" = "$unity_default" ] || die "no unity.c in UNITY_DIR=$unity"
    fetch_unity
fi
if [[ " $* " == *" can "* ]]; then
    python_environment third_party/venv tests/can/requirements.txt
fi
if [[ " $* " == *" validate "* ]]; then
    python_environment third_party/validation tools/python_validation/requirements.txt \
        --no-build-isolation --no-deps -e tools/python_validation
fi
if [[ " $* " == *" python "* ]]; then
    python_environment third_party/python tools/python/requirements.txt \
        --no-build-isolation --no-deps -e tools/python
fi
if [[ " $* " == *" mutate "* ]]; then
    python_environment third_party/mutation tests/mutation/requirements.txt
fi
if [[ " $* " == *" vcan "* ]] && ! tests/vcan/run.sh --native; then
    # Package lists may be older than the newest kernel on the mirror.
    tests/vcan/kernel.sh || { as_root apt-get -qq update && tests/vcan/kernel.sh; }
fi
