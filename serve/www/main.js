// Keeps what is shown in step with the address: every change goes into the state, the state into
// the address, and from there everything is asked for and drawn.
import { addressOf, ask, askAnew, forget } from "./api.js";
import { bandParameters, bestWindows, drawBands, fillBandForm } from "./bands.js";
import { scaleOf } from "./colors.js";
import { fillControls, QUANTITIES } from "./controls.js";
import { drawCut } from "./cut.js";
import { budget, ledger, progress, values } from "./details.js";
import { html, Panel, svg } from "./draw.js";
import { Hemisphere } from "./hemisphere.js";
import { aspectText, brief, degrees, displayUnit, tickLabels, ticks, withError } from "./numbers.js";
import { CAUSES, causesOf, drawSpectrum, legend } from "./spectrum.js";
import { completeSelection, readAddress, SELECTION, selectionParameters, writeAddress } from "./state.js";

const $ = (id) => document.getElementById(id);
const panel = Object.fromEntries(["map", "values", "spectrum", "cut", "budget", "bands", "ledger"].map((id) => [id, new Panel(id)]));
const elevation = $("elevation");
const readouts = { map: $("dome-readout"), cut: panel.cut.readout, spectrum: panel.spectrum.readout };

let contents, state;
let shown = null;    // aspects and values of the map: {azimuth, elevation, row, b_row, value, words(k)}
let chosen = -1;     // of them
let run = 0;         // answers to an older one are dropped

const dome = new Hemisphere($("dome"), {
  hover: (k) => { sayAspect(k < 0 ? chosen : k); showImage(k < 0 ? chosen : k); },
  choose: (k) => change({ aspect: `${shown.azimuth[k]},${shown.elevation[k]}` }),
  turn: () => {
    const { azimuth, elevation: up, zoom } = dome.turn;
    change({ turn: `${azimuth.toFixed(1)},${up.toFixed(1)}`, zoom: zoom === 1 ? "" : zoom.toFixed(2) }, { replace: true, redraw: false });
  },
});

function change(fields, { replace = false, redraw = true } = {}) {
  Object.assign(state, fields);
  const names = Object.keys(fields);
  const small = names.every((f) => ["time", "b_time", "range_m", "aspect", "turn", "zoom", "elevation_deg"].includes(f));
  complete();
  writeAddress(state, { replace: replace || names.some((f) => f.endsWith("time")) });
  if (!small) fillControls($("controls"), state, contents, change);
  if (redraw) refresh();
}

// What the address leaves open is filled in; what it asks for in vain is said.
function complete() {
  const wrong = contents.database.filter((d) => d.error).map((d) => `${d.name}: ${d.error}`);
  const complain = (words) => wrong.push(words);
  let there = completeSelection(state, "", contents, complain);
  if (there && state.compare) {
    const fresh = SELECTION.every((f) => state[`b_${f}`] === "");
    if (fresh) {
      for (const f of SELECTION) state[`b_${f}`] = state[f];
      const other = contents.database.findIndex((d, k) => String(k) !== state.db && !d.error);
      const season = there.condition.find((c) => c.season !== state.season);
      if (other >= 0) Object.assign(state, { b_db: String(other), b_sweep: "" });
      else if (season) Object.assign(state, { b_season: season.season });
    }
    there = completeSelection(state, "b_", contents, complain) && there;
  }
  if (!QUANTITIES.some(([name]) => name === state.quantity)) {
    if (state.quantity !== "") complain(`There is no quantity “${state.quantity.slice(0, 80)}”: shown is the intensity.`);
    state.quantity = "intensity";
  }
  if (!there && wrong.length === 0) complain("This database holds no sweep yet.");
  const trouble = $("trouble");
  trouble.textContent = wrong.join(" ");
  trouble.hidden = wrong.length === 0;
  return there;
}

const selectionA = () => ({ ...selectionParameters(state), quantity: state.quantity });
const both = () => ({ ...selectionA(), ...selectionParameters(state, "b_", "b_") });
const rowOf = (k, which = "") => ({ db: state[`${which}db`], sweep: state[`${which}sweep`], row: which ? shown.b_row[k] : shown.row[k] });
const detail = (k, which = "") => ({ ...rowOf(k, which), quantity: state.quantity, range_m: state.range_m });

// Every panel by itself: what fails in one is said there and nowhere else.
async function fill(id, mine, work) {
  try {
    await work();
  } catch (error) {
    if (mine === run) panel[id].fail(error.message);
  }
}

