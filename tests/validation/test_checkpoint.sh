#!/usr/bin/env bash
# Every member of every struct of the identifier is in the checkpoint, in float and in double.
cd "$(dirname "$0")/../.." || exit 1
for library in build/validation/float.so build/validation/double.so; do
    third_party/validation/bin/python tests/validation/checkpoint.py "$library" ||
        echo "not ok - $library"
done
