#!/usr/bin/env bash
# Builds the browser page as a folder of static files and serves it on this machine:
#
#   scripts/web.sh                      builds it into target/web, serves http://127.0.0.1:8765
#   scripts/web.sh out/page --port 80   another folder, another port
#   scripts/web.sh --no-serve           builds it only, for a host of static files
#
# Needs Rust by rustup, and python3 to serve. It adds the target wasm32-unknown-unknown where that is
# missing, and installs the version of wasm-bindgen that Cargo.lock names into target/tools where PATH
# has another. SKIAGRAPH_PROFILE=dev builds as the tests do: faster to build, larger, slower.
set -euo pipefail
cd "$(dirname "$0")/.."

most=3000000 # bytes that a visitor may have to load, gzipped
folder='' port=8765 serve=yes
while [ $# -gt 0 ]; do
    case $1 in
        --no-serve) serve='' ;;
        --port)
            port=${2:?"--port wants a number"}
            shift
            ;;
        -*)
            echo "web: unknown option $1; there are --no-serve and --port N" >&2
            exit 2
            ;;
        *) folder=$1 ;;
    esac
    shift
done
target=${CARGO_TARGET_DIR:-$PWD/target}
folder=${folder:-$target/web}
profile=${SKIAGRAPH_PROFILE:-web}
# Cargo calls the folder of the profile `dev` otherwise.
built=$target/wasm32-unknown-unknown/${profile/#dev/debug}/skiagraph_web.wasm

say() { printf 'web: %s\n' "$*" >&2; }

version=$(sed -n '/^name = "wasm-bindgen"$/{n;s/^version = "\(.*\)"$/\1/p}' Cargo.lock)
wasm_bindgen=''
for candidate in "$target/tools/bin/wasm-bindgen" "$(command -v wasm-bindgen || true)"; do
    if [ -n "$candidate" ] && [ "$("$candidate" --version 2>/dev/null)" = "wasm-bindgen $version" ]; then
        wasm_bindgen=$candidate
        break
    fi
done
if [ -z "$wasm_bindgen" ]; then
    say "there is no wasm-bindgen $version: installing it into $target/tools"
    # With --locked it did not install (2026-11-28).
    cargo install --quiet wasm-bindgen-cli --version "$version" --root "$target/tools" >&2
    wasm_bindgen=$target/tools/bin/wasm-bindgen
fi

if command -v rustup >/dev/null && ! rustup target list --installed | grep -qx wasm32-unknown-unknown; then
    say "adding Rust's target wasm32-unknown-unknown"
    rustup target add wasm32-unknown-unknown >&2
fi

cargo build -p skiagraph-web --lib --target wasm32-unknown-unknown --profile "$profile" --locked >&2
page=crates/web/page
rm -rf "$page/pkg"
"$wasm_bindgen" --target web --no-typescript --remove-name-section --remove-producers-section --out-dir "$page/pkg" "$built"

# Only these files: what else lies in the folder is left alone.
mkdir -p "$folder"
raw=0 gzipped=0
row='%-32s %10s bytes %10s gzipped\n'
while read -r file; do
    name=${file#"$page"/}
    mkdir -p "$(dirname "$folder/$name")"
    cp "$file" "$folder/$name"
    size=$(wc -c <"$file")
    small=$(gzip -9 -c "$file" | wc -c)
    raw=$((raw + size)) gzipped=$((gzipped + small))
    # shellcheck disable=SC2059 # one format for rows and sum
    printf "$row" "$name" "$size" "$small" >&2
done < <(find "$page" -type f | sort)
# shellcheck disable=SC2059
printf "$row" 'in all' "$raw" "$gzipped" >&2
if [ "$profile" = web ] && [ "$gzipped" -gt "$most" ]; then
    say "the page has $gzipped bytes gzipped, at most $most are meant to be"
    exit 1
fi
say "the page is in $folder"
[ -n "$serve" ] || exit 0

say "open http://127.0.0.1:$port in a browser with WebGPU; Ctrl+C ends"
exec python3 -m http.server "$port" --bind 127.0.0.1 --directory "$folder"
