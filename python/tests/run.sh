#!/bin/sh
# pytest over the package in a build folder: run.sh BUILD [options of pytest]. Exit 77, which ctest shows as Skipped, where something is not installed.
build=$1
shift
python=${PYTHON:-/usr/bin/python3}
skip() { echo "skipped: $*"; exit 77; }
command -v "$python" >/dev/null || skip "$python is not installed"
ls "$build"/python/seldinger/_engine*.so >/dev/null 2>&1 || skip "the extension is not built: configure with -DSELDINGER_PYTHON=ON (./dev python), or pip install ."
for package in numpy pytest; do
    "$python" -c "import $package" 2>/dev/null || skip "python3-$package is not installed: apt-get install python3-$package"
done
export PYTHONPATH="$build/python${PYTHONPATH:+:$PYTHONPATH}"
[ -x "$build/seldinger" ] && export SELDINGER_COMMAND="$build/seldinger"
cd "$(dirname "$0")/../.." && exec "$python" -m pytest -q -rs -p no:cacheprovider python/tests "$@"
