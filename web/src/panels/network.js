// The strut as a drawn network, and as text; both are the same value, and either can be edited.

import { element as leaf, freshName, joinAt, leaves, moveTo, names, partAt, removeAt, replaceAt, shiftAt, written }
  from "../network/algebra.js";
import { drawing, pathOf, shortLabel } from "../network/drawing.js";
import { isRange, mapValues, own, strutsOf, textOf } from "../state/document.js";
import { brief, briefIn, strutWords, symbolParts } from "../state/scale.js";
import { isFreeNetwork, kindOf, layoutsWith, quickMethod, selectedElement, treeOf, unitOf, wrongIn }
  from "../library.js";
import { answerOf, strutTexts } from "../questions.js";
import { Chip, DropDown, formHandler, textHandler } from "../parts/controls.js";
import { letterOf } from "../parts/keys.js";
import { symbolPath } from "./sketch.js";
import { html, useEffect, useMemo, useRef, useState } from "../parts/html.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { Tree, Path, Joint } from "../network/algebra.js" */
/** @import { Change, ElementEntry } from "../state/document.js" */
/** @import { Placed, Box } from "../network/drawing.js" */

const MARGIN = 14;
const TERMINAL = 1.6;
const [SMALLEST, LARGEST] = [0.7, 1.7]; // [px] a point of the drawing
const MANY = 8; // elements from where a drawing may be laid across the page, and has no values in it
const VALUE = 66; // [pt] room of a value in the drawing
const [FINE, COARSE] = [10, 13]; // [pt] of type: larger in tall drawings, which are drawn smaller
const LINES = 14; // of type, in the height of a drawing
const FAR = 6; // [px] from where a press is a drag

/** @param {{store: Store, api: Api}} props */
export function NetworkPanel({ store, api }) {
  const state = store.get();
  return html`<section class=${`panel network ${state.view.across ? "across" : ""}`} aria-labelledby="network-title"
    aria-busy=${answerOf(state, "check").is === "coming"}>
    <${Editor} store=${store} api=${api} /></section>`;
}

/** At which strut the network is that is edited; one that has another, or could have one, is chosen by its chip.
 * @param {{store: Store}} props */
