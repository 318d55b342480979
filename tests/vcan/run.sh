#!/usr/bin/env bash
# Runs a command where there is CAN: as root, in a separate network, with vcan0 up.
#
# usage: tests/vcan/run.sh COMMAND [ARGUMENT...]
#        tests/vcan/run.sh --native        exit 0 if this machine needs no virtual machine
#        tests/vcan/run.sh --missing       exit 0 and print the reason if nothing can be run
# If the kernel has vcan, vxcan and netem, and they may be used, the command runs in a separate
# network namespace. Otherwise it runs in a virtual machine (QEMU without KVM, a kernel from
# kernel.sh). There it sees this machine's files and programs under the same names, but its changes
# are discarded except below build/. Standard output, error and exit status are passed on, and the
# current directory is the same. Of the environment it gets only PATH, HOME, CI, AUVID*, VCAN* and
# PYTHON*. VCAN_INSIDE is set to `namespace` or `machine`.
#   VCAN_TIMEOUT=600      time limit in seconds (status 124)
#   VCAN_VIRTUAL=1        the virtual machine even if it is not needed
#   VCAN_CONTROLLERS=0    number of emulated SJA1000 controllers, can0..., on one bus and down;
#                         only in the virtual machine
#   VCAN_CLOCK=instructions   the virtual machine's clock counts instructions, 4 ns each, so times
#                         there do not depend on the load of this machine
#   VCAN_VERBOSE=1        show the virtual machine's console
# Exit status: that of the command; 124 on time-out; 125 if the machine itself failed.
set -euo pipefail

die() {
    echo "vcan: $*" >&2
    exit 125
}

top=$(cd "$(dirname "$0")/../.." && pwd -P)
vm=$top/third_party/vm
limit=${VCAN_TIMEOUT:-600}
controllers=${VCAN_CONTROLLERS:-0}

# A separate namespace does not affect the machine's interfaces, and its tests leave nothing behind.
# /sys belongs to the namespace in which it was mounted.
in_namespace() {
    if [ "$(id -u)" = 0 ]; then
        unshare --net --mount "$@"
    else
        unshare --map-root-user --net --mount "$@"
    fi
}

# Modules are loaded outside: a namespace may not.
is_native() {
    local module
    [ -z "${VCAN_VIRTUAL:-}" ] && [ "$controllers" = 0 ] || return 1
    command -v ip >/dev/null && command -v tc >/dev/null || return 1
    if [ "$(id -u)" = 0 ] && command -v modprobe >/dev/null; then
        for module in can-raw vcan vxcan sch_netem; do
            modprobe -q "$module" || true
        done
    fi
    in_namespace sh -c 'ip link add vx0 type vxcan peer name vx1 && ip link add v0 type vcan &&
        ip link set vx0 up && tc qdisc add dev vx0 root netem loss 1%' >/dev/null 2>&1
}

run_native() {
    # The command replaces the inner shell, so its status is that of the command.
    # shellcheck disable=SC2016
    in_namespace timeout --kill-after=5 "$limit" sh -c \
        'mount -t sysfs sys /sys && ip link set lo up && ip link add vcan0 type vcan &&
            ip link set vcan0 up || exit 125
        exec "$@"' vcan "$@"
}

# The script that /init runs in the machine.
write_command() {
    local name
    for name in PATH HOME CI ${!AUVID@} ${!VCAN@} ${!PYTHON@}; do
        [ -z "${!name+x}" ] || printf 'export %s=%q\n' "$name" "${!name}"
    done
    printf 'cd %q || exit 125\n' "$PWD"
    printf 'exec'
    printf ' %q' "$@"
    echo
}

# Prints what the virtual machine lacks, if anything.
lacking() {
    local tool
    for tool in qemu-system-x86_64 timeout mkfifo; do
        command -v "$tool" >/dev/null || {
            echo "$tool is missing, and this machine's kernel has no vcan: run 'make setup', or" \
                "install qemu-system-x86"
            return
        }
    done
    [ -s "$vm/initrd" ] || echo "no kernel in third_party/vm: run 'make setup'"
}

run_virtual() {
    local work share arguments=() pace=() readers i status=0 lacks
    lacks=$(lacking)
    [ -z "$lacks" ] || die "$lacks"
    mkdir -p "$top/build"
    work=$(mktemp -d)
    # shellcheck disable=SC2064
    trap "rm -rf '$work'" EXIT
    write_command "$@" >"$work/command"
    echo "$top/build" >"$work/writable"
    mkfifo "$work/out" "$work/err"
    cat "$work/out" &
    readers=($!)
    cat "$work/err" >&2 &
    readers+=($!)

    share=security_model=none,multidevs=remap
    arguments+=(-fsdev "local,id=root,path=/,readonly=on,$share"
        -device virtio-9p-pci,fsdev=root,mount_tag=root
        -fsdev "local,id=control,path=$work,$share"
        -device virtio-9p-pci,fsdev=control,mount_tag=control
        -fsdev "local,id=build,path=${top//,/,,}/build,$share"
        -device virtio-9p-pci,fsdev=build,mount_tag=build)
    [ "$controllers" = 0 ] || arguments+=(-object can-bus,id=bus)
    for ((i = 0; i < controllers; i++)); do
        arguments+=(-device kvaser_pci,canbus=bus)
    done
    [ "${VCAN_CLOCK:-}" != instructions ] || pace=(-icount shift=2 -rtc clock=vm)
    # TCG: /dev/kvm may exist and still not work, and is not needed. The rest saves seconds.
    timeout --kill-after=5 "$limit" qemu-system-x86_64 -M q35 -accel tcg "${pace[@]}" -cpu max \
        -smp 1 -m 1G -nodefaults -no-user-config -display none -no-reboot \
        -serial "file:$work/console" \
        -kernel "$vm/vmlinux" -initrd "$vm/initrd" \
        -append "console=ttyS0 quiet panic=-1 nokaslr mitigations=off no_timer_check \
random.trust_cpu=on cryptomgr.notests audit=0 apparmor=0 8250.nr_uarts=1" \
        -device virtio-serial-pci \
        -chardev "file,id=out,path=$work/out" -device virtserialport,chardev=out,nr=1 \
        -chardev "file,id=err,path=$work/err" -device virtserialport,chardev=err,nr=2 \
        "${arguments[@]}" </dev/null >"$work/qemu" 2>&1 || status=$?
    # A reader whose pipe QEMU never opened would wait for ever.
    [ "$status" = 0 ] || { sleep 0.3 && kill "${readers[@]}" 2>/dev/null; } || true
    wait "${readers[@]}" || true
    [ -z "${VCAN_VERBOSE:-}" ] || cat "$work/console" >&2
    if [ -s "$work/status" ]; then
        exit "$(cat "$work/status")"
    fi
    case $status in
    124 | 137)
        echo "vcan: stopped after $limit s (VCAN_TIMEOUT)" >&2
        exit 124
        ;;
    esac
    cat "$work/qemu" "$work/console" >&2 || true
    die "the virtual machine gave no result (QEMU's exit status $status)"
}

[ $# -gt 0 ] || die "usage: tests/vcan/run.sh COMMAND [ARGUMENT...]"
if [ "$*" = --native ]; then
    is_native
elif [ "$*" = --missing ]; then
    ! is_native && lacking | grep .
elif is_native; then
    export VCAN_INSIDE=namespace
    run_native "$@"
else
    export VCAN_INSIDE=machine
    run_virtual "$@"
fi
