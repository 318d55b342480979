#!/usr/bin/env bash
# The codec against cantools, autosar-e2e and crccheck: see oracle.py.
cd "$(dirname "$0")/../.." || exit 1
exec third_party/venv/bin/python tests/can/oracle.py build/can/float.so build/can/double.so
