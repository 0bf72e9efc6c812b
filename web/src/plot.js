// A plot from its declaration: axes, curves, shading, points to take; read by pointer, by keyboard, as a table; saved.

import { Chip, DropDown, Table } from "./parts/controls.js";
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from "./parts/html.js";
import { indexAt, layoutOf, nearest, valueAt } from "./plots/layout.js";
import { pngOf, svgOf } from "./plots/saving.js";
import { csvOf, tableOf, thinned } from "./plots/table.js";
import { download, fileName } from "./remembering.js";
import { printed, shown } from "./state/scale.js";

/** @import { Declaration, Layout, Point, Name } from "./plots/layout.js" */
/** @import { Table as Numbers } from "./plots/table.js" */
/** Time that is shown elsewhere too. @typedef {{get: () => number, set: (at: number) => void,
 * subscribe: (told: (at: number) => void) => () => void}} Cursor */
/** `current`: whether the numbers are those of what is on the page, so that they can be saved; `switches`: the axes
 * that can be turned to a logarithmic scale; `picked`: the point that is looked at; `at`: the place that is read, where
 * several plots share it; `table`: where it has more than the curves. Without a plot there is a place for it.
 * @typedef {{plot: Declaration | null, current?: boolean, children?: any, switches?: ("x" | "y")[],
 * cursor?: Cursor | null, picked?: number | null,
 * look?: (point: number) => void, take?: (point: Point) => void, table?: Numbers,
 * at?: number | null, read?: (at: number | null) => void}} PlotProps */

/** A colour of curves, for styles. @param {string} token */
const curveColour = (token) => `var(--${token})`;

/** @param {PlotProps} props */
export function Plot({ plot, current = true, children, switches = [], cursor = null, table, ...more }) {
  const { picked = null, look = () => {}, take = () => {} } = more;
  const [place, size] = useSize();
  const [logs, setLogs] = useState(/** @type {{x?: boolean, y?: boolean}} */ ({}));
  const [zoom, setZoom] = useState(/** @type {[number, number] | null} */ (null));
  const [asTable, setAsTable] = useState(false);
  const [ownAt, ownRead] = useState(/** @type {number | null} */ (null));
  const [at, read] = more.read ? [more.at ?? null, more.read] : [ownAt, ownRead];
  const drawn = useRef(/** @type {SVGSVGElement | null} */ (null));
  const names = useRef(/** @type {Name[]} */ ([]));
  const declared = useMemo(() => plot && withLogs(plot, logs), [plot, logs]);
  const laid = useMemo(() => declared && size && layoutOf(declared, { ...size, zoom, before: names.current }),
    [declared, size, zoom]);
  useLayoutEffect(() => {
    names.current = laid?.names ?? [];
  }, [laid]);
  if (plot === null || declared === null) // with an empty second child, else what is typed among the first would go
    return html`<div class="plot"><div class="row plot-tools">${children}${null}</div>
      <div class="plot-area" ref=${place}></div></div>`;
  /** @param {"x" | "y"} axis */
  const chip = (axis) => html`<${Chip} key=${axis} on=${declared[axis].log ?? false}
    title=${`Logarithmic scale: ${plot[axis].what}`} set=${() => setLogs({ ...logs, [axis]: !declared[axis].log })}>
    log ${axis}<//>`;
  const reading = { plot: declared, laid, at, read, zoom, setZoom, cursor };
  const points = declared.points ?? [];
  const hasPoints = points.length > 0;
  return html`<div class="plot" data-keys=${hasPoints ? "Points" : "Plot"}
      onKeyDown=${hasPoints && pointKeys(points, laid, take)}>
    <div class="row plot-tools">${children}<div class="row plot-ends">
      ${zoom && html`<button type="button" onClick=${() => setZoom(null)}>Whole range</button>`}
      ${switches.map(chip)}
      <${Chip} on=${asTable} set=${() => setAsTable(!asTable)}>Table<//>
      <${SaveMenu} plot=${declared} table=${table} current=${current} drawn=${drawn} shown=${!asTable} />
    </div></div>
    <div class="plot-area" ref=${place}>
      ${asTable && html`<${NumberTable} plot=${declared} laid=${laid} table=${table} />`}
      ${!asTable && laid && html`<${Drawn} plot=${declared} laid=${laid} svg=${drawn} picked=${picked} look=${look}
          take=${take}><${Reading} ...${reading} /><//>
        ${!hasPoints && html`<${Reader} ...${reading} />`}`}
    </div>
  </div>`;
}

