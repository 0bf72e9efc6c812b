// Undo and redo of a document that is never changed in place.

/** What the changes of one step have in common, such as a drag. @typedef {string | symbol | null} Gesture */
/** @template T @typedef {{past: T[], present: T, future: T[], gesture: Gesture}} History */

const MOST = 500;

/** @template T @param {T} present @returns {History<T>} */
export const beginning = (present) => ({ past: [], present, future: [], gesture: null });

/**
 * The history after a change; changes of one gesture are one step.
 * @template T @param {History<T>} history @param {T} next @param {Gesture} gesture @returns {History<T>}
 */
export function changed(history, next, gesture = null) {
  if (next === history.present) return history;
  const goesOn = gesture !== null && gesture === history.gesture;
  const past = goesOn ? history.past : [...history.past, history.present].slice(-MOST);
  return { past, present: next, future: [], gesture };
}

/** The history in which a gesture has ended. @template T @param {History<T>} history @returns {History<T>} */
export const rested = (history) => (history.gesture === null ? history : { ...history, gesture: null });

/** @template T @param {History<T>} history @returns {History<T>} */
export function undone({ past, present, future, gesture }) {
  if (past.length === 0) return { past, present, future, gesture };
  return { past: past.slice(0, -1), present: past[past.length - 1], future: [present, ...future], gesture: null };
}

/** @template T @param {History<T>} history @returns {History<T>} */
export function redone({ past, present, future, gesture }) {
  if (future.length === 0) return { past, present, future, gesture };
  return { past: [...past, present], present: future[0], future: future.slice(1), gesture: null };
}