async function askMap() {
  if (!state.compare) {
    const m = await ask("/api/map", selectionA());
    return { ...m, azimuth: m.azimuth_deg, elevation: m.elevation_deg, around0: false, shown_unit: m.unit, shown_title: m.title,
      words: (k) => withError(m.value[k], m.error[k], m.unit) };
  }
  const c = await ask("/api/compare", both());
  const show = state.show || "difference";
  const difference = show === "difference";
  return { ...c, azimuth: c.azimuth_deg, elevation: c.elevation_deg, row: c.a_row, value: difference ? c.sigmas : c[show], around0: difference,
    shown_unit: difference ? "σ" : c.unit, shown_title: difference ? `B − A of the ${c.title.toLowerCase()}` : `${c.title} of ${show.toUpperCase()}`,
    words: (k) => `A ${withError(c.a[k], c.a_error[k], c.unit)}, B ${withError(c.b[k], c.b_error[k], c.unit)}, B − A ${brief(c.sigmas[k], 3)} σ` };
}

function choose() {
  const [azimuth, up] = state.aspect.split(",").map(Number);
  if (state.aspect === "" || !Number.isFinite(azimuth) || !Number.isFinite(up)) return chooseFirst();
  let best = 0, least = Infinity;
  const RAD = Math.PI / 180;
  shown.azimuth.forEach((a, k) => {
    const e = shown.elevation[k];
    const apart = Math.acos(Math.min(1, Math.sin(e * RAD) * Math.sin(up * RAD) + Math.cos(e * RAD) * Math.cos(up * RAD) * Math.cos((a - azimuth) * RAD)));
    if (apart < least - 1e-9) [best, least] = [k, apart];
  });
  return best;
}
// Nearest to the beam, not high up: where most is seen of most targets.
function chooseFirst() {
  let best = 0, least = Infinity;
  shown.azimuth.forEach((a, k) => {
    const apart = Math.abs(a - 90) + 2 * Math.abs(shown.elevation[k] - 10);
    if (apart < least) [best, least] = [k, apart];
  });
  return best;
}

async function refresh() {
  const mine = ++run;
  document.querySelector("main").hidden = false;
  document.body.setAttribute("aria-busy", "true");
  let map = null;
  try {
    map = await askMap();
  } catch (error) {
    if (mine !== run) return;
    shown = null;
    for (const id of Object.keys(panel)) panel[id].fail(error.message);
    hideImage("");
  }
  if (mine !== run) return;
  if (map) {
    shown = map;
    chosen = choose();
    await fill("map", mine, showMap);
    await Promise.all([showRow(mine), showSpectrum(mine), showCut(mine), showBands(mine)]);
    showImage(chosen);
  }
  if (mine === run) document.body.removeAttribute("aria-busy");
}

function showMap() {
  const scale = scaleOf(shown.value, { around0: shown.around0 });
  panel.map.show();
  panel.map.title(shown.shown_title);
  dome.setData(shown.azimuth, shown.elevation, shown.value, scale);
  dome.choose(chosen);
  const [azimuth, up] = (state.turn || "180,90").split(",").map(Number);
  if (Number.isFinite(azimuth) && Number.isFinite(up)) dome.look(azimuth, up, Number(state.zoom) || 1);
  drawBar(scale, shown.shown_unit);
  sayAspect(chosen);
  const files = state.compare ? [["CSV", addressOf("/file/compare.csv", both())]]
    : [["CSV", addressOf("/file/rows.csv", selectionA())], ["SVG", addressOf("/file/map.svg", selectionA())]];
  panel.map.offer(shown.command, files);
}

function drawBar(scale, plain) {
  const width = 400, { unit, factor } = plain === "σ" ? { unit: plain, factor: 1 } : displayUnit(Math.max(Math.abs(scale.low), Math.abs(scale.high)), plain);
  const at = ticks(scale.low, scale.high, 5), labels = tickLabels(at, factor);
  const x = (v) => 24 + (width - 80) * (v - scale.low) / (scale.high - scale.low);
  const steps = Array.from({ length: 64 }, (_, k) => svg("rect", { x: 24 + (width - 80) * k / 64, y: 2, width: (width - 80) / 64 + 0.5, height: 12, fill: scale.css(Math.round(255 * k / 63)) }));
  $("bar").replaceChildren(svg("svg", { viewBox: `0 0 ${width} 34`, class: "plot", role: "img", "aria-label": `Colours from ${labels[0]} to ${labels.at(-1)} ${unit}` },
    ...steps, ...at.map((v, k) => svg("text", { class: "middle", x: x(v), y: 29 }, labels[k])), svg("text", { x: width - 50, y: 13 }, unit)));
}

