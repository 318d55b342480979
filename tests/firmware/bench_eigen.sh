#!/usr/bin/env bash
# Compares the navigation step on a Cortex-M4F with two filters in Eigen, plain and in blocks by
# hand: instructions of a prediction and updates by a DVL and a depth. Run by `make bench-eigen`.
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD work=build/firmware/eigen
compile=$(port/cortex_m/board.sh m4f compile)
link=$(port/cortex_m/board.sh m4f link)
flags="-ffunction-sections -Ilib/include -Iport/cortex_m"
for level in O2 O3; do
    here=$work/$level
    rm -rf "$here"
    mkdir -p "$here"
    for source in lib/src/*/*.c port/cortex_m/*.c; do
        $compile -$level -std=c11 -ffp-contract=off $flags -c -o "$here/$(basename "$source").o" \
            "$source"
    done
    # Eigen with the compiler's default contraction: fused if the core supports it.
    ${compile/gcc/g++} -$level -std=c++17 -fno-exceptions -fno-rtti -DEIGEN_NO_DEBUG \
        -DEIGEN_NO_MALLOC $flags -isystem "$EIGEN_DIR" -c -o "$here/eigen.o" \
        tests/firmware/bench_eigen.cpp
    ${link/gcc/g++} --specs=rdimon.specs -o "$here/eigen.elf" "$here"/*.o -lm
    (cd "$here" && "$top/tests/firmware/count.sh" m4f ./eigen.elf)
    awk -v level=$level '
        { sub(/_f32$/, "", $1); mean[$1] = $3 / $2 }
        function step(name, imu, dvl, depth) {
            printf "%-3s %-28s %6.0f = %5.0f + %5.0f + %4.0f   %.2f of auvid\n", level, name,
                imu + dvl + depth, imu, dvl, depth, (imu + dvl + depth) / ours
        }
        END {
            print "instructions, -" level ":             step =   imu +   dvl + depth"
            ours = mean["auvid_nav_imu"] + mean["auvid_nav_dvl"] + mean["auvid_nav_depth"]
            step("auvid", mean["auvid_nav_imu"], mean["auvid_nav_dvl"], mean["auvid_nav_depth"])
            step("Eigen, inverse()", mean["natural_imu"], mean["natural_dvl"],
                mean["natural_depth"])
            step("Eigen, ldlt()", mean["natural_imu"], mean["natural_dvl_ldlt"],
                mean["natural_depth"])
            step("Eigen in blocks, by hand", mean["blocks_imu"], mean["blocks_dvl"],
                mean["blocks_depth"])
        }' "$here/count"
done