function Struts({ store }) {
  const state = store.get();
  const document = state.history.present;
  const { study: { layouts, vehicle }, layout } = document;
  const parted = strutsOf(own(layouts, layout));
  const [text, texts] = [textOf(document), strutTexts(state)];
  const model = state.about?.vehicles.find((/** @type {any} */ { key }) => key === vehicle?.model);
  /** @type {{[strut: string]: string}} */
  const all = { ...texts, ...Object.fromEntries((model?.mounts ?? []).map((/** @type {string} */ strut) =>
    [strut, texts[strut] ?? text])) };
  const drawn = parted.length > 0 ? [document.strut] : Object.keys(texts).filter((strut) => texts[strut] === text);
  const shared = drawn.length > 1 ? drawn : [];
  /** @param {string} strut */
  const choose = (strut) => store.change(parted.includes(strut) ? { type: "selected", layout, strut }
    : { type: "strutsParted", texts: { ...texts, [strut]: all[strut] }, strut });
  return Object.keys(all).length > 1 && html`<div class="row struts pad" role="group" aria-label="Struts">
    ${shared.length > 0 && html`<span class="quiet">The same at ${strutWords(shared)}.</span> <button type="button"
      onClick=${() => choose(/** @type {string} */ (shared[0]))}>One for each</button>`}
    ${Object.keys(all).filter((strut) => !shared.includes(strut)).map((strut) => html`<${Chip} key=${strut}
      on=${drawn.includes(strut)} set=${() => choose(strut)}
      title=${strut in texts ? undefined : "Like this one at first"}>${strut in texts ? "" : "+ "}${
        strutWords([strut])}<//>`)}
    ${parted.length > 0 && html`<button type="button"
      onClick=${() => store.change({ type: "strutsJoined" })}>This one everywhere</button>`}</div>`;
}

/** @param {{store: Store, api: Api}} props */
function Editor({ store, api }) {
  const state = store.get();
  const document = state.history.present;
  const text = textOf(document);
  const tree = treeOf(state, text);
  const [last, setLast] = useState(/** @type {{tree: Tree | null, of: string}} */ ({ tree: null, of: "" }));
  const of = JSON.stringify([document.study.title, document.layout, document.strut]);
  const [how, setHow] = useState(/** @type {Joint} */ ("series"));
  useEffect(() => {
    if (tree !== null || text.trim() === "") setLast({ tree, of });
  }, [tree, of]);
  // what is being typed keeps the drawing of before
  const shownTree = tree ?? (text.trim() !== "" && last.of === of ? last.tree : null);
  const path = pathIn(shownTree, state);
  const selected = shownTree && partAt(shownTree, path);
  const editing = { store, api, how };
  const off = tree === null && text.trim() !== "";
  return html`<div class="head"><h2 id="network-title">Strut ${document.layout}</h2>
      <div class="segmented" role="group" aria-label="How a part is joined to what is selected">
        ${/** @type {Joint[]} */ (["series", "parallel"]).map((kind) =>
          html`<${Chip} on=${how === kind} set=${() => setHow(kind)}>in ${kind}<//>`)}</div>
      <${PartMenu} editing=${editing} off=${off} selected=${selected} />
      ${shownTree && (state.view.across || leaves(shownTree).length > MANY)
        && html`<${Chip} on=${state.view.across} set=${() => store.look({ across: !state.view.across })}
          aria-label="Lay out wide" title="Lay out wide: over the whole page">⤢<//>`}</div>
    <${Struts} store=${store} />
    ${shownTree === null
      ? html`<p class="quiet drawing empty">No network yet: choose a part below, or write one.</p>`
      : html`<${Schematic} editing=${editing} tree=${shownTree} path=${path}
        stale=${wrongIn(state) !== null && tree === null} />`}
    ${shownTree && html`<${Trail} store=${store} tree=${shownTree} path=${path} />`}
    <p class="visually-hidden" aria-live="polite">${selected ? described(selected) : ""}</p>
    <${Palette} editing=${editing} off=${off} />
    <${Text} store=${store} text=${text} />`;
}

/** What is selected, and the groups that it is in: each can be selected.
 * @param {{store: Store, tree: Tree, path: Path}} props */
function Trail({ store, tree, path }) {
  return html`<div class="row trail" role="group" aria-label="Selected part">
    <span class="quiet">Selected:</span>
    ${[...path.keys(), path.length].map((depth) => {
      const part = partAt(tree, path.slice(0, depth));
      const text = depth === 0 ? "the whole" : part ? written(part) : "";
      return html`<button type="button" class="link" key=${depth} aria-pressed=${depth === path.length}
        onClick=${() => store.look({ path: path.slice(0, depth) })}>
          ${text.length > 24 ? `${text.slice(0, 23)}…` : text}</button>`;
    })}
  </div>`;
}

/** @param {Tree} part */
const described = (part) => (part.kind === "element" ? `${part.name} is selected`
  : `${part.kind === "bridge" ? "A bridge is" : `${part.parts.length} parts in ${part.kind} are`} selected: `
    + written(part));

/** @typedef {{store: Store, api: Api, how: Joint}} Editing */
/** @typedef {{key: string, symbol: string, example: string, quantity: string, drawing: any[],
 * switches: boolean}} ElementKind  `switches`: sticks, or opens */

/** @param {State} state @returns {ElementKind[]} */
const kindsOf = ({ about }) => about?.elements ?? [];

/** What is selected in a tree: the whole of it where there is no such part. @param {Tree | null} tree
 * @param {State} state @returns {Path} */
const pathIn = (tree, { view }) => (tree !== null && partAt(tree, view.path) !== null ? view.path : []);

/** The tree and what is selected in it, as of now: what is drawn may be a frame older. @param {Store} store
 * @returns {{tree: Tree | null, path: Path}} */
function present(store) {
  const tree = treeOf(store.get(), textOf(store.get().history.present));
  return { tree, path: pathIn(tree, store.get()) };
}

/** Puts another tree in the place of the present one, and selects a part of it. @param {Store} store
 * @param {Tree} tree @param {Path} path @param {{[name: string]: ElementEntry}} [added]
 * @param {Change[]} [also] */
function draw(store, tree, path, added, also = []) {
  const text = written(tree);
  store.dispatch({ type: "planted", text, tree });
  store.change([{ type: "drawn", text, added }, ...also]);
  store.look({ path });
}

/** Draws a tree with a new element, which may vary where another one of its kind may: else a layout that has it would
 * be compared at its first value with others that are optimised. @param {Store} store @param {Tree} tree
 * @param {string} name @param {ElementKind} kind @param {ElementEntry} [entry] */
function drawNew(store, tree, name, kind, entry = kind.example) {
  const state = store.get();
  const { elements = {} } = state.history.present.study;
  const [range] = Object.entries(elements).flatMap(([other, each]) =>
    (isRange(each) && kindOf(state, other)?.key === kind.key ? [each] : []));
  draw(store, tree, placeOf(tree, name), { [name]: entry }, range && !isRange(entry) ? [{ type: "freed",
    place: ["elements", name], name, from: range.from, to: range.to, method: quickMethod(state)?.name }] : []);
}

/** Where an element of this name stands; the last one if there are more. @param {Tree} tree @param {string} name
 * @returns {Path} */
const placeOf = (tree, name) => leaves(tree).findLast((one) => one.name === name)?.path ?? [];

/** A part of this name joined to what is selected, or in its place. @param {Editing} editing @param {string} name
 * @param {"join" | "replace"} [by] @param {(tree: Tree) => void} [show] */
function add({ store, how }, name, by = "join", show = (tree) => draw(store, tree, placeOf(tree, name))) {
  const { tree, path } = present(store);
  if (tree !== null) show(by === "replace" ? replaceAt(tree, path, leaf(name)) : joinAt(tree, path, how, leaf(name)));
  else if (textOf(store.get().history.present).trim() === "") show(leaf(name));
}

/** A new element of a kind, with the value of one of its kind that it replaces, else of its example.
 * @param {Editing} editing @param {ElementKind} kind @param {"join" | "replace"} [by] */
function addKind(editing, kind, by) {
  const { store } = editing;
  const name = newName(store, kind);
  const old = by === "replace" ? selectedElement(store.get()) : null;
  const like = old !== null && kindOf(store.get(), old)?.key === kind.key;
  const entry = like ? store.get().history.present.study.elements?.[old] : kind.example;
  const beside = by === "replace" || !kind.switches ? null : selectedElement(store.get());
  add(editing, name, by, (tree) => drawNew(store, tree, name, kind, entry));
  if (beside !== null) offerElsewhere(editing, beside, name);
}

/** Friction and gaps are of a device: what was joined to an element in one layout is offered to all others with it.
 * @param {Editing} editing @param {string} beside @param {string} name */
function offerElsewhere({ store, how }, beside, name) {
  const state = store.get();
  const { layout, study } = state.history.present;
  const others = (layoutsWith(state, beside) ?? []).filter((each) => each !== layout);
  /** @param {any} entry @returns {any} */
  const joined = (entry) => {
    if (typeof entry !== "string") return mapValues(entry, joined);
    const tree = treeOf(state, entry);
    const places = tree ? leaves(tree).filter((each) => each.name === beside) : [];
    return tree && places.length > 0
      ? written(places.reduceRight((next, { path }) => joinAt(next, path, how, leaf(name)), tree)) : entry;
  };
  if (others.length > 0) store.say(`${name} is at ${beside} of ${layout}, not of ${others.join(", ")}.`, "joined", {
    label: `Join it in all layouts with ${beside}`,
    act: () => {
      store.change(others.map((each) => ({ type: "placed", place: ["layouts", each],
        value: joined(own(study.layouts, each)) })));
    },
  });
}

/** @param {Store} store @param {ElementKind} kind */
const newName = (store, { symbol }) =>
  freshName(symbol, Object.keys(store.get().history.present.study.elements ?? {}));

/** @param {Store} store */
function remove(store) {
  const { tree, path } = present(store);
  if (tree === null) return;
  const left = removeAt(tree, path);
  if (left === null) store.change({ type: "drawn", text: "" });
  else draw(store, left, path.slice(0, -1));
}

/** @param {Store} store @param {-1 | 1} step */
function shift(store, step) {
  const { tree, path } = present(store);
  if (tree === null || path.length === 0) return;
  const next = shiftAt(tree, path, step);
  if (next !== tree) draw(store, next, [...path.slice(0, -1), path[path.length - 1] + step]);
}

/** New parts, each with its key. @param {{editing: Editing, off: boolean}} props */
function Palette({ editing, off }) {
  const where = editing.how === "series" ? "in series with" : "in parallel to";
  return html`<div class="palette" role="group" aria-label="Add a part">
    ${kindsOf(editing.store.get()).map((kind) => html`<button type="button" key=${kind.key} class="part" disabled=${off}
        title=${`Add a ${kind.key} ${where} what is selected; drag it to a place`}
        aria-label=${`Add a ${kind.key}`} draggable=${!off}
        onDragStart=${(/** @type {DragEvent} */ event) => event.dataTransfer?.setData("text/x-element", kind.key)}
        onClick=${() => addKind(editing, kind)}>
        <svg viewBox="-12 -22 24 44" width="16" height="28" aria-hidden="true"><path class="symbol"
          d=${symbolPath(kind)} /></svg>
        ${kind.key} <kbd>${letterOf(kind)}</kbd></button>`)}
  </div>`;
}

/** What else can be done to what is selected. @param {{editing: Editing, off: boolean, selected: Tree | null}} props */
function PartMenu({ editing, off, selected }) {
  const { store } = editing;
  const state = store.get();
  const kinds = kindsOf(state);
  const known = Object.keys(state.history.present.study.elements ?? {});
  return html`<${DropDown} title="Part" id="part-menu">
    <${Rename} store=${store} api=${editing.api} selected=${selected} />
    <label>Add <select value="" disabled=${off || known.length === 0}
      onChange=${pickHandler((name) => add(editing, name))}>
      <option value="">again…</option>
      ${known.map((name) => html`<option key=${name} value=${name}>${name}</option>`)}
    </select></label>
    <label>Replace by <select value="" disabled=${off || selected === null}
      onChange=${pickHandler((name) => {
      const kind = kinds.find((each) => `new ${each.key}` === name);
      if (kind) addKind(editing, kind, "replace");
      else add(editing, name, "replace");
    })}>
      <option value="">…</option>
      ${kinds.map((kind) => html`<option key=${kind.key}
        value=${`new ${kind.key}`}>a new ${kind.key}</option>`)}
      ${known.map((name) => html`<option key=${`old ${name}`} value=${name}>${name}</option>`)}
    </select></label>
    <button type="button" disabled=${off || selected === null} onClick=${() => remove(store)}>Delete</button>
  <//>`;
}

