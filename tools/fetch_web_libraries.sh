#!/bin/sh
# Fetches the libraries of the web pages again: pinned versions from npm with their integrity, minified by a pinned esbuild.
# The results must have the check sums of cnc_ptp/web/static/vendor/SHA256SUMS and test/web_browser/vendor/SHA256SUMS;
# `sh tools/fetch_web_libraries.sh --new` writes these (after a change of a version).
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
vendor=$root/cnc_ptp/web/static/vendor
tests=$root/test/web_browser/vendor
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat > package.json <<'JSON'
{"private": true, "dependencies": {"three": "0.187.0", "uplot": "1.6.32", "axe-core": "4.14.1", "esbuild": "0.28.2"}}
JSON
npm install --no-audit --no-fund --silent
check() { # package, integrity
  have=$(node -p "require('./package-lock.json').packages['node_modules/$1'].integrity")
  [ "$have" = "$2" ] || { echo "$1: integrity $have is not $2" >&2; exit 1; }
}
check three sha512-Qiu7R+Cmh8CstZsY1uJOSWnVlfo7ZtNLV7mF8Jltk3LB3AtDu9cRZlcnRKkAk8Y4z6KKw35z7Y7Urd7jWY8etA==
check uplot sha512-KIMVnG68zvu5XXUbC4LQEPnhwOxBuLyW1AHtpm6IKTXImkbLgkMy+jabjLgSLMasNuGGzQm/ep3tOkyTxpiQIw==
check axe-core sha512-FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ==
check esbuild sha512-HKVLS8dvII+xoKW9kmqxbRKrnWEXfJJr/FZhhJmiqIB0e053QNYFqOBouTMO/k5sID4MvCiUCvv8b9M4h32wIA==
mkdir -p "$vendor/licences" "$tests"
cp "$vendor/three_entry.js" entry.js
npx esbuild entry.js --bundle --minify --format=esm --legal-comments=inline --outfile="$vendor/three.js" --log-level=warning
npx esbuild node_modules/uplot/dist/uPlot.esm.js --minify --format=esm --legal-comments=inline --outfile="$vendor/uplot.js" --log-level=warning
cp node_modules/uplot/dist/uPlot.min.css "$vendor/uplot.css"
cp node_modules/three/LICENSE "$vendor/licences/three.txt"
cp node_modules/uplot/LICENSE "$vendor/licences/uplot.txt"
cp node_modules/axe-core/axe.min.js "$tests/axe.js"
cp node_modules/axe-core/LICENSE "$tests/axe_licence.txt"
if [ "${1:-}" = --new ]; then
  (cd "$vendor" && sha256sum three.js uplot.js uplot.css > SHA256SUMS)
  (cd "$tests" && sha256sum axe.js > SHA256SUMS)
fi
(cd "$vendor" && sha256sum -c SHA256SUMS)
(cd "$tests" && sha256sum -c SHA256SUMS)
