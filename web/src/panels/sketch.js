// A network, small and without names.
import { drawing, pathOf } from "../network/drawing.js";
import { partAt } from "../network/algebra.js";
import { kindNamed, kindOf } from "../library.js";
import { html, useMemo } from "../parts/html.js";

const [WIDTH, HEIGHT] = [48, 36];

/** @param {{drawing?: any[]} | null} kind */
export const symbolPath = (kind) => (kind?.drawing ? pathOf(kind.drawing, -1) : "M0 -20V-9M-8 -9H8V9H-8ZM0 9V20");

/** @param {import("../state/store.js").State} state @param {import("../network/algebra.js").Tree} tree
 * @param {import("../network/algebra.js").Path} path @param {string} name */
const kindAt = (state, tree, path, name) =>
  kindNamed(state, /** @type {any} */ (partAt(tree, path)).key) ?? kindOf(state, name);

/** Its elements are those of the study, or, where the library gave the tree, of the kinds that the tree says.
 * @param {{state: import("../state/store.js").State, tree: import("../network/algebra.js").Tree | null}} props */
export function Sketch({ state, tree }) {
  const plan = useMemo(() => tree && drawing(tree), [tree]);
  if (!tree || !plan) return html`<svg class="sketch" width=${WIDTH} height=${HEIGHT} aria-hidden="true"></svg>`;
  const [left, right] = [plan.left + 2, plan.right + 2];
  return html`<svg class="sketch" width=${WIDTH} height=${HEIGHT} aria-hidden="true"
    viewBox=${`${-left} -2 ${left + right} ${plan.height + 4}`}>
    <path d=${pathOf(plan.lines)} />
    ${plan.placed.map(({ name, path, x, y }) => html`<path key=${path.join()} transform=${`translate(${x} ${y})`}
      d=${symbolPath(kindAt(state, tree, path, name))} />`)}</svg>`;
}