/** A handler that hands on what is picked, after which nothing is. @param {(value: string) => void} act
 * @returns {(event: Event) => void} */
const pickHandler = (act) => (event) => {
  textHandler(act)(event);
  /** @type {HTMLSelectElement} */ (event.currentTarget).value = "";
};

/** @param {{store: Store, api: Api, selected: Tree | null}} props */
function Rename({ store, api, selected }) {
  const [told, setTold] = useState("");
  // the form stays: a drawing that moves cannot be dragged in
  const old = selected?.kind === "element" ? selected.name : "";
  return html`<form class="row" key=${old} onSubmit=${formHandler((form) =>
    void renameElement(store, api, old, String(form.get("name")).trim()).then(setTold))}>
    <label>Name <input id="element-name" class="name" name="name" disabled=${old === ""} defaultValue=${old}
      autocomplete="off" spellcheck=${false} /></label>
    <button disabled=${old === ""}>Rename</button>${told && html`<span class="problem" role="alert">${told}</span>`}
  </form>`;
}

/** Another name for an element, wherever the study has it; returns what to tell.
 * @param {Store} store @param {Api} api @param {string} old @param {string} name */
async function renameElement(store, api, old, name) {
  if (name === old) return "";
  const { study } = store.get().history.present;
  try {
    const renamed = await api.post("study/rename", { study, names: { [old]: name } });
    if (store.get().history.present.study !== study) return "The study was changed meanwhile; name it again.";
    store.change({ type: "elementRenamed", old, name, study: renamed.study });
    return "";
  } catch (error) {
    return /** @type {Error} */ (error).message;
  }
}