/** @param {Declaration} plot @param {{x?: boolean, y?: boolean}} logs @returns {Declaration} */
const withLogs = (plot, logs) => ({ ...plot, x: { ...plot.x, log: logs.x ?? plot.x.log },
  y: { ...plot.y, log: logs.y ?? plot.y.log } });

const SMALLEST = 11; // [px] of type

/** The place of a drawing, with its size and that of its type; null while it has none.
 * @returns {[any, {width: number, height: number, font: number} | null]} */
function useSize() {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  const [size, setSize] = useState(/** @type {{width: number, height: number, font: number} | null} */ (null));
  useLayoutEffect(() => {
    const element = place.current;
    if (!element) return undefined;
    const measure = () => {
      const { clientWidth: width, clientHeight: height } = element;
      const font = Math.max(SMALLEST, Math.round(0.78 * parseFloat(getComputedStyle(element).fontSize)));
      if (width > 0 && height > 0) setSize((before) =>
        (before?.width === width && before.height === height && before.font === font ? before
          : { width, height, font }));
    };
    measure();
    const sized = new ResizeObserver(measure);
    sized.observe(element);
    return () => sized.disconnect();
  }, []);
  return [place, size];
}

let clips = 0; // of the page: what `useId` gives is not unique among plots that come at different times

/** @param {{plot: Declaration, laid: Layout, svg: any, picked: number | null, look: (point: number) => void,
 * take: (point: Point) => void, children: any}} props */
