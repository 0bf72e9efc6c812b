// A layout keeps its colour wherever it stands; the baseline is always grey.
import { baselineOf } from "../questions.js";

const OTHERS = 5; // colours of layouts that are not the baseline

/** @param {import("../state/document.js").Document} document @param {string} layout */
export function layoutColour(document, layout) {
  const baseline = baselineOf(document).layout;
  const others = Object.keys(document.study.layouts ?? {}).filter((each) => each !== baseline);
  return layout === baseline ? "var(--s1)" : `var(--s${2 + (Math.max(0, others.indexOf(layout)) % OTHERS)})`;
}
