// What outlives a moment: the link that holds the state, the tab's own memory, files that are opened and downloaded.

import { recordSuffixes } from "./library.js";
import { showNewest } from "./parts/controls.js";
import { baselineOf } from "./questions.js";
import { empty, isBlank } from "./state/document.js";
import { initial } from "./state/store.js";
import { openStudy as beginWith, takeDevice, takeFitted } from "./working.js";

/** @import { Store, View } from "./state/store.js" */
/** @import { Document } from "./state/document.js" */
/** @import { Api } from "./api.js" */
/** @typedef {{document: Document, view: Partial<View>}} Shared */

const KEPT = "inerter.document";
const LINK = "state";
const READ = 20_000; // [ms] in which a message is read of what the page shows too

/** The document and what is looked at, as text for a link. @param {Document} document @param {Partial<View>} view */
async function packed(document, view) {
  const bytes = new Blob([JSON.stringify({ ...document, view })])
    .stream()
    .pipeThrough(new CompressionStream("deflate-raw"));
  const buffer = new Uint8Array(await new Response(bytes).arrayBuffer());
  return btoa(Array.from(buffer, (byte) => String.fromCharCode(byte)).join(""))
    .replaceAll("+", "-")
    .replaceAll("/", "_")
    .replace(/=+$/, "");
}

/** The document that a text holds and what was looked at, or null. @param {string} text
 * @returns {Promise<Shared | null>} */
export async function unpacked(text) {
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    const read = JSON.parse(await new Response(stream).text());
    const document = documentFrom(read);
    return document && { document, view: viewFrom(read.view) };
  } catch {
    return null;
  }
}

/** A document of what was read, as far as it is one. @param {any} read @returns {Document | null} */
export function documentFrom(read) {
  if (read === null || typeof read !== "object" || typeof read.study !== "object" || read.study === null) return null;
  const { study, layout, strut, values, optima, ranges, designs } = { ...empty(), ...read };
  return {
    study,
    layout: String(layout),
    strut: strut === null ? null : String(strut),
    values: values ?? {},
    optima: Object.fromEntries(Object.entries(optima ?? {}).filter(([, of]) => Array.isArray(of?.problems))),
    ranges: ranges ?? {},
    designs: Array.isArray(designs) ? designs : [],
  };
}

/** What was looked at, as far as it is that: of what is known the values of the same type. @param {any} read
 * @returns {Partial<View>} */
function viewFrom(read) {
  const known = Object.entries(initial().view).filter(
    ([key, value]) => typeof read?.[key] === typeof value && Array.isArray(read[key]) === Array.isArray(value),
  );
  return Object.fromEntries(known.map(([key]) => [key, read[key]]));
}

/** A link to the document as it is and as it is looked at; never with the token. @param {Document} document
 * @param {View} view */
export async function linkTo(document, { theme, playing, ...view }) {
  return `${location.origin}${location.pathname}#${LINK}=${await packed(document, view)}`;
}