function Drawn({ plot, laid, svg, picked, look, take, children }) {
  const { width, height, font, box, x, y, names } = laid;
  const clip = useMemo(() => `clip-${(clips += 1)}`, []);
  const points = plot.points ?? [];
  const near = (/** @type {PointerEvent} */ event) => nearestPoint(event, points, laid);
  const lines = points[picked ?? -1]?.lines ?? [];
  return html`<svg ref=${svg} class="drawn" width=${width} height=${height} viewBox=${`0 0 ${width} ${height}`}
      role=${points.length > 0 ? "group" : "img"} aria-label=${plot.title} style=${{ fontSize: `${font}px` }}
      onPointerMove=${points.length > 0 && ((/** @type {PointerEvent} */ event) => {
        const found = near(event);
        if (found !== null && found !== picked) look(found);
      })}
      onClick=${points.length > 0 && ((/** @type {PointerEvent} */ event) => {
        const found = near(event);
        if (found !== null) take(points[found]);
      })}>
    <clipPath id=${clip}><rect x=${box.left} y=${box.top - 1} width=${Math.max(0, box.right - box.left)}
      height=${Math.max(0, box.bottom - box.top + 2)} /></clipPath>
    ${laid.bands.map(({ kind, path }) => html`<path key=${kind} class=${`band ${kind}`} d=${path} />`)}
    <${Axes} laid=${laid} />
    ${laid.bars && html`<path class="bars" d=${laid.bars} />`}
    <g clip-path=${`url(#${clip})`}>
      ${plot.curves.map(({ name, colour, dash, pale, strong, loose, stale }, i) => !loose && html`<path key=${i}
        data-curve=${name}
        class=${["curve", dash && "dash", pale && "pale", strong && "strong", stale && "stale"].filter(Boolean)
          .join(" ")}
        style=${{ stroke: curveColour(colour) }} d=${laid.paths[i]} />`)}
      ${(plot.marks ?? []).map(({ x: at, text }) => html`<g key=${text} class="mark-at">
        <path d=${`M${x.at(at)} ${box.top}V${box.bottom}`} />
        <text x=${x.at(at) + font * 0.4} y=${box.top + font}>${text}</text></g>`)}
    </g>
    ${points.map((point, i) => html`<${Ring} key=${i} point=${point} x=${x.at(point.x)} y=${y.at(point.y)}
      colour=${plot.curves[point.curve].colour} picked=${i === picked} first=${i === (picked ?? 0)}
      look=${() => look(i)} />`)}
    ${names.map((name) => html`<text key=${name.name} class="name" x=${name.x} y=${name.y} text-anchor=${name.anchor}
      style=${{ fill: name.colour === "pale" ? undefined : curveColour(name.colour) }}>${name.name}</text>`)}
    ${laid.keys.map((key) => html`<g key=${key.text}><rect class=${`swatch-of ${key.kind}`} x=${key.x}
      y=${key.y - font * 0.85} width=${font} height=${font} /><text x=${key.x + font * 1.4} y=${key.y}>
      ${key.text}</text></g>`)}
    ${lines.length > 0 && html`<${Tip} laid=${laid} x=${x.at(points[picked ?? 0].x)} up=${y.at(points[picked ?? 0].y)}
      head=${lines[0]} rows=${lines.slice(1).map((name) => ({ name }))} />`}
    ${plot.note && html`<text x=${box.left} y=${laid.titles.x.y}>${plot.note(y)}</text>`}
    ${children}
  </svg>`;
}

/** @param {{laid: Layout}} props */
function Axes({ laid: { box, x, y, font, titles, heading } }) {
  const { left, right, top, bottom } = box;
  return html`<g class="axes">
    ${y.ticks.map(({ at, text }) => html`<path key=${`line ${text}`} class="grid" d=${`M${left} ${at}H${right}`} />
      <text key=${text} x=${left - font * 0.6} y=${at + font * 0.35} text-anchor="end">${text}</text>`)}
    ${x.ticks.map(({ at, text }) => html`<path key=${`line ${text}`} class="tick" d=${`M${at} ${bottom}v4`} />
      <text key=${text} x=${Math.min(at, right + font - 0.3 * font * text.length)} y=${bottom + font * 1.4}
        text-anchor="middle">${text}</text>`)}
    <path class="tick" d=${`M${left} ${bottom}H${right}`} />
    ${heading.map((line, i) => html`<text key=${`title ${i}`} class="title" x=${titles.y.x}
      y=${titles.y.y + 1.4 * i * font}>${line}</text>`)}
    <text class="title" x=${titles.x.x} y=${titles.x.y} text-anchor="end">${x.title}</text>
  </g>`;
}

const TARGET = 12; // [px] around a point that are it

/** @param {{point: Point, x: number, y: number, colour: string, picked: boolean, first: boolean,
 * look: () => void}} props */
function Ring({ point: { label, big, doubtful }, x, y, colour, picked, first, look }) {
  const stroke = doubtful ? undefined : curveColour(colour);
  return html`<g class=${`ring${doubtful ? " doubtful" : ""}`}>
    ${picked && html`<circle class="halo" data-screen="" cx=${x} cy=${y} r="10" />`}
    <circle cx=${x} cy=${y} r=${big ? 5.5 : 3.5} style=${{ stroke, fill: big ? stroke : undefined }} />
    <circle class="point" cx=${x} cy=${y} r=${TARGET} tabindex=${first ? 0 : -1} role="button" aria-label=${label}
      onFocus=${look}><title>${label}</title></circle>
  </g>`;
}

/** The point at a pointer, the nearest one. @param {PointerEvent} event @param {Point[]} points @param {Layout} laid */
function nearestPoint({ clientX, clientY, currentTarget }, points, { x, y }) {
  const { left, top } = /** @type {Element} */ (currentTarget).getBoundingClientRect();
  const far = points.map((point) => Math.hypot(x.at(point.x) - clientX + left, y.at(point.y) - clientY + top));
  const best = far.indexOf(Math.min(...far));
  return far[best] <= TARGET + 2 ? best : null;
}

/** What keys do at points: next and previous, another curve, the knee, and taking.
 * @param {Point[]} points @param {Layout | null} laid @param {(point: Point) => void} take */
const pointKeys = (points, laid, take) => (/** @type {KeyboardEvent} */ event) => {
  const target = /** @type {Element} */ (event.target);
  const all = [...(target.closest(".plot")?.querySelectorAll("circle.point") ?? [])];
  const here = all.indexOf(target);
  if (here < 0 || !laid || event.ctrlKey || event.metaKey || event.altKey) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (key === "Enter") take(points[here]);
  const next = key === "Enter" ? here : nextPoint(points, here, key, laid);
  if (next === null) return;
  event.preventDefault();
  event.stopPropagation();
  /** @type {SVGElement} */ (all[next]).focus();
};

/** @param {Point[]} points @param {number} here @param {string} key @param {Layout} laid @returns {number | null} */
function nextPoint(points, here, key, { x }) {
  const { curve, x: at } = points[here];
  /** @param {number} of */
  const those = (of) => points.flatMap((point, i) => (point.curve === of ? [i] : []));
  const own = those(curve);
  const place = own.indexOf(here);
  if (key === "ArrowRight") return own[Math.min(place + 1, own.length - 1)];
  if (key === "ArrowLeft") return own[Math.max(place - 1, 0)];
  if (key === "Home") return own[0];
  if (key === "End") return own[own.length - 1];
  if (key === "k") return own.find((i) => points[i].big) ?? here;
  if (key !== "ArrowUp" && key !== "ArrowDown") return null;
  const curves = [...new Set(points.map((point) => point.curve))];
  const other = curves[(curves.indexOf(curve) + (key === "ArrowDown" ? 1 : curves.length - 1)) % curves.length];
  const far = (/** @type {number} */ i) => Math.abs(x.at(points[i].x) - x.at(at));
  return those(other).reduce((best, i) => (far(i) < far(best) ? i : best));
}

/** @typedef {{plot: Declaration, laid: Layout, at: number | null, read: (at: number | null) => void,
 * zoom: [number, number] | null, setZoom: (zoom: [number, number] | null) => void,
 * cursor: Cursor | null}} ReaderProps */

/** The place that is read and the values of all curves there; the time of the picture. @param {ReaderProps} props */
function Reading({ plot, laid, at, cursor }) {
  const { box, x } = laid;
  const line = at === null || at < x.from || at > x.to ? null : x.at(at);
  return html`<g data-screen="" aria-hidden="true">
    ${cursor && html`<${CursorLine} cursor=${cursor} laid=${laid} />`}
    ${line !== null && html`<path class="cross" d=${`M${line} ${box.top}V${box.bottom}`} />
      <${Tip} laid=${laid} x=${line} ...${readingAt(plot, laid, /** @type {number} */ (at), MOST)} />`}
  </g>`;
}

/** @param {{cursor: Cursor, laid: Layout}} props */
function CursorLine({ cursor, laid: { box, x } }) {
  const [now, setNow] = useState(cursor.get());
  useEffect(() => cursor.subscribe(setNow), [cursor]);
  if (now < x.from || now > x.to) return null;
  const at = x.at(now);
  return html`<path class="cursor" data-at=${now}
    d=${`M${at} ${box.top}V${box.bottom}M${at - 5} ${box.top - 1}h10l-5 7z`} />`;
}

/** What the curves are at a place, as texts; of many the first. @param {Declaration} plot @param {Layout} laid
 * @param {number} at @param {number} most
 * @returns {{head: string, rows: {name: string, text: string, colour: string}[]}} */
function readingAt(plot, { x, y }, at, most = Infinity) {
  const head = `${shown(at / x.size, 4)} ${printed(x.unit)}`.trim();
  const rows = plot.curves.map((curve) => ({ name: curve.name, colour: curve.colour, value: valueAt(curve, at) }));
  return { head, rows: rows.filter(({ value }) => value !== null).slice(0, most).map(({ value, ...row }) =>
    ({ ...row, text: shown(/** @type {number} */ (value) / y.size, 4) })) };
}

const MOST = 8; // values in the tip

/** What is read at a place, or at a point that is `up` there; texts are beside the names of their curves.
 * @param {{laid: Layout, x: number, up?: number, head: string, rows: {name: string, text?: string,
 * colour?: string}[]}} props */
function Tip({ laid, x, up, head, rows }) {
  const { font } = laid;
  const letters = [head, ...rows.map(({ name, text = "" }) => `${name}  ${text}`.trim())].map(({ length }) => length);
  const wide = Math.max(...letters) * font * 0.62 + font * 1.6;
  const { left, top } = freePlace(laid, x, wide, (rows.length + 1) * font * 1.4 + font * 0.8, up);
  const line = (/** @type {number} */ i) => top + font * (1.5 + 1.4 * i);
  return html`<g class="tip" data-screen=""><rect x=${left} y=${top} width=${wide}
      height=${(rows.length + 1) * font * 1.4 + font * 0.8} rx="5" />
    <text class="head" x=${left + font * 0.8} y=${line(0)}>${head}</text>
    ${rows.map(({ name, text, colour }, i) => html`<text key=${i} x=${left + font * 0.8} y=${line(i + 1)}><tspan
      class=${colour && "of"} style=${colour && { fill: curveColour(colour) }}>${name}</tspan>${text
      && html`<tspan x=${left + wide - font * 0.8} text-anchor="end">${text}</tspan>`}</text>`)}</g>`;
}

/** Where the fewest points of curves are, of the corners at a place that is read, or at a point. @param {Layout} laid
 * @param {number} place @param {number} wide @param {number} high @param {number} [up] */
function freePlace({ box, font, dots }, place, wide, high, up) {
  const ends = [box.top + 2, Math.max(box.top + 2, box.bottom - high - 2)];
  const near = up === undefined ? [] : [up - high - font, up + font, up - high / 2];
  const tops = [...near.filter((top) => top >= ends[0] && top <= ends[1]), ...ends];
  const lefts = [place + font, place - wide - font, place - wide / 2, box.left + font, box.right - wide];
  const corners = tops.flatMap((top) => lefts.map((left) =>
    ({ left: Math.max(0, Math.min(left, box.right + font - wide)), top })));
  const hidden = corners.map(({ left, top }) => {
    const covers = place > left - font && place < left + wide + font
      && (up === undefined || (up > top - font && up < top + high + font));
    return (covers ? (up === undefined ? 20 : 1000) : 0) + dots.filter(([x, y]) =>
      x > left - 3 && x < left + wide + 3 && y > top - 3 && y < top + high + 3).length;
  });
  return corners[hidden.indexOf(Math.min(...hidden))] ?? { left: box.left, top: tops[0] };
}

const DRAGGED = 5; // [px] from where a press is a drag

/** Reads a plot by pointer and keyboard: a slider over the axis below. @param {ReaderProps} props */
function Reader({ plot, laid, at, read, zoom, setZoom, cursor }) {
  const { box, x } = laid;
  const drag = useRef(/** @type {{begin: number, zooms: boolean} | null} */ (null));
  const [span, setSpan] = useState(/** @type {[number, number] | null} */ (null));
  const samples = plot.curves[0]?.x ?? [];
  /** @param {PointerEvent} event */
  const under = ({ clientX, currentTarget }) => {
    const { left } = /** @type {Element} */ (currentTarget).getBoundingClientRect();
    return Math.min(box.right, Math.max(box.left, clientX - left + box.left));
  };
  /** @param {number} value */
  const snapped = (value) => samples[nearest(samples, value)] ?? value;
  const place = cursor ? cursor.get() : at;
  const { head, rows } = place === null ? { head: "", rows: [] } : readingAt(plot, laid, place);
  const go = (/** @type {number} */ value) => (cursor ? cursor.set(value) : null, read(value));
  return html`<div class="plot-reader" role="slider" tabindex="0" aria-label=${`${plot.title}: read at`}
    aria-valuemin=${x.from} aria-valuemax=${x.to} aria-valuenow=${place ?? x.from}
    aria-valuetext=${`${head}: ${rows.map(({ name, text }) => `${name} ${text}`).join(", ")}`}
    style=${{ left: `${box.left}px`, top: `${box.top}px`, width: `${Math.max(0, box.right - box.left)}px`,
      height: `${Math.max(0, box.bottom - box.top)}px` }}
    onPointerDown=${(/** @type {PointerEvent} */ event) => {
      if (event.button !== 0) return;
      /** @type {Element} */ (event.currentTarget).setPointerCapture(event.pointerId);
      drag.current = { begin: under(event), zooms: cursor === null || event.shiftKey };
      if (cursor && !event.shiftKey) cursor.set(x.of(under(event)));
    }}
    onPointerMove=${(/** @type {PointerEvent} */ event) => {
      const now = under(event);
      read(snapped(x.of(now)));
      if (drag.current?.zooms && event.pointerType !== "touch") setSpan([drag.current.begin, now]);
      else if (drag.current && cursor) cursor.set(x.of(now));
    }}
    onPointerUp=${(/** @type {PointerEvent} */ event) => {
      const ends = drag.current?.zooms ? [drag.current.begin, under(event)].toSorted((a, b) => a - b) : [0, 0];
      if (ends[1] - ends[0] > DRAGGED && span) setZoom([x.of(ends[0]), x.of(ends[1])]);
      drag.current = null;
      setSpan(null);
    }}
    onPointerLeave=${() => drag.current === null && read(null)}
    onDblClick=${() => setZoom(null)}
    onFocus=${(/** @type {Event} */ { currentTarget }) => {
      const byKey = /** @type {Element} */ (currentTarget).matches(":focus-visible");
      if (place === null && byKey) read(snapped(x.of((box.left + box.right) / 2)));
    }}
    onBlur=${() => read(null)}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => {
      const from = (cursor ? cursor.get() : at) ?? x.from; // the time may run on
      const next = steppedBy(event, samples, from, laid);
      const shift = zoomedBy(event.key, laid, from);
      if (next === null && shift === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      if (next !== null) go(next);
      if (shift !== undefined) setZoom(shift);
    }}>
    ${span && html`<div class="plot-span" style=${{ left: `${Math.min(...span) - box.left}px`,
      width: `${Math.abs(span[1] - span[0])}px` }}></div>`}</div>`;
}

/** Where a key leads, null if it leads nowhere. @param {KeyboardEvent} event @param {number[]} samples
 * @param {number} from @param {Layout} laid @returns {number | null} */
function steppedBy({ key, shiftKey, ctrlKey, metaKey, altKey }, samples, from, { x }) {
  if (ctrlKey || metaKey || altKey || samples.length === 0) return null;
  const sign = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[key] ?? 0;
  if (key === "Home") return samples[nearest(samples, x.from)];
  if (key === "End") return samples[nearest(samples, x.to)];
  if (sign === 0) return null;
  const i = indexAt(samples, from);
  const near = nearest(samples, x.of(x.at(from) + sign * (shiftKey ? 20 : 2)));
  const next = near === i || samples[near] === from ? i + sign : near;
  return samples[Math.min(samples.length - 1, Math.max(0, next))];
}

/** The range after a key, undefined if it changes none. @param {string} key @param {Layout} laid @param {number} at
 * @returns {[number, number] | null | undefined} */
function zoomedBy(key, { x, box }, at) {
  if (key === "0" || key === "Escape") return null;
  const part = { "+": 0.5, "=": 0.5, "-": 2 }[key];
  if (part === undefined) return undefined;
  const middle = Math.min(box.right, Math.max(box.left, x.at(at)));
  const [from, to] = [box.left, box.right].map((end) => x.of(middle + (end - middle) * part));
  return [from, to];
}

const ROWS = 100; // of a table that is looked at

/** The plot with the units that stand at its axes.
 * @param {Declaration} plot @param {Layout} laid @returns {Declaration} */
const inUnitsOf = (plot, { x, y }) => ({ ...plot, x: { ...plot.x, unit: x.unit, size: x.size },
  y: { ...plot.y, unit: y.unit, size: y.size } });

/** @param {{plot: Declaration, laid: Layout | null, table?: Numbers}} props */
function NumberTable({ plot, laid, table }) {
  const { heads, rows, every } = thinned(table ?? tableOf(laid ? inUnitsOf(plot, laid) : plot), ROWS);
  return html`<div class="plot-table"><${Table} label=${`${plot.title}, numbers`} heads=${heads}>
      ${rows.map((row, i) => html`<tr key=${i}>${row.map((value) => html`<td class="number">
        ${typeof value === "string" ? value : shown(value)}</td>`)}</tr>`)}<//>
    ${every > 1 && html`<p class="quiet">One of ${every} rows; the CSV file has all.</p>`}</div>`;
}

/** @param {{plot: Declaration, table?: Numbers, current: boolean, drawn: {current: SVGSVGElement | null},
 * shown: boolean}} props */
function SaveMenu({ plot, table, current, drawn, shown: isDrawn }) {
  const name = fileName(plot.title);
  const picture = () => /** @type {SVGSVGElement} */ (drawn.current);
  const ground = () => getComputedStyle(/** @type {Element} */ (picture().parentElement)).backgroundColor;
  /** @param {string} kind @param {() => Promise<Blob> | Blob} make @param {boolean} possible */
  const button = (kind, make, possible) => html`<button type="button" disabled=${!current || !possible}
    title=${current ? undefined : "The numbers are being computed"} onClick=${async (/** @type {Event} */ event) => {
      /** @type {Element} */ (event.currentTarget).closest("details")?.removeAttribute("open");
      download(await make(), `${name}.${kind.toLowerCase()}`);
    }}>${kind}</button>`;
  /** @param {string} text @param {string} type */
  const blob = (text, type) => new Blob([text], { type });
  return html`<${DropDown} title="Figure">
    ${button("SVG", () => blob(svgOf(picture(), ground()), "image/svg+xml"), isDrawn)}
    ${button("PNG", () => pngOf(picture(), ground()), isDrawn)}
    ${button("CSV", () => blob(csvOf(table ?? tableOf(plot)), "text/csv"), true)}<//>`;
}
