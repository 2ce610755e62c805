// Keeps what is shown in step with the address: every change goes into the state, the state into
// the address, and from there everything is asked for and drawn.
import { addressOf, ask, askAnew, forget } from "./api.js";
import { bandParameters, bestWindows, drawBands, fillBandForm } from "./bands.js";
import { colorBar } from "./color_bar.js";
import { scaleOf } from "./colors.js";
import { fillControls, QUANTITIES } from "./controls.js";
import { drawCut } from "./cut.js";
import { budget, ledger, progress, values } from "./details.js";
import { html, offer, Panel } from "./draw.js";
import { Hemisphere } from "./hemisphere.js";
import { askImage, canSubtract, differenceOf as imageDifference, isWholeFrame } from "./image.js";
import { ImageView } from "./image_view.js";
import { askMap } from "./map.js";
import { aspectText, brief, degrees, rangeText } from "./numbers.js";
import { CAUSES, causesOf, drawSpectrum, legend } from "./spectrum.js";
import { completeSelection, proposeOther, readAddress, SELECTION, selectionParameters, sweepOf, writeAddress } from "./state.js";

const $ = (id) => document.getElementById(id);
const panel = Object.fromEntries(["map", "values", "spectrum", "cut", "budget", "bands", "ledger"].map((id) => [id, new Panel(id)]));
const elevation = $("elevation");
const readouts = { map: $("dome-readout"), cut: panel.cut.readout, spectrum: panel.spectrum.readout };

let contents, state;
let shown = null;    // aspects and values of the map: {azimuth, elevation, row, value, words(k)}; b_row: of B, if there is one
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
  const small = names.every((f) => ["time", "b_time", "range_m", "aspect", "turn", "zoom", "elevation_deg", "layer", "colours", "pictures", "outlines"].includes(f));
  complete({ asked: false });
  writeAddress(state, { replace: replace || names.some((f) => f.endsWith("time")) });
  if (!small) fillControls($("controls"), state, contents, change);
  if (redraw) refresh();
}

// Completes the state from the contents. Unknown values of an address are reported, values that a
// choice in the form carries along are not. Contents that cannot be shown at all are always
// reported.
function complete({ asked }) {
  const wrong = contents.database.filter((d) => d.error).map((d) => `${d.name}: ${d.error}`);
  const complain = (words) => (asked ? wrong.push(words) : 0);
  const there = completeSelection(state, "", contents, complain);
  if (there && state.compare) {
    if (SELECTION.every((f) => state[`b_${f}`] === "")) proposeOther(state, contents);
    if (!completeSelection(state, "b_", contents, complain)) wrong.push(`${contents.database[Number(state.b_db)].name} holds no sweep yet: there is nothing to compare with.`);
  }
  if (!QUANTITIES.some(([name]) => name === state.quantity)) {
    if (state.quantity !== "") complain(`There is no quantity “${state.quantity.slice(0, 80)}”: shown is the intensity.`);
    state.quantity = "intensity";
  }
  const a = contents.database[Number(state.db)];
  if (!there && a && !a.error) wrong.push(`${a.name} holds no sweep yet: it is shown here as soon as one is submitted.`);
  const trouble = $("trouble");
  trouble.textContent = wrong.join(" ");
  trouble.hidden = wrong.length === 0;
}

const selectionA = () => ({ ...selectionParameters(state), quantity: state.quantity });
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
  const there = sweepOf(state, "", contents);
  document.querySelector("main").hidden = !there;
  if (!there) {
    shown = null;
    document.body.removeAttribute("aria-busy");
    return;
  }
  document.body.setAttribute("aria-busy", "true");
  let map = null;
  try {
    map = await askMap(state, contents);
  } catch (error) {
    if (mine !== run) return;
    shown = null;
    for (const id of Object.keys(panel)) panel[id].fail(error.message);
    imageShown = "";
    hideImage("");
  }
  if (mine !== run) return;
  if (map) {
    shown = map;
    chosen = choose();
    imageShown = "";
    await fill("map", mine, showMap);
    await Promise.all([showRow(mine), showSpectrum(mine), showCut(mine), showBands(mine), showImage(chosen)]);
  }
  if (mine === run) document.body.removeAttribute("aria-busy");
}

