// Which colour is whose: a layout has the same one everywhere, and the baseline is grey and dashed.

import { baselineOf } from "../questions.js";

/** @import { Document } from "../state/document.js" */

const OTHERS = ["s2", "s3", "s4", "s5", "s6"];
const NUMBERED = ["s3", "s2", "s4"];

/** Colours of layouts by their names, as tokens of the style. @param {string[]} layouts @param {string} baseline
 * @returns {{[layout: string]: string}} */
export function coloursOf(layouts, baseline) {
  const others = layouts.filter((layout) => layout !== baseline);
  return Object.fromEntries([[baseline, "s1"], ...others.map((layout, i) => [layout, OTHERS[i % OTHERS.length]])]);
}

/** Those of the layouts of a document. @param {Document} document */
export const layoutColours = (document) =>
  coloursOf(Object.keys(document.study.layouts ?? {}), baselineOf(document).layout);

/** The colours of several outputs of one design. @param {number} number */
export const numberedColour = (number) => NUMBERED[number % NUMBERED.length];

/** The colour of a layout, for styles. @param {Document} document @param {string} layout */
export const layoutColour = (document, layout) => `var(--${layoutColours(document)[layout] ?? "s3"})`;
