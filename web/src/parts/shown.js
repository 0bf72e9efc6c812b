// Tells the window when an answer is on the screen, and whether it is that to the newest question.
import { useLayoutEffect } from "./html.js";

/** @param {string} panel @param {import("../state/store.js").State} state */
export function useShown(panel, state) {
  const answer = state.answers[panel];
  useLayoutEffect(() => {
    dispatchEvent(new CustomEvent("inerter:shown", { detail: { panel, newest: answer !== undefined && answer.of === answer.key } }));
  }, [answer?.value]);
}
