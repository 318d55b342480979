#!/usr/bin/env bash
# The library in other build systems: a wildcard and an include path with various flags, CMake,
# pkg-config, C++.
. "$(dirname "$0")/common.sh"
CC=${CC:-gcc}

cat >user.c <<'END'
#include <stdio.h>
#include "auvid/auvid.h"
static auvid_identifier_t id;
int main(void)
{
    auvid_identifier_config_t cfg;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    auvid_status_t status = auvid_identifier_init(&id, &cfg);
    printf("%d %u\n", (int)status, (unsigned)sizeof(auvid_real_t));
    return status == AUVID_OK ? 0 : 1;
}
END
cp user.c user.cpp

# compiles FLAG...: no warnings with these flags, and init accepts the arithmetic.
compiles() {
    "$CC" "$@" -I"$ROOT/lib/include" user.c "$ROOT"/lib/src/*/*.c -o user 2>log
    cat log
    [ ! -s log ] && ./user
}

cplusplus() {
    for standard in c++14 c++20; do
        g++ -std=$standard -Wall -Wextra -Wpedantic -Werror -I"$ROOT/lib/include" -c user.cpp
    done
    "$CC" -c -I"$ROOT/lib/include" "$ROOT"/lib/src/*/*.c
    g++ user.o auvid_*.o -o user
    ./user
}

subdirectory() {
    mkdir -p sub
    cat >sub/CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.16)
project(user C)
add_subdirectory($ROOT/lib auvid)
target_compile_definitions(auvid PUBLIC AUVID_MAX_SETS=4)
add_executable(user ../user.c)
target_link_libraries(user auvid::auvid)
END
    cmake -S sub -B sub/build && cmake --build sub/build && sub/build/user
}

installed() {
    cmake -S "$ROOT/lib" -B lib -DCMAKE_INSTALL_PREFIX="$PWD/usr" \
        -DAUVID_DEFINITIONS='AUVID_REAL_DOUBLE;AUVID_MAX_SETS=4'
    cmake --build lib
    cmake --install lib
    mkdir -p found
    cat >found/CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.16)
project(user C)
find_package(auvid $(sed -n 's/#define AUVID_VERSION_STRING "\(.*\)"/\1/p' \
    "$ROOT/lib/include/auvid/config.h") REQUIRED)
add_executable(user ../user.c)
target_link_libraries(user auvid::auvid)
END
    cmake -S found -B found/build -DCMAKE_PREFIX_PATH="$PWD/usr" &&
        cmake --build found/build && found/build/user | grep -q '^0 8$'
}

# pkg_config PREFIX BYTES: the library installed there has reals of so many bytes, by its auvid.pc.
# The shell reads the flags, as that of a Makefile does.
pkg_config() {
    PKG_CONFIG_PATH=$(echo "$PWD/$1"/lib*/pkgconfig "$PWD/$1"/lib/*/pkgconfig | tr ' ' :)
    export PKG_CONFIG_PATH
    eval "$CC user.c $(pkg-config --cflags --libs auvid) -o user"
    ./user | grep -q "^0 $2\$"
}

# README's commands. They choose the prefix only when the library is installed.
other_prefix() {
    grep '^    cmake ' "$ROOT/README.md" | sed "s|-S lib|-S $ROOT/lib|; s|build/lib|other|g
        s|~/auvid|$PWD/moved|" >install.sh
    cat install.sh
    bash -e install.sh
    pkg_config moved 4
}

# Definitions of the project around the library, one with quotes; an absolute libdir.
around() {
    echo '#define AUVID_MAX_SETS 4' >my_sizes.h
    mkdir -p sized
    cat >sized/CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.16)
project(user C)
add_subdirectory($ROOT/lib auvid)
target_compile_definitions(auvid PUBLIC AUVID_REAL_DOUBLE AUVID_USER_CONFIG="my_sizes.h")
target_include_directories(auvid PRIVATE $PWD)
END
    cmake -S sized -B sized/build -DCMAKE_INSTALL_PREFIX="$PWD/sized_usr" \
        -DCMAKE_INSTALL_LIBDIR="$PWD/far/lib"
    cmake --build sized/build
    cmake --install sized/build
    CPATH=$PWD pkg_config far 8
}

# The defaults: default sizes, float, an optimized library.
installed_plain() {
    cmake -S "$ROOT/lib" -B plain -DCMAKE_INSTALL_PREFIX="$PWD/plain_usr" &&
        cmake --build plain --verbose >plain.log && cmake --install plain &&
        grep -q -- ' -O[23] .*auvid_identifier\.c' plain.log
}

# A chosen build type is kept, and so is that of a project that adds the library.
build_type() {
    cmake -S "$ROOT/lib" -B debug -DCMAKE_BUILD_TYPE=Debug &&
        grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Debug$' debug/CMakeCache.txt &&
        grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=$' sub/build/CMakeCache.txt
}

for flags in -O0 '-O3 -Wall -Wextra -funsigned-char -fshort-enums' '-Os -std=gnu17 -flto' \
    '-O2 -std=c2x -march=native'; do
    # shellcheck disable=SC2086
    check "one wildcard, one include path, $flags" compiles $flags
done
check "called from C++" cplusplus
check "CMake: add_subdirectory, other sizes" subdirectory
check "CMake: install, find_package, double precision" installed
check "pkg-config: the same" pkg_config usr 8
check "CMake: install without a choice is optimized" installed_plain
check "pkg-config: install without definitions" pkg_config plain_usr 4
check "README's commands install the library; pkg-config finds it" other_prefix
check "pkg-config: an absolute libdir; target_compile_definitions, with quotes" around
check "CMake: another build type, and that of an enclosing project, are kept" build_type
exit "$failed"
