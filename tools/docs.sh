#!/usr/bin/env bash
# The documents as static HTML: tools/docs.sh BUILD leaves BUILD/docs/index.html. Fails where a link or an image leads nowhere.
set -euo pipefail
build=$1
cd "$(dirname "$0")/.."
work=$build/docs-work
rm -rf "$work" "$build/docs"
mkdir -p "$work/pages"
# Pages, pictures, and the sources that pages link to.
git ls-files -z -- '*.md' 'docs/images' 'LICENSE' 'examples' '*.yaml' 'tests/viewer/reference' | xargs -0 cp --parents -t "$work/pages"
cp docs/site.yml "$work/mkdocs.yml"
cp -r docs/theme "$work/theme"
rm -rf "$work/pages/docs/theme"
mkdocs --quiet build --config-file "$work/mkdocs.yml"
rm -rf "$work"
tools/check-site.py "$build/docs"
