#!/usr/bin/env bash
# The properties of a board in boards.txt, as commands.
#
# usage: board.sh list               print the names of all boards
#        board.sh short              without those that tests leave to the long form: m3_20k has
#                                    the core of m3, and m7's differs from m4f's least
#        board.sh BOARD tools        print the prefix of its compiler
#        board.sh BOARD compile      print the compiler and its flags
#        board.sh BOARD link         the same with the linker script and the memory of the board
#        board.sh BOARD run IMAGE [QEMU OPTION...]
#                                    run IMAGE in QEMU; it opens files in the current directory.
#                                    Exit status: that of the image
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")

die() {
    echo "board.sh: $*" >&2
    exit 2
}

if [ "${1:-}" = list ]; then
    awk '/^[a-z]/ { print $1 }' "$here/boards.txt"
    exit
elif [ "${1:-}" = short ]; then
    "$0" list | grep -vx -e m3 -e m7
    exit
fi
[ $# -ge 2 ] || die "usage: board.sh list | short | BOARD tools|compile|link|run"
read -r board tools machine flash_at flash ram_at ram flags < <(
    awk -v board="$1" '$1 == board' "$here/boards.txt"
) || die "no board '$1' in boards.txt; 'board.sh list' lists them"
case $2 in
tools) echo "$tools" ;;
compile) echo "${tools}gcc $flags" ;;
link)
    echo "${tools}gcc $flags -nostartfiles -T $here/firmware.ld" \
        "-Wl,--gc-sections,--fatal-warnings,--no-warn-rwx-segments" \
        "-Wl,--defsym=FLASH_ORIGIN=$flash_at,--defsym=FLASH_LENGTH=$flash" \
        "-Wl,--defsym=RAM_ORIGIN=$ram_at,--defsym=RAM_LENGTH=$ram"
    ;;
run)
    [ $# -ge 3 ] || die "usage: board.sh $board run IMAGE"
    case $machine in
    virt) qemu=(qemu-system-riscv32 -bios none) ;;
    *) qemu=(qemu-system-arm) ;;
    esac
    exec "${qemu[@]}" -M "$machine" -display none -monitor none -serial none \
        -chardev stdio,id=host -semihosting-config enable=on,target=native,chardev=host \
        -kernel "${@:3}" </dev/null
    ;;
*) die "unknown command '$2': tools, compile, link or run" ;;
esac
