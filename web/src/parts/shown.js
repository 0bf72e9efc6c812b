// When an answer is on the screen, which the window is told, and when numbers of before turn pale.
import { answerOf } from "../questions.js";
import { useEffect, useLayoutEffect, useState } from "./html.js";

/** @param {string} panel @param {import("../state/store.js").State} state */
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
