// Sliders on a logarithmic scale, and quantities as they are written: a number and a unit.

import { own } from "./document.js";

export const STEPS = 400;
const SMALL = 1e-4; // below it, zeros after the point are hard to count
const PLAIN = 9; // digits before the point up to which a number has no power of ten
const NUMBER = /^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*$/;

/** @typedef {{number: number, unit: string}} Written */

/** A quantity's number and unit as they stand, or null. @param {unknown} text @returns {Written | null} */
export function takenApart(text) {
  const match = typeof text === "string" ? NUMBER.exec(text) : null;
  return match && { number: Number(match[1]), unit: match[2] };
}

/** @param {number} number @param {string} unit */
export const quantity = (number, unit) => `${shortest(number)} ${unit}`.trim();

/** What was typed in the place of a quantity: a number without a unit has the unit that stands there, and a name is the
 * value of that name, such as a class of roads. @param {string} typed @param {string} before
 * @param {{[name: string]: string}} [names] */
export function completed(typed, before, names = {}) {
  const unit = takenApart(before)?.unit ?? "";
  const name = typed.replace(/^class\s*/i, "").toLowerCase();
  const named = Object.keys(names).find((each) => each.toLowerCase() === name);
  return named ? names[named] : (takenApart(typed)?.unit === "" ? `${typed} ${unit}`.trim() : typed);
}

/** A quantity as a person writes it, of many digits with five of them, and then in the unit that suits it if it is in
 * the SI unit. @param {string} text @param {any} [about] @param {string} [unit] @returns {string} */
export function brief(text, about = null, unit = "") {
  const apart = takenApart(text);
  if (apart === null || !/\d[\d.]{6,}/.test(text)) return printed(text);
  return apart.unit === unit ? briefIn(about, text, unit) : inFive(apart);
}

/** @param {{number: number, unit: string}} quantity */
const inFive = ({ number, unit }) => printed(`${Number(number.toPrecision(5))} ${unit}`.trim());

/** The same of a value that was found, in the unit that suits it if it stands in the SI unit.
 * @param {any} about @param {string} text @param {string} unit @returns {string} */
export function briefIn(about, text, unit) {
  const apart = takenApart(text);
  if (apart === null || apart.unit !== unit) return brief(text);
  const own = unitFor(about, [apart.number], unit);
  return inFive({ number: apart.number * own.factor, unit: own.unit });
}

/** A number with four digits or fewer, as a person writes it; small ones have a power of ten. @param {number} number */
function shortest(number) {
  const rounded = Number(number.toPrecision(4));
  return rounded !== 0 && Math.abs(rounded) < SMALL ? rounded.toExponential() : String(rounded);
}

/** @param {number} value @param {number} lower @param {number} upper */
export function positionOf(value, lower, upper) {
  const share = Math.log(value / lower) / Math.log(upper / lower);
  return Number.isFinite(share) ? Math.round(STEPS * Math.min(1, Math.max(0, share))) : 0;
}

/** @param {number} position @param {number} lower @param {number} upper */
export const valueAt = (position, lower, upper) => lower * (upper / lower) ** (position / STEPS);

/** A number as answers show it, by the rules of the library: with a power of ten only far from 1.
 * @param {number | null | undefined} number @param {number} digits */
export function shown(number, digits = 5) {
  const [mantissa, ten] = mantissaAndTen(number, digits);
  return mantissa === "1" && ten !== "" ? ten : joined(mantissa, ten);
}

/** A number with so many digits, zeros at the end too, as in the columns of a table.
 * @param {number | null | undefined} number @param {number} digits */
export function aligned(number, digits) {
  const [text, ten] = mantissaAndTen(number, digits);
  const missing = digits - text.replace(/^\D*0*\.?0*|\D/g, "").length;
  const padded = missing <= 0 || !/[1-9]/.test(text) ? text
    : text.replace(/^(−?\d+)(\.\d+)?/, (_, whole, part = ".") => `${whole}${part}${"0".repeat(missing)}`);
  return joined(padded, ten);
}

/** A number, and the power of ten behind it, if it has one. @param {number | null | undefined} number
 * @param {number} digits @returns {[string, string]} */
function mantissaAndTen(number, digits) {
  if (number === null || number === undefined || Number.isNaN(number)) return ["–", ""];
  const rounded = Number(number.toPrecision(digits));
  const isNear = Math.abs(rounded) >= SMALL && Math.abs(number) < 10 ** Math.max(digits, PLAIN);
  if (rounded === 0 || isNear) return [minus(rounded), ""];
  const [mantissa, power] = number.toExponential(digits - 1).split("e");
  return [minus(Number(mantissa)), tenTo(Number(power))];
}

/** @param {string} mantissa @param {string} ten */
const joined = (mantissa, ten) => (ten === "" ? mantissa : `${mantissa} × ${ten}`);

/** @param {number} power */
const tenTo = (power) => `10${superscript(String(power))}`;

/** Values of a design in few digits, in units that suit them; those `at` a bound have a star.
 * @param {any} about @param {{[name: string]: unknown}} texts @param {object} [at] */
