// Answers, kept by what was asked: none of them is ever taken for the answer to another question.

import { mapValues } from "./document.js";
import { takenApart } from "./scale.js";

/** What came of a question: an answer, or the sentence why there is none.
 * @typedef {{question: string, value: any, sentence: string | null}} Kept */
/** Of a panel the newest answers, newest first; the question under way, if one is; and whether the newest answer is one
 * since the study was last opened or undone.
 * @typedef {{kept: Kept[], underWay: string | null, recent: boolean}} Answers */
/** What a panel shows. `before` says that the value belongs to other numbers of the same design, as long as its own is
 * coming; `lost` that no server is there to give it.
 * @typedef {{is: "current" | "coming" | "none", value: any, sentence: string | null, before: boolean,
 * lost?: boolean}} Shown */

const MOST = 8; // answers of a panel that are kept, so that undoing finds them again

/** The panel that has the answer to what was typed into a field. @param {{id: string}} field */
export const panelOf = ({ id }) => `typed ${id}`;

/** @type {Answers} */
const NOTHING = { kept: [], underWay: null, recent: false };

/** @type {Shown} */
const NONE = { is: "none", value: null, sentence: null, before: false };

/** The answers once a question is asked; what was refused may be asked again.
 * @param {Answers | undefined} answers @param {string} question @returns {Answers} */
export function asked(answers = NOTHING, question) {
  return { ...answers, kept: answers.kept.filter(({ sentence }) => sentence === null), underWay: question };
}

/** The answers with a further one. @param {Answers | undefined} answers @param {Kept} found @returns {Answers} */
export function answered(answers = NOTHING, found) {
  const others = answers.kept.filter(({ question }) => question !== found.question);
  const mine = answers.underWay === found.question;
  return { kept: [found, ...others].slice(0, MOST), underWay: mine ? null : answers.underWay, recent: mine };
}

/** All answers, none of which may stand in for a question of the study that is there from now on.
 * @param {{[panel: string]: Answers}} answers @returns {{[panel: string]: Answers}} */
export const turned = (answers) => mapValues(answers, (each) => ({ ...each, underWay: null, recent: false }));

/** What came of a question, if it is answered or refused.
 * @param {Answers | undefined} answers @param {string} question */
export const settledOn = (answers, question) => answers?.kept.find((each) => each.question === question);

/** What there is to show of a question that is asked by itself, whenever it changes.
 * @param {Answers | undefined} answers @param {string | null} question @returns {Shown} */
export function shownOf(answers = NOTHING, question) {
  if (question === null) return NONE;
  const found = settledOn(answers, question);
  if (found) {
    const { value, sentence } = found;
    return { is: sentence === null ? "current" : "none", value, sentence, before: false };
  }
  const [latest] = answers.kept;
  const before = answers.recent && latest?.sentence === null && shape(latest.question) === shape(question);
  return { is: "coming", value: before ? latest.value : null, sentence: null, before };
}

/** What is under way while the design that a button asks about is still to get its values. */
export const AWAITED = "";

/** The same of a question that is asked by a button: it comes only if it is under way.
 * @param {Answers | undefined} answers @param {string | null} question @returns {Shown} */
export function soughtIn(answers = NOTHING, question) {
  const shown = shownOf(answers, question);
  const comes = answers.underWay === question || answers.underWay === AWAITED;
  return shown.is === "coming" ? { ...NONE, is: comes ? "coming" : "none" } : shown;
}

/** A question without its numbers, and whatever output is drawn: what it has in common with that of another step of the
 * same slider. @param {string} question */
function shape(question) {
  const known = SHAPES.get(question);
  if (known !== undefined) return known;
  const found = JSON.stringify(JSON.parse(question), (key, value) =>
    (key === OUTPUT || typeof value === "number" || takenApart(value) !== null ? 0 : value));
  if (SHAPES.size >= REMEMBERED) SHAPES.clear();
  SHAPES.set(question, found);
  return found;
}

const OUTPUT = "output";
const REMEMBERED = 50; // shapes, each of which a page asks for many times while an answer is coming
/** @type {Map<string, string>} */
const SHAPES = new Map();
