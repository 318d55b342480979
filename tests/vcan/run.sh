#!/usr/bin/env bash
# Run a command where there is CAN: as root, alone on its network, with vcan0 up.
#
# usage: tests/vcan/run.sh COMMAND [ARGUMENT...]
#        tests/vcan/run.sh --native        exit 0 when this machine needs no virtual one
#        tests/vcan/run.sh --missing       exit 0, and say why, when nothing can be run
# Where the kernel has vcan, vxcan and netem, and we may use them, the command runs in a network
# namespace of its own. Else in a virtual machine (QEMU without KVM, a kernel from kernel.sh): it
# sees this machine's files and programs under the same names, what it writes is thrown away, except
# below build/. Standard output, error and exit status come back; the current directory is kept; of
# the environment only PATH, HOME, CI, AUVID* and VCAN*.
# The command finds VCAN_INSIDE set, to `namespace` or `machine`.
#   VCAN_TIMEOUT=600      seconds until everything is stopped (status 124)
#   VCAN_VIRTUAL=1        the virtual machine even where it is not needed
#   VCAN_CONTROLLERS=0    so many emulated SJA1000 controllers, can0..., on one bus and left down;
#                         there are none outside the virtual machine
#   VCAN_CLOCK=instructions   the virtual machine's clock goes by instructions, 4 ns each: what is
#                         timed there does not depend on how busy this machine is
#   VCAN_VERBOSE=1        show the virtual machine's console
# Exit status: the command's; 124 on time-out; 125 when the machine itself failed.
set -euo pipefail

die() {
    echo "vcan: $*" >&2
    exit 125
}

top=$(cd "$(dirname "$0")/../.." && pwd -P)
vm=$top/third_party/vm
limit=${VCAN_TIMEOUT:-600}
controllers=${VCAN_CONTROLLERS:-0}

# A namespace of our own leaves the machine's interfaces alone, and its tests leave nothing behind.
# /sys is of the namespace it was mounted in.
in_namespace() {
    if [ "$(id -u)" = 0 ]; then
        unshare --net --mount "$@"
    else
        unshare --map-root-user --net --mount "$@"
    fi
}

# Modules are loaded outside: nobody may in a namespace.
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
    # The inner shell is replaced by the command: its status is the command's.
    # shellcheck disable=SC2016
    in_namespace timeout --kill-after=5 "$limit" sh -c \
        'mount -t sysfs sys /sys && ip link set lo up && ip link add vcan0 type vcan &&
            ip link set vcan0 up || exit 125
        exec "$@"' vcan "$@"
}

# What the machine is to run, as a script it reads: /init calls it.
write_command() {
    local name
    for name in PATH HOME CI ${!AUVID@} ${!VCAN@}; do
        [ -z "${!name+x}" ] || printf 'export %s=%q\n' "$name" "${!name}"
    done
    printf 'cd %q || exit 125\n' "$PWD"
    printf 'exec'
    printf ' %q' "$@"
    echo
}

# Says what the virtual machine lacks, if anything.
lacking() {
    local tool
    for tool in qemu-system-x86_64 timeout mkfifo; do
        command -v "$tool" >/dev/null || {
            echo "no $tool here, and this machine's kernel has no vcan: run 'make setup', or" \
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
    # TCG: /dev/kvm may be there and still not work, and is not needed. The rest saves seconds.
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
    # A reader that QEMU never opened its pipe for would wait for ever.
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
