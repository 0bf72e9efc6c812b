import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";

const SOURCES = new URL("../src/", import.meta.url);
const LONGEST = 120; // characters

test(`no line of the sources is longer than ${LONGEST} characters`, () => {
  const files = readdirSync(SOURCES, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  assert.ok(files.length > 0);
  const long = files.flatMap(({ parentPath, name }) =>
    readFileSync(`${parentPath}/${name}`, "utf8").split("\n").flatMap((line, i) =>
      ([...line].length > LONGEST ? [`${name}:${i + 1}`] : [])));
  assert.deepEqual(long, []);
});