function sayAspect(k) {
  if (!shown || k < 0) return;
  const words = `${aspectText(shown.azimuth[k], shown.elevation[k])}: ${shown.words(k)}`;
  if (readouts.map.textContent !== words) readouts.map.textContent = words;
}

// The stored image of the viewpoint under the pointer.
const image = $("image").querySelector("img"), imageWords = $("image").querySelector(".words"), imageCaption = $("image").querySelector("figcaption");
function hideImage(words) {
  image.hidden = true;
  imageWords.textContent = words;
  imageWords.hidden = words === "";
  imageCaption.textContent = "";
}
function showImage(k) {
  if (!shown || k < 0) return;
  const sweep = contents.database[Number(state.db)].sweep.find((s) => s.name === state.sweep);
  if (!sweep.thumbnails) return hideImage("This sweep was computed without images.");
  const address = addressOf("/api/thumbnail.png", rowOf(k));
  const where = aspectText(shown.azimuth[k], shown.elevation[k]);
  if (image.dataset.address === address) return undefined;
  image.dataset.address = address;
  image.onerror = async () => {
    try {
      await askAnew(address);
    } catch (error) {
      if (image.dataset.address === address) hideImage(error.message);
    }
  };
  image.onload = () => {
    image.hidden = false;
    imageWords.hidden = true;
    imageCaption.textContent = `${where}: radiance in the band, black to its own brightest pixel`;
  };
  image.alt = `The target from ${where}`;
  image.src = address;
  return undefined;
}

function differenceOf(a, b) {
  // At another range than the stored one the errors' difference is not stored.
  if (!b || state.range_m !== "") return null;
  return { value: shown.difference[chosen], error: shown.difference_error[chosen], sigmas: shown.sigmas[chosen], unit: shown.unit };
}

function showRow(mine) {
  const asked = detail(chosen);
  return fill("values", mine, async () => {
    let row, other = null;
    try {
      [row, other] = await Promise.all([ask("/api/row", asked), state.compare ? ask("/api/row", detail(chosen, "b_")) : null]);
    } catch (error) {
      for (const id of ["budget", "ledger"]) if (mine === run) panel[id].fail(error.message);
      throw error;
    }
    if (mine !== run) return;
    panel.values.show(...values(row, other, differenceOf(row, other)));
    panel.values.offer(other ? `${row.command}\n${other.command}` : row.command, [["CSV", addressOf("/file/row.csv", asked)]]);
    const parts = budget(row);
    if (parts) {
      panel.budget.show(...parts);
      panel.budget.offer(row.explain_command, []);
    } else panel.budget.fail("The background radiance has its standard error alone: no bounds are stored.");
    panel.ledger.show(...ledger(row));
    panel.ledger.offer(row.explain_command, []);
  });
}

function showSpectrum(mine) {
  return fill("spectrum", mine, async () => {
    const asked = detail(chosen);
    const [a, b] = await Promise.all([ask("/api/spectrum", asked), state.compare ? ask("/api/spectrum", detail(chosen, "b_")) : null]);
    if (mine !== run) return;
    const stacked = state.quantity === "intensity";
    const entries = [["a", `${b ? "A" : a.title}, band ±2 standard errors`], ...(b ? [["b", "B"]] : [])];
    if (stacked) for (const c of causesOf(a)) entries.push([c.id, CAUSES.find(([id]) => id === c.id)[1]]);
    readouts.spectrum.textContent = stacked ? "" : "Causes are known of the source intensity.";
    panel.spectrum.show(drawSpectrum(a, b, stacked, readouts.spectrum), legend(entries));
    const files = [["CSV", addressOf("/file/spectrum.csv", asked)]];
    if (state.range_m === "") files.push(["SVG", addressOf("/file/spectrum.svg", asked)]);
    panel.spectrum.offer(b ? `${a.command}\n${b.command}` : a.command, files);
  });
}

function showCut(mine) {
  return fill("cut", mine, async () => {
    const asked = { ...selectionA(), elevation_deg: state.elevation_deg };
    const a = await ask("/api/cut", asked);
    const ofB = { ...selectionParameters(state, "b_"), quantity: state.quantity, elevation_deg: a.elevation_deg };
    const b = state.compare ? await ask("/api/cut", ofB) : null;
    if (mine !== run) return;
    elevation.min = Math.max(-89, Math.floor(Math.min(...shown.elevation)));
    elevation.max = Math.min(89, Math.ceil(shown.elevation.reduce((x, y) => Math.max(x, y), -90)));
    elevation.value = a.elevation_deg;
    elevation.nextElementSibling.textContent = degrees(a.elevation_deg);
    readouts.cut.textContent = a.interpolated ? `Interpolated between viewpoints, band ±2σ; marks: viewpoints within ${a.near_deg}°.` : "Marks: viewpoints, bars ±2σ.";
    panel.cut.show(drawCut(b ? [a, b] : [a], shown.azimuth[chosen], readouts.cut), legend(b ? [["a", "A"], ["b", "B"]] : [["a", a.title]]));
    panel.cut.offer(b ? `${a.command}\n${b.command}` : a.command,
      [["CSV", addressOf("/file/cut.csv", { ...asked, elevation_deg: a.elevation_deg })], ["SVG", addressOf("/file/cut.svg", { ...asked, elevation_deg: a.elevation_deg })]]);
  });
}

