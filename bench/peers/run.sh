#!/usr/bin/env bash
# Installs the peers below target/peers, runs them with this project on the timing scene, and prints the table.
# usage: bench/peers/run.sh [ROUNDS]; STICKSLIP_DATA names the recorded data. Needs cargo, gcc, python3 with venv; for Siconos, Debian's
# apt-get and the right to install libsiconos-numerics7 (left out, with a word, where that fails).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root=$(cd ../.. && pwd)
out=${PEERS_DIR:-$root/target/peers}
data=${STICKSLIP_DATA:-$root/../shared/data}/bench-scene
mkdir -p "$out"

[ -d "$out/venv" ] || python3 -m venv "$out/venv"
"$out/venv/bin/pip" install -q 'mujoco==4.0.0'
mujoco=$("$out/venv/bin/python" -c 'import mujoco, os; print(os.path.dirname(mujoco.__file__))')
gcc -O2 -I"$mujoco/include" mujoco/peer.c -o "$out/mujoco-peer" "$mujoco/libmujoco.so.4.0.0" -Wl,-rpath,"$mujoco" -lm

CARGO_TARGET_DIR="$out/rapier" cargo build -q --release --manifest-path rapier/Cargo.toml
cargo build -q --profile dist -p stickslip-bench --manifest-path "$root/Cargo.toml"
own=${CARGO_TARGET_DIR:-$root/target}/dist/timing-scene

siconos=()
# the headers are unpacked only: the -dev package pulls in more than a solver needs
if { ldconfig -p | grep -q libsiconos_numerics.so.7 || apt-get install -y -qq --no-install-recommends libsiconos-numerics7; } &&
    { [ -d "$out/siconos" ] || (cd "$out" && apt-get download -qq libsiconos-numerics-dev && dpkg -x libsiconos-numerics-dev_*.deb siconos); } &&
    gcc -O2 -I"$out/siconos/usr/include/siconos" -I"$out/siconos/usr/include/siconos/numerics" siconos/peer.c -o "$out/siconos-peer" \
        -l:libsiconos_numerics.so.7 -lm; then
    siconos=("Siconos 4.4 NSGS 1e-8=$out/siconos-peer 1e-8" "Siconos 4.4 NSGS 1e-4=$out/siconos-peer 1e-4")
else
    echo "Siconos left out: libsiconos-numerics7 or its headers could not be had" >&2
fi

export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1
python3 compare.py "$data" "${1:-5}" "stickslip=$own" "stickslip, AVX2=$own avx2" \
    "MuJoCo 4.0.0, 1 substep=$out/mujoco-peer 1" "MuJoCo, 4 substeps=$out/mujoco-peer 4" \
    "rapier2d-f64, hand-coded feet, 1 substep=$out/rapier/release/peer-rapier 1" "rapier2d-f64, 16 substeps=$out/rapier/release/peer-rapier 16" \
    "${siconos[@]}"