function showMap() {
  const scale = scaleOf(shown.value, { around0: shown.around0, upto: shown.upto });
  panel.map.show();
  const stored = state.range_m === "" || Number(state.range_m) === Number(state.at_range_m) ? "" :
    `This map is of the stored range, ${rangeText(state.at_range_m)}: “Seen from” moves the values and the spectrum of the chosen viewpoint.`;
  if (shown.reason || stored) panel.map.say([shown.reason, stored].filter(Boolean).join(" "));
  panel.map.title(shown.shown_title);
  dome.setData(shown.azimuth, shown.elevation, shown.value, scale);
  dome.choose(chosen);
  const [azimuth, up] = (state.turn || "180,90").split(",").map(Number);
  if (Number.isFinite(azimuth) && Number.isFinite(up)) dome.look(azimuth, up, Number(state.zoom) || 1);
  $("bar").replaceChildren(colorBar(scale, shown.shown_unit, shown.upto !== undefined));
  sayAspect(chosen);
  panel.map.offer(shown.command, shown.files);
}

function sayAspect(k) {
  if (!shown || k < 0) return;
  const words = `${aspectText(shown.azimuth[k], shown.elevation[k])}: ${shown.words(k)}`;
  if (readouts.map.textContent !== words) readouts.map.textContent = words;
}

// The stored image of the viewpoint under the pointer; of two conditions, both on one scale.
const figure = $("image"), imageBody = figure.querySelector(".body"), imageWords = figure.querySelector(".words"),
  imageCaption = figure.querySelector("figcaption"), imageTools = figure.querySelector(".tools");
