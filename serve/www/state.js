// What is shown is the address: every field of the state is a parameter of it, so that a link, the
// back button and a reload show the same again.

import { BAND_FIELDS } from "./bands.js";

export const SELECTION = ["db", "sweep", "season", "time", "band", "at_range_m"];
const OTHERS = [...BAND_FIELDS, "quantity", "aspect", "range_m", "elevation_deg", "compare", "show", "turn", "zoom"];
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
  pick("db", readable.map(String), "database");
  const sweeps = contents.database[Number(state[`${prefix}db`])].sweep;
  if (sweeps.length === 0) return null;
  pick("sweep", sweeps.map((s) => s.name), "sweep");
  const sweep = sweeps.find((s) => s.name === state[`${prefix}sweep`]);
  pick("season", sweep.condition.map((c) => c.season), "season");
  const times = sweep.condition.filter((c) => c.season === state[`${prefix}season`]).map((c) => c.time_utc);
  // Another season keeps the hour of the day if it has it.
  const hour = state[`${prefix}time`].slice(10);
  const same = times.find((t) => t.slice(10) === hour);
  if (same && hour !== "") state[`${prefix}time`] = same;
  else if (!times.includes(state[`${prefix}time`])) state[`${prefix}time`] = times[0];
  pick("band", sweep.band.map((b) => b.name), "band");
  pick("at_range_m", sweep.range_m.map(String), "range");
  return sweep;
}