/** What the address of the page says. @param {string} hash */
export function fromAddress(hash) {
  const said = new URLSearchParams(hash.replace(/^#/, ""));
  return { token: said.get("token"), state: said.get(LINK) };
}

/** Keeps the document in the tab's memory, so that a reload loses nothing. @param {Store} store */
export function keepRemembering(store) {
  /** @type {Document | null} */
  let last = null;
  let due = 0;
  store.subscribe(() => {
    const { present } = store.get().history;
    if (present === last) return;
    last = present;
    clearTimeout(due);
    due = setTimeout(() => sessionStorage.setItem(KEPT, JSON.stringify(present)), 200);
  });
  addEventListener("pagehide", () => {
    const { present } = store.get().history;
    sessionStorage.setItem(KEPT, JSON.stringify(present));
    noteOpened(present);
  });
}

/** The document of before a reload, or null. @returns {Document | null} */
export function remembered() {
  try {
    return documentFrom(JSON.parse(sessionStorage.getItem(KEPT) ?? "null"));
  } catch {
    return null;
  }
}

/** Hands a file to the person. @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A title as the name of a file. @param {string | undefined} title */
export const fileName = (title) =>
  (title ?? "study").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 60) || "study";

/** Whether a name is that of a file of records. @param {Store} store @param {string} name */
const isRecord = (store, name) => recordSuffixes(store.get()).some((suffix) => name.toLowerCase().endsWith(suffix));

/** Opens what was dropped or chosen: study files, and measured records. @param {Store} store @param {Api} api
 * @param {Iterable<File>} files */
export async function open(store, api, files) {
  for (const file of studiesFirst(store, files)) {
    try {
      if (isRecord(store, file.name) && !(await isSummary(file))) await openRecord(store, api, file);
      else if (/\.toml$/i.test(file.name)) await openStudyFile(store, api, file);
      else if (/\.json$/i.test(file.name)) await openFit(store, api, file);
      else store.say(`${file.name} is not a supported file; supported: study files (.toml), result folders, and ${
        `records (${recordSuffixes(store.get()).join(", ")})`}.`);
    } catch (error) {
      store.say(`${file.name}: ${/** @type {Error} */ (error).message}`, file.name);
    }
  }
}

/** Of a result folder what it was made of, or what came of it, else the files themselves. @template {{name: string}} T
 * @param {Store} store @param {Iterable<T>} files @returns {T[]} */
export function studiesFirst(store, files) {
  const all = [...files];
  /** @type {string[]} */
  const sources = store.get().about?.result_sources ?? [];
  const source = sources.map((wanted) => all.find(({ name }) => name === wanted)).find(Boolean);
  return source ? [source] : all;
}

/** Whether a table is one of results, not a record. @param {File} file */
const isSummary = async (file) => file.name === "summary.csv" && /^layout,/.test(await file.slice(0, 100).text());

/** Gives a message of what the page shows too, which moves nothing; a newer one about the same is not closed with it.
 * @param {Store} store @param {string} text @param {string} about */
function tellAWhile(store, text, about) {
  store.dispatch({ type: "said", text, about, brief: true });
  const said = store.get().messages.at(-1);
  setTimeout(() => store.get().messages.some((each) => each === said) && store.dispatch({ type: "closed", about }),
    READ);
}

/** @param {Store} store @param {Api} api @param {File} file */
async function openStudyFile(store, api, file) {
  const { study, kind, problems } = await api.post("study/read", { text: await file.text(), name: file.name });
  if (kind === "simulate") return openSimulation(store, api, file.name, study);
  if (kind !== "run")
    return store.say(`${file.name} is not a study file; nothing was changed. ${problems[0]?.sentence ?? ""}`.trim());
  if (!(await beginWith(store, api, study))) return;
  const several = problems.length === 1 ? "one entry needs" : `${problems.length} entries need`;
  tellAWhile(store, `${file.name} is open${problems.length ? `; ${several} another value` : ""}.`, file.name);
}

/** A simulated vehicle is opened as a study that asks for the first index; a device of a rig joins the study that is
 * open. @param {Store} store @param {Api} api @param {string} name @param {any} tables */
async function openSimulation(store, api, name, { signal, simulation, ...study }) {
  const { about } = store.get();
  const model = about.vehicles.find((/** @type {any} */ { key }) => key === study.vehicle.model);
  if (model?.is_rig) return store.say(`${name}: ${await takeDevice(store, api, study)}`);
  if (!(await beginWith(store, api, { ...study, study: { indices: [about.indices[0].symbol] } }))) return;
  if (simulation?.layout in study.layouts) store.change({ type: "selected", layout: simulation.layout });
  const examples = about.road.map((/** @type {any} */ { key, example }) => [key, example]);
  const offer = study.road ? undefined : { label: "Add a road", act: () =>
    store.change({ type: "placed", place: ["road"], value: Object.fromEntries(examples) }) };
  const told = `${name} is open as a study of its vehicle; the excitation of the simulation is omitted.`;
  store.say(told, undefined, offer);
}

/** What was identified joins the study that is open. @param {Store} store @param {Api} api @param {File} file */
async function openFit(store, api, file) {
  const fit = JSON.parse(await file.text());
  if (typeof fit.elements !== "string")
    return store.say(`${file.name} is no result of inerter identify, and nothing was changed.`);
  const { study } = await api.post("study/read", { text: fit.elements, name: file.name });
  store.say(`${file.name}: ${await takeFitted(store, api, fit, study ?? {})}`);
}

/** Where a record comes first, the study of the first vehicle is opened, since its device needs one.
 * @param {Store} store @param {Api} api @param {File} file */
async function openRecord(store, api, file) {
  store.look({ tab: "rig", tall: true });
  tellAWhile(store, `Reading ${file.name}…`, file.name);
  const record = await api.upload(`records?name=${encodeURIComponent(file.name)}`, file);
  store.dispatch({ type: "recorded", record });
  let told = `${file.name} was read.`;
  if (isBlank(store.get().history.present)) {
    const { examples, vehicles: [first] } = await api.get("examples");
    const { study } = examples.find((/** @type {any} */ { name }) => name === first.name);
    if (await beginWith(store, api, study)) // the device joins the baseline
      store.change({ type: "selected", layout: baselineOf(store.get().history.present).layout });
    told += ` It is in the tab Rig, and the example “${study.title}” is open, to try its device in.`;
  }
  showNewest(".tabs");
  tellAWhile(store, told, file.name);
}

const BEFORE = "inerter.opened";
const FEW = 5; // studies that were opened before

/** The studies that were opened before on this machine, newest first.
 * @returns {{title: string, at: number, study: any}[]} */
export function openedBefore() {
  try {
    return JSON.parse(localStorage.getItem(BEFORE) ?? "[]").filter((/** @type {any} */ each) => each?.study);
  } catch {
    return [];
  }
}

/** Notes the study of a document that is left, or edited for a while; none of an empty one.
 * @param {Document} document */
export function noteOpened({ study }) {
  if (isBlank({ study })) return;
  const title = String(study.title ?? "Untitled study");
  const others = openedBefore().filter((each) => each.title !== title);
  const all = [{ title, at: Date.now(), study }, ...others].slice(0, FEW);
  try {
    localStorage.setItem(BEFORE, JSON.stringify(all));
  } catch {
    localStorage.removeItem(BEFORE); // the studies are too large to be kept
  }
}