/** @param {{editing: Editing, tree: Tree, path: Path, stale: boolean}} props */
function Schematic({ editing, tree, path, stale }) {
  const { store } = editing;
  const state = store.get();
  const valued = leaves(tree).length <= MANY;
  const plan = useMemo(() => drawing(tree, [], valued ? VALUE : 0), [tree, valued]);
  const figure = useRef(/** @type {SVGSVGElement | null} */ (null));
  const [over, setOver] = useState(/** @type {{path: Path, kind: Joint, before: boolean} | null} */ (null));
  const drag = (/** @type {PointerEvent} */ event, /** @type {Path} */ from) => beginDrag(store, event, from, setOver);
  useEffect(() => {
    const active = globalThis.document.activeElement;
    if (active && figure.current?.contains(active)) focusOn(figure.current, path);
  }, [path, plan]);

  const width = plan.left + plan.right + 2 * MARGIN;
  const height = plan.height + 2 * MARGIN;
  const box = plan.boxes.find((each) => same(each.path, path));
  const target = over && plan.boxes.find((each) => same(each.path, over.path));
  const group = box && partAt(tree, path)?.kind !== "element" ? box : null;
  return html`<div class=${`drawing ${stale ? "stale" : ""}`} data-keys="Drawing">
    <svg ref=${figure} viewBox=${`${-plan.left - MARGIN} ${-MARGIN} ${width} ${height}`}
      style=${{ width: "100%", height: "100%", minWidth: `${state.view.across ? 0 : SMALLEST * width}px`,
        minHeight: `${SMALLEST * height}px`, maxHeight: `${LARGEST * height}px`,
        fontSize: `${Math.min(COARSE, Math.max(FINE, height / LINES))}px` }} role="group"
          aria-label=${`Network ${written(tree)}`}
      onKeyDown=${(/** @type {KeyboardEvent} */ event) => onKey(event, editing)}
      onDragOver=${(/** @type {DragEvent} */ event) => {
        event.preventDefault();
        setOver(targetAt(event.clientX, event.clientY));
      }}
      onDragLeave=${() => setOver(null)}
      onDrop=${(/** @type {DragEvent} */ event) => dropKind(event, store, setOver)}>
      ${group && html`<rect class="chosen" x=${group.left - 3} y=${group.top - 3} width=${group.right - group.left + 6}
        height=${group.bottom - group.top + 6} rx="4" />`}
      <path class="wire" d=${pathOf(plan.lines)} />
      <circle class="terminal" cx="0" cy=${-TERMINAL} r=${TERMINAL} />
        <circle class="terminal" cx="0" cy=${plan.height + TERMINAL} r=${TERMINAL} />
      ${plan.placed.map((one) => html`<${Symbol} key=${one.path.join()} one=${one} state=${state}
        chosen=${same(one.path, path)} entrance=${isEntrance(one.path, path)} store=${store} drag=${drag}
        valued=${valued} />`)}
      ${target && over && html`<path class="landing" d=${landing(target, over)} />`}
    </svg>
  </div>`;
}

