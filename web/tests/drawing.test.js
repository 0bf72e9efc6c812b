import assert from "node:assert/strict";
import { test } from "node:test";
import { HALF_HEIGHT, HALF_WIDTH, drawing } from "../src/network/drawing.js";
import { read } from "./reading.js";

const MANY = Array.from({ length: 40 }, (_, i) => `e${i}`).join(" | ");
const NESTED = ["k | c - (ks | cs) - (b | f)", "(a | b) - (c | d - (e | f))"];
const BRIDGES = [
  "bridge(a, b, c, d, e)",
  "k | bridge(a, b - f - g, c | h, d, e)",
  "bridge(a, b, c - d - e - f, g, h) - (i | bridge(j, bridge(a, b, c, d, e), k, l, m | n))",
];
const TEXTS = ["k", "k | c", "k - c", "k | c - b", ...NESTED, ...BRIDGES, MANY];
const each = (check) => TEXTS.forEach((text) => check(drawing(read(text)), text));

test("no two symbols touch, and all are inside the drawing", () => {
  each(({ placed, left, right, height }, text) => {
    placed.forEach((one, i) => {
      assert.ok(one.x - HALF_WIDTH >= -left && one.x + HALF_WIDTH <= right, text);
      assert.ok(one.y - HALF_HEIGHT >= 0 && one.y + HALF_HEIGHT <= height, text);
      for (const other of placed.slice(i + 1)) {
        assert.ok(Math.abs(one.x - other.x) >= 2 * HALF_WIDTH || Math.abs(one.y - other.y) >= 2 * HALF_HEIGHT, text);
      }
    });
  });
});

test("every end of a line meets a symbol's lead, another line, or an end of the whole", () => {
  const between = (x, a, b) => x >= Math.min(a, b) && x <= Math.max(a, b);
  const on = ([x, y], [[x1, y1], [x2, y2]]) => between(x, x1, x2) && between(y, y1, y2);
  each(({ placed, lines, height }, text) => {
    for (const line of lines.filter(([[x1], [x2]]) => x1 === x2)) {
      for (const end of line) {
        const [x, y] = end;
        const meets = placed.some((one) => one.x === x && Math.abs(Math.abs(one.y - y) - HALF_HEIGHT) < 1e-9);
        const joins = lines.some((other) => other !== line && on(end, other));
        const closes = x === 0 && (y === 0 || y === height);
        assert.ok(meets || joins || closes, `${text}: ${end}`);
      }
    }
  });
});