export const valuesIn = (about, texts, at = {}) => Object.entries(texts).map(([name, text]) =>
  `${name} = ${briefIn(about, String(text), takenApart(text)?.unit ?? "")}${name in at ? "*" : ""}`
    .replaceAll(" ", "\u00a0")).join(", ");

/** A number with so many places after the point, or before it where these are negative, as in the columns of a table;
 * with five digits at most, also where there is no number of places. @param {number | null | undefined} number
 * @param {number | null | undefined} places */
export function toPlaces(number, places) {
  if (typeof number !== "number" || typeof places !== "number" || number === 0) return shown(number);
  return aligned(number, Math.min(5, Math.max(1, places + 1 + Number(number.toExponential(15).split("e")[1]))));
}

/** A value and its error with as many places as the error tells, and no more than `most`: one digit of it, or two if
 * the first is 1; both times the same power of ten.
 * @param {number} value @param {number} error @param {number} most @returns {[string, string]} */
export function withError(value, error, most = Infinity) {
  const power = Math.floor(Math.log10(Math.max(Math.abs(value), error)));
  const far = power >= 6 || power < -3;
  const factor = far ? 10 ** -power : 1;
  const [number, scatter] = [value * factor, error * factor];
  const leading = scatter.toExponential(0);
  const one = -Number(leading.split("e")[1]);
  const wanted = one + (leading.startsWith("1") ? 1 : 0);
  const places = Math.min(20, Math.max(0, one, Math.min(wanted, most + (far ? power : 0))));
  /** @param {number} each */
  const written = (each) => joined(each.toFixed(places).replace("-", "−"), far ? tenTo(power) : "");
  return [written(number), written(scatter)];
}

/** @param {number} number */
const minus = (number) => String(number).replace("-", "−");

const SUPERSCRIPTS = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";

/** The digits and the minus sign of a number as superscripts. @param {string} text */
export const superscript = (text) => [...text].map((digit) => SUPERSCRIPTS["-0123456789".indexOf(digit)]).join("");

/** A unit, or a quantity, as a person writes it. @param {string} text */
export const printed = (text) => text.replace(/\^(-?\d+)/g, (_, power) => superscript(power))
  .replace(/(\d)e\+?(-?\d+)/i, (_, digit, power) => `${digit} × ${tenTo(Number(power))}`)
  .replace(/\bum\b/g, "µm");

const SYMBOL = /^([A-Za-z])(?:_(.+)|(\d\w*|[A-Za-z]\d*|[^\W\d_aeiouAEIOU][A-Za-z]\d*))$/;

/** A symbol and its subscript: of a letter with few others behind it, or with an underscore; of a word there is none,
 * which has a vowel after its first letter if it is so short.
 * @param {string} name @returns {[string, string]} */
export function symbolParts(name) {
  const [, letter, after, close] = SYMBOL.exec(name) ?? [];
  return letter ? [letter, after ?? close] : [name, ""];
}

/** A unit in which values are written: they times `factor`. @typedef {{unit: string, factor: number}} WrittenUnit */

/** The unit that suits the middle one of some values in an SI unit, by the table of the library.
 * @param {any} about @param {unknown[]} values @param {string} unit @returns {WrittenUnit} */
export function unitFor(about, values, unit) {
  const sizes = values.filter((value) => typeof value === "number" && Number.isFinite(value) && value !== 0)
    .map((value) => Math.abs(/** @type {number} */ (value))).toSorted((one, other) => one - other);
  const [low, high] = [sizes[(sizes.length - 1) >> 1], sizes[sizes.length >> 1]];
  const size = sizes.length === 0 ? 1 : Number(((low + high) / 2).toPrecision(4));
  /** @type {(WrittenUnit & {least: number, most: number})[]} */
  const choices = own(about?.units, unit) ?? [];
  return choices.find(({ least, most }) => size >= least && size < most) ?? { unit, factor: 1 };
}

/** A result in the unit in which it is written. @template {{value?: any, standard_error?: any, decimals?: any}} Result
 * @param {Result} result @param {number} factor @returns {Result} */
export const scaled = (result, factor) => (factor === 1 ? result : { ...result, value: times(result.value, factor),
  standard_error: times(result.standard_error, factor),
  decimals: typeof result.decimals === "number" ? result.decimals - Math.round(Math.log10(factor)) : result.decimals });

/** A number times a factor; what is none stays. @param {any} value @param {number} factor */
export const times = (value, factor) => (typeof value === "number" ? value * factor : value);

/** A text as the beginning of a sentence. @param {string} text */
export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** What a number is, with its unit in brackets if it has one.
 * @param {string} what @param {string | null | undefined} unit */
export const withUnit = (what, unit) => (unit ? `${what} [${printed(unit)}]` : what);

/** Struts in words. @param {(string | null)[]} struts */
export const strutWords = (struts) => listed(struts).replaceAll("_", " ");

/** Names as a sentence lists them. @param {(string | null)[]} names */
export const listed = (names) => [names.slice(0, -1).join(", "), ...names.slice(-1)].filter(Boolean).join(" and ");