const imageChoice = (name) => figure.querySelector(`[name=${name}]`);
const imageView = new ImageView(figure);
let imageShown = "";  // what is asked for, so that a late answer to an older question is dropped
function sayOfImage(words) {
  imageWords.textContent = words;
  imageWords.hidden = words === "";
}
function hideImage(words) {
  imageBody.hidden = imageTools.hidden = true;
  sayOfImage(words);
}
async function showImage(k) {
  if (!shown || k < 0) return;
  if (!sweepOf(state, "", contents)?.thumbnails) {
    imageShown = "";
    return hideImage("This sweep was computed without images.");
  }
  const rows = shown.b_row ? [rowOf(k), rowOf(k, "b_")] : [rowOf(k)];
  const mine = JSON.stringify([rows, state.layer, state.colours, state.pictures, state.outlines]);
  if (imageShown === mine) return;
  imageShown = mine;
  try {
    const [a, b] = await Promise.all(rows.map((row, i) => askImage(row, state.layer).catch((error) => {
      if (i === 0) throw error;
      return { missing: error.message };
    })));
    if (imageShown === mine) drawImage(aspectText(shown.azimuth[k], shown.elevation[k]), rows, a, b);
  } catch (error) {
    if (imageShown === mine) hideImage(error.message);  // and stays so until something else is asked for
  }
}
function drawImage(where, rows, a, b) {
  const { info, layer, layers, width, height } = a, alike = b && !b.missing && b.layer.name === layer.name;
  const wrong = [b?.missing ? `B has no image: ${b.missing}` : b && !alike ? "The layer is of one of A and B only: shown is A alone." : "",
    ["", "radiance", layer.name].includes(state.layer) ? "" : `This image has no layer “${state.layer.slice(0, 80)}”: shown is the radiance of the target.`,
    info.no_counts ? `[imager] of the sweep is not applied: ${info.no_counts}.` : ""];
  sayOfImage(wrong.filter(Boolean).join(" "));
  imageBody.hidden = imageTools.hidden = false;
  const list = imageChoice("layer"), known = layers.map((l) => l.name).join();
  const optionOf = (l) => (l.name === "" && info.counts.length > 0 ? "radiance" : l.name);
  if (list.dataset.known !== known) {
    list.replaceChildren(...layers.map((l) => html("option", { value: optionOf(l) }, l.name === "" ? "radiance of the target" : `${l.name.replaceAll("_", " ")}: ${l.what}`)));
    list.dataset.known = known;
  }
  list.value = optionOf(layer);
  imageChoice("colours").value = state.colours === "grey" ? "grey" : "";
  imageChoice("outlines").checked = state.outlines === "1";
  const wanted = state.pictures === "difference", difference = wanted && alike && canSubtract(a, b);
  if (wanted && alike && !difference) sayOfImage("The images of A and B differ in size or in what a pixel subtends: there is no difference of pixels.");
  imageChoice("pictures").parentElement.hidden = !alike;
  imageChoice("pictures").value = wanted ? "difference" : "";
  imageChoice("colours").disabled = difference;
  figure.querySelectorAll(".pictures span").forEach((span, i) => {
    span.textContent = difference ? "B − A" : alike ? ["A", "B"][i] : "";
  });
  const pictures = difference ? [imageDifference(a, b)] : alike ? [a, b] : [a];
  const names = difference ? ["B − A "] : alike ? ["A ", "B "] : [""];
  imageView.show(pictures, { names, labels: [`${difference ? "B − A of the" : "The"} target from ${where}`, `The same of B`], grey: state.colours === "grey", withOutlines: state.outlines === "1" });
  const colours = difference ? "B − A, errors as of independent images. Colours to the 99th percentile of the magnitude" : "Colours from the 1st to the 99th percentile";
  const error = !difference && layer.name === "" && info.error_relative > 0 ? ` Standard error of a pixel: ${brief(100 * info.error_relative, 2)} % (root mean square).` : "";
  imageCaption.textContent = `${where}: ${layer.what}. ${colours}${isWholeFrame(a) ? "" : "; stripes: nothing of the target"}. ${width} × ${height} pixels of ${brief(1e6 * a.pixelRad, 3)} µrad.${error}`;
  const png = layer.name === "" ? [["PNG", addressOf("file/image.png", rows[0])]] : [];
  offer(imageTools, alike ? `${layer.command}\n${b.layer.command}` : layer.command, [...png, ["EXR", addressOf("file/image.exr", { ...rows[0], layer: layer.name })]]);
}
for (const name of ["layer", "colours", "pictures", "outlines"])
  imageChoice(name).addEventListener("change", ({ target }) => {
    change({ [name]: target.type === "checkbox" ? (target.checked ? "1" : "") : target.value }, { redraw: false });
    showImage(chosen);
  });

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
      [row, other] = await Promise.all([ask("api/row", asked), shown.b_row ? ask("api/row", detail(chosen, "b_")) : null]);
    } catch (error) {
      for (const id of ["budget", "ledger"]) if (mine === run) panel[id].fail(error.message);
      throw error;
    }
    if (mine !== run) return;
    panel.values.show(...values(row, other, differenceOf(row, other)));
    panel.values.offer(other ? `${row.command}\n${other.command}` : row.command, [["CSV", addressOf("file/row.csv", asked)]]);
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
    const [a, b] = await Promise.all([ask("api/spectrum", asked), shown.b_row ? ask("api/spectrum", detail(chosen, "b_")) : null]);
    if (mine !== run) return;
    const stacked = state.quantity === "intensity";
    const entries = [["a", `${b ? "A" : a.title}, band ±2 standard errors`], ...(b ? [["b", "B"]] : [])];
    if (stacked) for (const c of causesOf(a)) entries.push([c.id, CAUSES.find(([id]) => id === c.id)[1]]);
    readouts.spectrum.textContent = stacked ? "" : "Causes are known of the source intensity.";
    panel.spectrum.show(drawSpectrum(a, b, stacked, readouts.spectrum), legend(entries));
    const files = [["CSV", addressOf("file/spectrum.csv", asked)]];
    if (state.range_m === "") files.push(["SVG", addressOf("file/spectrum.svg", asked)]);
    panel.spectrum.offer(b ? `${a.command}\n${b.command}` : a.command, files);
  });
}

