#!/usr/bin/env bash
# The golden vectors of short runs on an emulated microcontroller equal those recorded on the host.
set -euo pipefail
cd "$(dirname "$0")/../.."
timeout 600 port/cortex_m/board.sh m4f run build/firmware/m4f-O2/tests/golden/test_core.elf
