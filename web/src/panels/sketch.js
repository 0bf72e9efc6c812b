// A network, small and without names.
import { drawing, pathOf } from "../network/drawing.js";
import { partAt } from "../network/algebra.js";
import { kindNamed, kindOf, treeOf } from "../library.js";
import { strutsOf, textOf } from "../state/document.js";
import { html, useMemo } from "../parts/html.js";

/** @import { State } from "../state/store.js" */

const [WIDTH, HEIGHT] = [48, 36];
const SMALL = 30; // [px] wide, where several stand beside each other

/** A network, and the struts that have it; none where it is that of all.
 * @typedef {{struts: string[], tree: import("../network/algebra.js").Tree | null}} Sketched */

/** What is drawn of each layout: its networks, equal ones once; of several struts those by which layouts differ, if
 * each layout has such.
 * @param {State} state @returns {{[layout: string]: Sketched[]}} */
export function sketchesOf(state) {
  const { layouts = {} } = state.history.present.study;
  const struts = [...new Set(Object.values(layouts).flatMap(strutsOf))];
  /** @param {string} layout @param {string} strut */
  const treeIn = (layout, strut) => treeOf(state, textOf({ ...state.history.present, layout,
    strut: strutsOf(layouts[layout]).length > 0 ? strut : null }));
  /** @param {string} layout @param {string} strut */
  const shapeIn = (layout, strut) => shapeOf(state, treeIn(layout, strut));
  const names = Object.keys(layouts);
  const differ = struts.filter((strut) => new Set(names.map((layout) => shapeIn(layout, strut))).size > 1);
  const enough = names.every((layout) => strutsOf(layouts[layout]).some((strut) => differ.includes(strut)));
  return Object.fromEntries(names.map((layout) => {
    const own = strutsOf(layouts[layout]);
    if (own.length === 0) return [layout, [{ struts: [], tree: treeIn(layout, "") }]];
    const drawn = enough ? differ.filter((strut) => own.includes(strut)) : own;
    const shapes = [...new Set(drawn.map((strut) => shapeIn(layout, strut)))];
    return [layout, shapes.map((shape) => {
      const those = drawn.filter((strut) => shapeIn(layout, strut) === shape);
      return { struts: those, tree: treeIn(layout, those[0]) };
    })];
  }));
}

/** A network without the names of its elements. @param {State} state
 * @param {import("../network/algebra.js").Tree | null} tree @returns {string} */
function shapeOf(state, tree) {
  if (tree === null) return "";
  if (tree.kind === "element") return kindOf(state, tree.name)?.key ?? tree.name;
  return `${tree.kind}(${tree.parts.map((part) => shapeOf(state, part)).join()})`;
}

/** @param {{drawing?: any[]} | null} kind */
export const symbolPath = (kind) => (kind?.drawing ? pathOf(kind.drawing, -1) : "M0 -20V-9M-8 -9H8V9H-8ZM0 9V20");

/** @param {State} state @param {import("../network/algebra.js").Tree} tree
 * @param {import("../network/algebra.js").Path} path @param {string} name */
const kindAt = (state, tree, path, name) =>
  kindNamed(state, /** @type {any} */ (partAt(tree, path)).key) ?? kindOf(state, name);

/** Its elements are those of the study, or, where the library gave the tree, of the kinds that the tree says.
 * @param {{state: State, tree: import("../network/algebra.js").Tree | null, small?: boolean}} props */
export function Sketch({ state, tree, small = false }) {
  const width = small ? SMALL : WIDTH;
  const plan = useMemo(() => tree && drawing(tree), [tree]); // its elements would hold on to the page of that render
  if (!tree || !plan) return html`<svg class="sketch" width=${width} height=${HEIGHT} aria-hidden="true"></svg>`;
  const [left, right] = [plan.left + 2, plan.right + 2];
  return html`<svg class="sketch" width=${width} height=${HEIGHT} aria-hidden="true"
    viewBox=${`${-left} -2 ${left + right} ${plan.height + 4}`}>
    <path d=${pathOf(plan.lines)} />
    ${plan.placed.map(({ name, path, x, y }) => html`<path key=${path.join()} transform=${`translate(${x} ${y})`}
      d=${symbolPath(kindAt(state, tree, path, name))} />`)}</svg>`;
}