/** @param {{one: Placed, state: State, chosen: boolean, entrance: boolean, store: Store, valued: boolean,
 * drag: (event: PointerEvent, path: Path) => void}} props */
function Symbol({ one, state, chosen, entrance, store, valued, drag }) {
  const kind = kindOf(state, one.name);
  const value = valueOf(state, one.name);
  const { elements = {} } = state.history.present.study;
  const free = isFreeNetwork(state, one.name);
  const unknown = !kind && !free && (!(one.name in elements) || layoutsWith(state, one.name) !== null);
  const what = kind?.key ?? (free ? "free network" : unknown ? "unknown element" : "");
  const label = [one.name, what, value].filter(Boolean).join(", ");
  const select = () => same(store.get().view.path, one.path)
    || store.look({ path: one.path });
  const light = (/** @type {string | null} */ name) => () => store.dispatch({ type: "lit", name });
  return html`<g class=${`element ${chosen ? "chosen" : ""} ${unknown ? "unknown" : ""} ${state.lit === one.name ? "lit"
    : ""}`}
    transform=${`translate(${one.x} ${one.y})`} role="button" aria-label=${label} aria-pressed=${chosen}
      tabindex=${entrance ? 0 : -1} data-path=${one.path.join(".")} data-name=${one.name}
    onClick=${select} onFocus=${select} onPointerEnter=${light(one.name)} onPointerLeave=${light(null)}
    onPointerDown=${(/** @type {PointerEvent} */ event) => drag(event, one.path)}>
    <title>${label}</title>
    <rect class="touch" x="-11" y="-20" height="40" rx="3"
      width=${24 + Math.max(valued ? VALUE : 0, 5.2 * shortLabel(one.name).length)} />
    <path class="symbol" d=${symbolPath(kind)} />
    <text x="12" y="1">${free ? shortLabel(one.name) : subscripted(shortLabel(one.name))}</text>
    ${valued && html`<text class="value" x="12" y="13">${value}</text>`}
  </g>`;
}

