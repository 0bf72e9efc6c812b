#!/usr/bin/env bash
# The sources of the page: their types, their unit tests, and that what ships is what they give.
set -euo pipefail
cd "$(dirname "$0")"
npm ci --no-audit --no-fund
npx tsc --project jsconfig.json
node --test tests/*.test.js
built=$(mktemp -d)
trap 'rm -rf "$built"' EXIT
node build.mjs "$built"
if ! diff -rq "$built" ../src/inerter/app/web; then
  echo "src/inerter/app/web is not what web/ gives: run 'npm ci && npm run build' in web/, and commit what it writes" >&2
  exit 1
fi
bytes=$(cat ../src/inerter/app/web/* | wc -c)
if [ "$bytes" -gt 2000000 ]; then
  echo "the page that ships has $bytes bytes, more than two million" >&2
  exit 1
fi
