// What makes an answer doubtful stands before it: an answer is no better than the worst of what it is made of.
import { unchosenIn } from "../library.js";
import { html } from "./html.js";

/** Something an answer is made of, with its status: a word, or a word, a colon and a message.
 * @typedef {{of: string, status: string | null | undefined, message?: string}} Member */

/** Whether a status tells of a number that can be relied on. @param {string | null | undefined} status */
export const isOk = (status) => status === null || status === undefined || status === "" || kindOf(status) === "ok";

/** @param {string} status */
const kindOf = (status) => status.split(": ")[0];

/** What is to be doubted, each reason once, with all that it is about. @param {Member[]} members @returns {string[]} */
export function doubtsIn(members) {
  /** @type {Map<string, string[]>} */
  const about = new Map();
  for (const { of, status, message } of members) {
    if (isOk(status)) continue;
    const [kind, ...rest] = String(status).split(": ");
    const why = [kind, message || rest.join(": ")].filter(Boolean).join(": ");
    about.set(why, [...new Set([...(about.get(why) ?? []), of])]);
  }
  return [...about].map(([why, several]) => `${several.join(", ")}: ${why}`);
}

/** The sentence that a text about doubtful numbers begins with; empty where there is no doubt.
 * @param {Member[]} members */
export const doubted = (members) => doubtsIn(members).map((doubt) => `Unreliable: ${doubt}. `.replace(/\.\. $/,
  ". ")).join("");

/** @param {{members: Member[]}} props */
export function Doubts({ members }) {
  const doubts = doubtsIn(members);
  return doubts.length === 0 ? null : html`<div class="doubts problem" role="alert">
    ${doubts.map((doubt) => html`<p key=${doubt}><b>Unreliable.</b> ${doubt}</p>`)}</div>`;
}

/** What is no answer, since nobody has chosen it; `unchosen` where the state does not tell it of a design.
 * @param {{state: import("../state/store.js").State, designs: {name: string, layout: string,
 * values: {[element: string]: string}, unchosen?: string[]}[]}} props */
export function Unchosen({ state, designs }) {
  const found = designs.map((design) => ({ name: design.name, unchosen: design.unchosen ?? unchosenIn(state, design) }))
    .filter(({ unchosen }) => unchosen.length > 0);
  const listed = found.map(({ name, unchosen }) => `${unchosen.join(", ")} of ${name}`).join("; ");
  return found.length === 0
    ? null
    : html`<p class="unchosen" role="status">Not chosen yet: ${listed}. They are in the middle of their bounds: press
        Find best, or choose them.</p>`;
}