/** A name as a symbol. @param {string} name */
function subscripted(name) {
  const [symbol, subscript] = symbolParts(name);
  return html`${symbol}<tspan dy="2" font-size="0.75em">${subscript}</tspan>`;
}

/** Whether the keyboard enters the drawing at this element: what is selected, or the first of it.
 * @param {Path} leafPath @param {Path} path */
const isEntrance = (leafPath, path) => leafPath.every((i, level) => i === (path[level] ?? 0));

/** The value of an element as it is written. @param {State} state @param {string} name */
function valueOf(state, name) {
  const { study, values, layout } = state.history.present;
  const entry = own(study.elements, name);
  const chosen = own(own(values, layout), name);
  if (isRange(entry)) return chosen === undefined ? "free" : briefIn(state.about, chosen, unitOf(state, name));
  return typeof entry === "string" ? brief(entry, state.about, kindOf(state, name)?.unit) : "";
}

/** @param {Path} a @param {Path} b */
const same = (a, b) => a.length === b.length && a.every((i, level) => i === b[level]);

/** @param {SVGSVGElement} figure @param {Path} path */
function focusOn(figure, path) {
  const there = /** @type {SVGElement | null} */ (figure.querySelector(`[data-path="${path.join(".")}"]`));
  there?.focus();
}

/** @param {KeyboardEvent} event @param {Editing} editing */
function onKey(event, editing) {
  const { store } = editing;
  const { tree, path } = present(store);
  if (tree === null) return;
  /** @param {Path} to */
  const select = (to) => store.look({ path: to });
  const all = leaves(tree).map((one) => one.path);
  const at = all.findIndex((each) => path.every((i, level) => each[level] === i));
  /** @param {-1 | 1} step */
  const stepBy = (step) => () =>
    (event.altKey ? shift(store, step) : select(all[(at + step + all.length) % all.length]));
  /** @type {{[key: string]: () => void}} */
  const keys = {
    ArrowRight: stepBy(1), ArrowDown: stepBy(1), ArrowLeft: stepBy(-1), ArrowUp: stepBy(-1),
    Home: () => select(all[0]),
    End: () => select(all[all.length - 1]),
    Escape: () => select(path.slice(0, -1)),
    Delete: () => remove(store),
    Backspace: () => remove(store),
    F2: name,
  };
  if (event.ctrlKey || event.metaKey) return;
  const joint = event.key === event.key.toUpperCase() ? "parallel" : "series";
  const kind = kindsOf(store.get()).find((each) => letterOf(each) === event.key.toUpperCase());
  if (keys[event.key]) keys[event.key]();
  else if (kind) addKind({ ...editing, how: joint }, kind);
  else return;
  event.preventDefault();
}

/** Opens the menu of the selected part at its name. */
function name() {
  globalThis.document.getElementById("part-menu")?.setAttribute("open", "");
  const field = /** @type {HTMLInputElement | null} */ (globalThis.document.getElementById("element-name"));
  field?.select();
  field?.focus();
}

/** Where a part would be joined if it were let go here. @param {number} x @param {number} y */
function targetAt(x, y) {
  const found = globalThis.document.elementFromPoint(x, y)?.closest("[data-path]");
  if (!found) return null;
  const path = (found.getAttribute("data-path") ?? "").split(".").filter(Boolean).map(Number);
  const box = (found.querySelector(".symbol") ?? found).getBoundingClientRect();
  const [dx, dy] = [(x - box.x - box.width / 2) / box.width, (y - box.y - box.height / 2) / box.height];
  const kind = /** @type {Joint} */ (Math.abs(dy) > 0.25 ? "series" : "parallel");
  return { path, kind, before: kind === "series" ? dy < 0 : dx < 0 };
}

