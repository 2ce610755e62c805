// The address holds the state: every field is a parameter of it, so that a link, the back button
// and a reload show the same page again.

import { BAND_FIELDS } from "./bands.js";

export const SELECTION = ["db", "sweep", "season", "time", "band", "at_range_m"];
const OTHERS = [...BAND_FIELDS, "quantity", "aspect", "range_m", "elevation_deg", "compare", "show", "turn", "zoom", "layer", "colours", "pictures", "outlines"];
export const FIELDS = [...SELECTION, ...OTHERS, ...SELECTION.map((f) => `b_${f}`)];

export function readAddress() {
  const given = new URLSearchParams(location.search);
  const state = {};
  for (const field of FIELDS) state[field] = given.get(field) ?? "";
  return state;
}

export function addressOf(state) {
  const out = new URLSearchParams();
  for (const field of FIELDS)
    if (state[field] !== "" && (state.compare || !field.startsWith("b_"))) out.set(field, state[field]);
  return `?${out}`;
}

// replace: a step that the back button need not know of.
export function writeAddress(state, { replace = false } = {}) {
  const address = addressOf(state);
  if (address === location.search) return;
  if (replace) history.replaceState(null, "", address);
  else history.pushState(null, "", address);
}

// The parameters of a selection for the server; prefix "b_": of the one compared with.
export function selectionParameters(state, prefix = "", as = "") {
  return Object.fromEntries(SELECTION.map((f) => [as + f, state[prefix + f]]));
}

// The chosen sweep, or undefined: its database has none (yet).
export const sweepOf = (state, prefix, contents) =>
  contents.database[Number(state[`${prefix}db`])]?.sweep?.find((s) => s.name === state[`${prefix}sweep`]);

// Returns true if a sweep can be chosen. For B, the sweep must share a viewpoint with A.
export function fits(state, prefix, contents, database, sweep) {
  const a = prefix === "" ? null : sweepOf(state, "", contents);
  return !a || a.shares.some((s) => s.db === database && s.sweep === sweep);
}

// Chooses the default for B: the same season in another database, or else another season, hour or
// sweep of the same database.
export function proposeOther(state, contents) {
  for (const f of SELECTION) state[`b_${f}`] = state[f];
  const { condition, shares } = sweepOf(state, "", contents);
  const elsewhere = shares.find((s) => String(s.db) !== state.db);
  const season = condition.find((c) => c.season !== state.season);
  const hour = condition.find((c) => c.time_utc !== state.time);
  const sweep = shares.find((s) => s.sweep !== state.sweep);
  if (elsewhere) Object.assign(state, { b_db: String(elsewhere.db), b_sweep: elsewhere.sweep });
  else if (season) state.b_season = season.season;
  else if (hour) state.b_time = hour.time_utc;
  else if (sweep) state.b_sweep = sweep.sweep;
  completeSelection(state, "b_", contents, () => {});
}

// Fills in what the address does not say, and replaces what there is not; `complain` is told in words.
export function completeSelection(state, prefix, contents, complain) {
  const pick = (field, known, what) => {
    const name = prefix + field;
    if (known.includes(state[name])) return;
    if (state[name] !== "") complain(`There is no ${what} “${state[name].slice(0, 80)}” here: shown is “${known[0]}”.`);
    state[name] = known[0];
  };
  const readable = contents.database.map((d, k) => (d.error ? -1 : k)).filter((k) => k >= 0);
  if (readable.length === 0) return null;
  const first = (list, good) => [...list.filter(good), ...list.filter((x) => !good(x))];
  const useful = (k) => contents.database[k].sweep.some((s) => fits(state, prefix, contents, k, s.name));
  pick("db", first(readable, useful).map(String), "database");
  const database = Number(state[`${prefix}db`]), sweeps = contents.database[database].sweep;
  if (sweeps.length === 0) return null;
  pick("sweep", first(sweeps.map((s) => s.name), (name) => fits(state, prefix, contents, database, name)), "sweep");
  const sweep = sweepOf(state, prefix, contents);
  pick("season", sweep.condition.map((c) => c.season), "season");
  const times = sweep.condition.filter((c) => c.season === state[`${prefix}season`]).map((c) => c.time_utc);
  // Another season keeps the hour of the day if it has it.
  const time = state[`${prefix}time`];
  if (!times.includes(time)) state[`${prefix}time`] = times.find((t) => time !== "" && t.slice(10) === time.slice(10)) ?? times[0];
  pick("band", sweep.band.map((b) => b.name), "band");
  pick("at_range_m", sweep.range_m.map(String), "range");
  return sweep;
}
