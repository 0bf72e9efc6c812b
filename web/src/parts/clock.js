// How an answer stands: what is coming moves, and tells how long it has been coming; numbers of before turn pale.
import { answerOf } from "../questions.js";
import { html, useEffect, useLayoutEffect, useState } from "./html.js";

const OFTEN = 500; // [ms] between two looks at the clock
const SOON = 1; // [s] from where the time is told

/** How long something has gone on; since it is shown, where nothing says since when.
 * @param {{since?: number | null}} props  `since`: in ms since 1970 */
export function Clock({ since = null }) {
  const [begun] = useState(Date.now());
  const [now, setNow] = useState(Date.now());
  useEffect(() => {
    const ticking = setInterval(() => setNow(Date.now()), OFTEN);
    return () => clearInterval(ticking);
  }, []);
  const seconds = Math.floor((now - (since ?? begun)) / 1000);
  const text = seconds < 100 ? `${seconds} s` : `${Math.floor(seconds / 60)} min ${seconds % 60} s`;
  return seconds < SOON ? null : html`<span class="clock">${text}</span>`;
}

const AT_LAST = 300; // [ms] until something moves: a step of a slider is answered before that

/** Something that goes on: at once in words, then with a bar that moves, and the time.
 * @param {{what: string, since?: number | null}} props */
export function Moving({ what, since = null }) {
  const [begun] = useState(Date.now());
  const [moves, setMoves] = useState(false);
  useEffect(() => {
    const waiting = setTimeout(() => setMoves(true), AT_LAST);
    return () => clearTimeout(waiting);
  }, []);
  return html`<span class="moving"><span>${what}</span>${moves
    && html` <progress aria-label=${what}></progress> <${Clock} since=${since ?? begun} />`}</span>`;
}

const WORDS = { current: "", coming: "coming", none: "no answer", lost: "no server" };
const BEFORE = ", former values";

/** That what stands below is not the answer to what is asked now; nothing where it is.
 * @param {{shown: import("../state/answers.js").Shown}} props */
export function Being({ shown: { is, before, lost } }) {
  const coming = is === "coming";
  const what = WORDS[coming && lost ? "lost" : is] + (useLate(before) ? BEFORE : "");
  return html`<span class="being" data-being=${is}>${coming && !lost ? html`<${Moving} what=${what} />` : what}</span>`;
}

/** Tells the window when an answer is on the screen.
 * @param {string} panel @param {import("../state/store.js").State} state */
export function useShown(panel, state) {
  const { is, value } = answerOf(state, panel);
  useLayoutEffect(() => {
    dispatchEvent(new CustomEvent("inerter:shown", { detail: { panel, newest: is === "current" } }));
  }, [is, value]);
}

const LATE = 100; // [ms]: most steps of a slider are answered before that

/** Whether what is shown is of before, and has been for so long that it is marked. A transition of the styles would
 * wait too, but it makes each cell a layer of its own. @param {boolean} before */
export function useLate(before) {
  const [late, setLate] = useState(false);
  useEffect(() => {
    if (!before) return undefined;
    const waiting = setTimeout(() => setLate(true), LATE);
    return () => {
      clearTimeout(waiting);
      setLate(false);
    };
  }, [before]);
  return before && late;
}