/** A line where a part would come to lie. @param {Box} box
 * @param {{kind: Joint, before: boolean}} over */
function landing(box, { kind, before }) {
  const y = before ? box.top : box.bottom;
  const x = before ? box.left - 4 : box.right + 2;
  return kind === "series" ? `M${box.left - 4} ${y}H${box.right}` : `M${x} ${box.top}V${box.bottom}`;
}

/** @param {DragEvent} event @param {Store} store @param {(over: null) => void} setOver */
function dropKind(event, store, setOver) {
  event.preventDefault();
  setOver(null);
  const key = event.dataTransfer?.getData("text/x-element");
  const { tree } = present(store);
  const kind = kindsOf(store.get()).find((each) => each.key === key);
  const target = targetAt(event.clientX, event.clientY);
  if (!kind || !target || tree === null || partAt(tree, target.path) === null) return;
  event.stopPropagation();
  const name = newName(store, kind);
  const next = joinAt(tree, target.path, target.kind, leaf(name), target.before);
  drawNew(store, next, name, kind);
}

/** Dragging a symbol to another place of the network. @param {Store} store @param {PointerEvent} down
 * @param {Path} from @param {(over: any) => void} setOver */
function beginDrag(store, down, from, setOver) {
  if (down.button !== 0) return;
  const ended = new AbortController();
  let moved = false;
  /** @param {PointerEvent} event */
  const move = (event) => {
    moved ||= Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > FAR;
    if (moved) setOver(targetAt(event.clientX, event.clientY));
  };
  /** @param {PointerEvent} event */
  const up = (event) => {
    ended.abort();
    setOver(null);
    const target = moved && event.type === "pointerup" ? targetAt(event.clientX, event.clientY) : null;
    const { tree } = present(store);
    const part = tree && partAt(tree, from);
    if (!target || tree === null || part?.kind !== "element" || partAt(tree, target.path) === null) return;
    const next = moveTo(tree, from, target.path, target.kind, target.before);
    if (next !== tree) draw(store, next, placeOf(next, part.name));
  };
  const { signal } = ended;
  globalThis.addEventListener("pointermove", move, { signal });
  globalThis.addEventListener("pointerup", up, { signal });
  globalThis.addEventListener("pointercancel", up, { signal });
}

/** The text of the network, with what is wrong underlined. @param {{store: Store, text: string}} props */
function Text({ store, text }) {
  const state = store.get();
  const wrong = wrongIn(state);
  const tree = treeOf(state, text);
  const { elements = {} } = state.history.present.study;
  const missing = tree === null ? [] : names(tree).filter((name) => !(name in elements));
  const kinds = kindsOf(state);
  return html`<div class="text">
    <div class="underlined">
      <textarea id="network-text" rows="1" value=${text} aria-label="Network as text"
        title="| parallel, - series, brackets group, bridge(a, b, c, d, e)" spellcheck=${false}
        autocomplete="off" autocapitalize="off"
        aria-invalid=${wrong !== null} aria-describedby=${wrong ? "network-problem" : undefined}
        onInput=${textHandler((entered) =>
          store.change({ type: "drawn", text: entered.replace(/[\r\n]+/g, " ") }, "text"))}
        onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Enter" && event.preventDefault()}
        onBlur=${() => store.dispatch({ type: "rested" })} />
      <div class="marks" aria-hidden="true">
        ${wrong ? html`${text.slice(0, wrong.at[0])}<u>${text.slice(...wrong.at) || " "}</u>${text.slice(wrong.at[1])}`
          : text}${" "}</div>
    </div>
    ${wrong && html`<p id="network-problem" class="problem" role="alert">${wrong.sentence}</p>`}
    ${missing.map((name) => html`<p class="row" key=${name}>Add ${name} as
        ${kinds.map((kind) => html` <button type="button" key=${kind.key}
          onClick=${() => store.change({ type: "placed", place: ["elements", name], value: kind.example })}>${kind.key}
            </button>`)}</p>`)}
  </div>`;
}
