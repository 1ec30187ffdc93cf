#!/usr/bin/env bash
# Fuzzes one target for so many seconds: fuzz/run.sh drawings 600. Without cargo-fuzz and on stable Rust: the compiler's own passes count
# branches, as cargo-fuzz has them. Inputs that were new are kept in fuzz/corpus, those that broke something in fuzz/found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
target=$1 seconds=$2
export RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
-Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares"
triple=$(rustc -vV | sed -n 's/^host: //p')
cargo build --release --target "$triple" --bin "$target"
mkdir -p "corpus/$target" found
exec "target/$triple/release/$target" "corpus/$target" "seeds/$target" -artifact_prefix=found/ -max_total_time="$seconds" -rss_limit_mb=2048 -timeout=10 -max_len=20000 -print_final_stats=1
