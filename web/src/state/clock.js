// The time that the plot of a motion and its picture show, one for both.

let now = 0; // [s]
/** @type {Set<(at: number) => void>} */
const listeners = new Set();

export const clock = {
  get: () => now,
  /** @param {number} at [s] */
  set: (at) => {
    if (at === now) return;
    now = at;
    for (const told of listeners) told(now);
  },
  /** @param {(at: number) => void} told @returns {() => void} ends it */
  subscribe: (told) => {
    listeners.add(told);
    return () => void listeners.delete(told);
  },
};