function showCut(mine) {
  return fill("cut", mine, async () => {
    const asked = { ...selectionA(), elevation_deg: state.elevation_deg };
    elevation.min = Math.max(-89, Math.floor(shown.elevation.reduce((x, y) => Math.min(x, y), 90)));
    elevation.max = Math.min(89, Math.ceil(shown.elevation.reduce((x, y) => Math.max(x, y), -90)));
    const a = await ask("api/cut", asked);
    const ofB = { ...selectionParameters(state, "b_"), quantity: state.quantity, elevation_deg: a.elevation_deg };
    const b = shown.b_row ? await ask("api/cut", ofB) : null;
    if (mine !== run) return;
    elevation.value = a.elevation_deg;
    elevation.nextElementSibling.textContent = degrees(a.elevation_deg);
    readouts.cut.textContent = a.interpolated ? `Interpolated between viewpoints, band ±2σ; marks: viewpoints within ${a.near_deg}°.` : "Marks: viewpoints, bars ±2σ.";
    if (state.range_m !== "") readouts.cut.textContent += ` Of the stored range, ${rangeText(state.at_range_m)}.`;
    panel.cut.show(drawCut(b ? [a, b] : [a], shown.azimuth[chosen], readouts.cut), legend(b ? [["a", "A"], ["b", "B"]] : [["a", a.title]]));
    panel.cut.offer(b ? `${a.command}\n${b.command}` : a.command,
      [["CSV", addressOf("file/cut.csv", { ...asked, elevation_deg: a.elevation_deg })], ["SVG", addressOf("file/cut.svg", { ...asked, elevation_deg: a.elevation_deg })]]);
  });
}

// Worked out when it is asked for: it reads every spectrum of the selection.
function showBands(mine) {
  $("bands-open").hidden = state.bands === "1";
  $("bands-form").hidden = state.bands !== "1";
  if (state.bands !== "1") return undefined;
  const sweep = sweepOf(state, "", contents);
  fillBandForm($("bands-form"), state, contents.detector, sweep, change);
  return fill("bands", mine, async () => {
    const asked = { ...selectionParameters(state), ...bandParameters(state, contents.detector, sweep) };
    const answer = await ask("api/bands", asked);
    if (mine !== run) return;
    panel.bands.show(drawBands(answer, panel.bands.readout), html("div", {}, ...bestWindows(answer)));
    panel.bands.offer(answer.command, [["CSV", addressOf("file/bands.csv", asked)], ["SVG", addressOf("file/bands.svg", asked)]]);
  });
}

// Returns a key of the sweeps to choose from, which changes if they do.
const sweepsOf = ({ database }) => JSON.stringify(database.map((d) => d.sweep?.map((s) => [s.name, s.shares]) ?? d.error));

// Watches the progress of sweeps and shows new results at once.
let done = null;
async function watch() {
  let wait = 15000;
  try {
    if (!document.hidden) {
      const answer = await askAnew("api/progress"), { database, farm } = answer;
      const open = $("workers")?.open;
      $("progress").replaceChildren(...progress(answer));
      if (open && $("workers")) $("workers").open = true;
      const now = database.map((d) => (d.sweep ?? []).map((s) => `${s.name}:${s.done}`).join()).join(";") + database.map((d) => d.error ?? "").join();
      if (farm || database.some((d) => d.writing)) wait = 2000;
      if (done !== null && now !== done) {
        forget();
        const known = sweepsOf(contents);
        contents = await ask("api/contents");
        complete({ asked: true });
        if (sweepsOf(contents) !== known) fillControls($("controls"), state, contents, change);
        refresh();
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
  $("about").textContent = contents.database.map((d) => `${d.name}: ${d.error ? "cannot be read" : d.sweep.length === 0 ? "no sweep yet" : d.sweep.map((s) => `${s.rows} of ${s.whole_rows} rows from ${s.viewpoints} viewpoints`).join(", ")}`).join("; ");
  if (contents.accuracy_page) $("about").append("; ", html("a", { href: "accuracy" }, "what accuracy costs"));
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
    complete({ asked: true });
    fillControls($("controls"), state, contents, change);
    refresh();
  });
}

async function start() {
  state = readAddress();
  listen();
  try {
    contents = await ask("api/contents");
  } catch (error) {
    $("about").textContent = "";
    $("trouble").textContent = error.message;
    $("trouble").hidden = false;
    return;
  }
  describe();
  complete({ asked: true });
  writeAddress(state, { replace: true });
  fillControls($("controls"), state, contents, change);
  await refresh();
  watch();
}

start();