// Worked out when it is asked for: it reads every spectrum of the selection.
function showBands(mine) {
  $("bands-open").hidden = state.bands === "1";
  $("bands-form").hidden = state.bands !== "1";
  if (state.bands !== "1") return undefined;
  fillBandForm($("bands-form"), state, contents.detector, change);
  return fill("bands", mine, async () => {
    const asked = { ...selectionParameters(state), ...bandParameters(state) };
    const answer = await ask("/api/bands", asked);
    if (mine !== run) return;
    panel.bands.show(drawBands(answer, panel.bands.readout), html("div", {}, ...bestWindows(answer)));
    panel.bands.offer(answer.command, [["CSV", addressOf("/file/bands.csv", asked)], ["SVG", addressOf("/file/bands.svg", asked)]]);
  });
}

// How far sweeps are; what is new is shown at once.
let done = null;
async function watch() {
  let wait = 15000;
  try {
    if (!document.hidden) {
      const answer = await askAnew("/api/progress"), { database, farm } = answer;
      const open = $("workers")?.open;
      $("progress").replaceChildren(...progress(answer));
      if (open && $("workers")) $("workers").open = true;
      const now = database.map((d) => (d.sweep ?? []).map((s) => `${s.name}:${s.done}`).join()).join(";") + database.map((d) => d.error ?? "").join();
      if (farm || database.some((d) => d.writing)) wait = 2000;
      if (done !== null && now !== done) {
        forget();
        contents = await ask("/api/contents");
        if (complete()) refresh();
        describe();
      }
      done = now;
    }
  } catch (error) {
    $("progress").replaceChildren(html("p", { class: "words" }, error.message));
  }
  setTimeout(watch, wait);
}

function describe() {
  $("about").textContent = contents.database.map((d) => `${d.name}: ${d.error ? "cannot be read" : d.sweep.map((s) => `${s.rows} of ${s.whole_rows} rows from ${s.viewpoints} viewpoints`).join(", ")}`).join("; ");
  if (contents.accuracy_page) $("about").append("; ", html("a", { href: "/accuracy" }, "what accuracy costs"));
  document.title = `irsig: ${contents.database.map((d) => d.name).join(", ")}`;
}

async function copy(command) {
  const said = $("said");
  try {
    await navigator.clipboard.writeText(command);
    said.textContent = `Copied: ${command}`;
  } catch {
    said.textContent = command;  // to be copied by hand
  }
  said.classList.add("shown");
  clearTimeout(copy.timer);
  copy.timer = setTimeout(() => said.classList.remove("shown"), 8000);
}

function listen() {
  document.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    if (button.dataset.command) copy(button.dataset.command);
    const { azimuth, elevation: up, zoom } = dome.turn;
    if (button.dataset.turn) dome.look(...button.dataset.turn.split(",").map(Number), zoom);
    if (button.dataset.zoom) dome.look(azimuth, up, zoom * Number(button.dataset.zoom));
    if (button.dataset.turn || button.dataset.zoom) dome.on.turn();
  });
  elevation.addEventListener("change", () => change({ elevation_deg: elevation.value }));
  for (const form of ["controls", "bands-form"]) $(form).addEventListener("submit", (event) => event.preventDefault());
  $("bands-open").addEventListener("click", () => change({ bands: "1" }));
  addEventListener("popstate", () => {
    state = readAddress();
    if (complete()) {
      fillControls($("controls"), state, contents, change);
      refresh();
    }
  });
}

async function start() {
  state = readAddress();
  listen();
  try {
    contents = await ask("/api/contents");
  } catch (error) {
    $("about").textContent = "";
    $("trouble").textContent = error.message;
    $("trouble").hidden = false;
    return;
  }
  describe();
  if (complete()) {
    writeAddress(state, { replace: true });
    fillControls($("controls"), state, contents, change);
    await refresh();
  }
  watch();
}

start();
