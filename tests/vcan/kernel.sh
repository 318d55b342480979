#!/usr/bin/env bash
# Makes the kernel and the initial file system of run.sh's virtual machine, in third_party/vm.
#
# usage: tests/vcan/kernel.sh
# The kernel is Debian's package linux-image-amd64. It is fetched and unpacked, never installed,
# with only the modules named here. It is made again if this file or init is newer.
set -euo pipefail
cd "$(dirname "$0")"
vm=$(cd ../.. && pwd -P)/third_party/vm
[ ! "$vm/initrd" -nt kernel.sh ] || [ ! "$vm/initrd" -nt init ] || exit 0

# Each module after its dependencies.
modules="virtio_ring virtio virtio_pci_modern_dev virtio_pci_legacy_dev virtio_pci virtio_console
    netfs fscache 9pnet 9pnet_virtio 9p overlay sch_netem can can-raw can-bcm can-gw can-dev vcan
    vxcan slcan sja1000 kvaser_pci"

die() {
    echo "vcan: $*" >&2
    exit 1
}

busybox=$(command -v busybox) || die "no busybox here; install busybox-static"
! ldd "$busybox" >/dev/null 2>&1 || die "$busybox is not static; install busybox-static"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/deb" "$work/kernel" "$work/vm" "$work/root"

package=$(apt-cache depends linux-image-amd64 2>/dev/null |
    sed -n 's/.*Depends: \(linux-image-[0-9].*-amd64\)$/\1/p' | head -n 1)
[ -n "$package" ] || die "apt knows no linux-image-amd64 (apt-get update?)"
echo "vcan: fetching $package for the virtual machine"
(cd "$work/deb" && apt-get -qq -o "APT::Sandbox::User=$(id -un)" download "$package") ||
    die "could not fetch $package (apt-get update?)"

wanted=()
for module in $modules; do
    wanted+=("*/$module.ko" "*/$module.ko.xz")
done
# tar reports an error for a pattern without a match.
dpkg-deb --fsys-tarfile "$work"/deb/*.deb | tar x -C "$work/kernel" --wildcards \
    './boot/vmlinuz-*' "${wanted[@]}" 2>/dev/null || true

mkdir -p "$work/root"/{bin,modules,proc,sys,dev,control,lower,upper,machine}
for module in $modules; do
    file=$(find "$work/kernel" -name "$module.ko" -o -name "$module.ko.xz" | head -n 1)
    case $file in
    *.xz) xz -dc "$file" >"$work/root/modules/$module.ko" ;;
    ?*) cp "$file" "$work/root/modules/" ;;
    *) die "$package has no module $module" ;;
    esac
done
echo $modules >"$work/root/modules/order"
cp "$busybox" "$work/root/bin/busybox"
install -m 755 init "$work/root/init"
(cd "$work/root" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/vm/initrd"

# Unpacked here and started as an ELF file: in the machine that would take seconds.
image=$(echo "$work"/kernel/boot/vmlinuz-*)
[ -f "$image" ] || die "$package has no kernel"
packed=$(LC_ALL=C grep -abo "$(printf '\3757zXZ')" "$image" | head -n 1 | cut -d : -f 1)
[ -z "$packed" ] || tail -c "+$((packed + 1))" "$image" | xz -dc >"$work/vm/vmlinux" 2>/dev/null ||
    true
[ "$(head -c 4 "$work/vm/vmlinux" 2>/dev/null | tail -c 3)" = ELF ] ||
    cp "$image" "$work/vm/vmlinux"
rm -rf "$vm"
mkdir -p "$(dirname "$vm")"
mv "$work/vm" "$vm"
