// The page of a result: it reads the data that Python put into it, and wires scene and panel.
//
// `unpack.js` makes arrays of the data, `stage.js` is the scene, `panel.js` the tables beside it,
// `centers.js` what a click on the surface says, `steps.js` how the search went. What is chosen, isolated and hovered is kept here.

import { Centers } from "./centers.js";
import { percent } from "./numbers.js";
import { fillHeader, fillParts, fillTerms, make, nameOf } from "./panel.js";
import { Stage } from "./stage.js";
import { startSteps } from "./steps.js";
import { startTuning } from "./tune.js";
import { unpackGeometry } from "./unpack.js";

const CLICK = 5; // pixels that a pointer may move between down and up
const TURN = 0.12; // radians for a press of an arrow
const ZOOM = 0.9;

const byId = (id) => document.getElementById(id);

function start() {
  const page = JSON.parse(byId("data").textContent);
  const state = { chosen: null, isolated: null, hovered: null, placing: false };
  let stage = null;
  const centers = new Centers(page.parts, Math.hypot(...page.geometry.frame.size));
  fillHeader(page);
  fillTerms(page);
  const mark = fillParts(page, {
    choose: (k) => choose(k),
    hide: (k, hidden) => stage?.hide(k, hidden),
  });
  let tuning = null;
  let steps = null;
  const dark = followTheme((on) => stage?.setDark(on));
  try {
    stage = new Stage(byId("canvas"), {
      geometry: unpackGeometry(page.geometry),
      view: page.view,
      colors: page.parts.map((part) => part.color),
    });
  } catch (error) {
    // The tables are of use without the scene.
    byId("failure").hidden = false;
    byId("failure").append(`This browser cannot draw in 3D (WebGL 2): ${error.message}`);
    document.body.classList.add("flat");
    return { page, state, centers, stage };
  }
  stage.setDark(dark());
  byId("canvas").setAttribute("aria-label", described(page));

  function show() {
    mark(state);
    stage.highlight(state.isolated === null ? state.hovered : null);
    byId("alone").hidden = state.isolated === null;
    if (state.isolated !== null) {
      byId("alone-name").replaceChildren(nameOf(page.parts[state.isolated].name));
    }
  }

  /** Choose a part: it stands alone, or gets the next centre where those are placed. */
  function choose(k) {
    if (state.placing) {
      state.chosen = k;
      showCenters();
    } else {
      const again = state.isolated === k;
      state.chosen = state.isolated = again ? null : k;
      stage.isolate(state.isolated);
      say(again ? "all parts" : `${page.parts[k].name} alone`);
    }
    show();
  }

  function everything() {
    state.isolated = null;
    if (!state.placing) state.chosen = null;
    stage.isolate(null);
    show();
  }

  function hover(k, x, y) {
    const tip = byId("tip");
    tip.hidden = k === null;
    if (k !== null) {
      tip.style.transform = `translate(${x}px, ${y}px)`;
      tip.classList.toggle("left", x > 0.7 * byId("canvas").clientWidth);
    }
    if (k === state.hovered) return;
    state.hovered = k;
    if (k !== null) {
      const part = page.parts[k];
      const color = make("span", { className: "swatch" });
      color.style.background = part.color;
      const now = steps?.atEnd ?? true; // on the way there, parts had other sizes
      tip.replaceChildren(color, nameOf(part.name), make("span", {}, now ? percent(part.share) : ""));
      say(now ? `${part.name}, ${percent(part.share)} of the ${page.measure}` : part.name);
    }
    show();
  }

  // -- centres ----------------------------------------------------------------------------------

  function setPlacing(on) {
    state.placing = on;
    byId("place").setAttribute("aria-pressed", String(on));
    byId("centers-section").hidden = !on;
    document.body.classList.toggle("placing", on);
    if (on) {
      state.chosen ??= page.order.find((k) => !page.parts[k].unlabelled) ?? null;
      state.isolated = null;
      stage.isolate(null);
      byId("centers-section").scrollIntoView({ block: "nearest" });
    }
    showCenters();
    show();
  }

  function placeCenter(x, y) {
    const found = stage.placeAt(x, y);
    if (!found) return;
    const part = state.chosen ?? found.part;
    if (page.parts[part].unlabelled) return;
    state.chosen = part;
    centers.place(part, found);
    if (!state.placing) setPlacing(true);
    else {
      showCenters();
      show();
    }
    tuning?.moved();
    say(`centre of ${page.parts[part].name} placed`);
  }

  function showCenters() {
    const chosen = state.chosen === null ? null : page.parts[state.chosen];
    byId("centers-of").replaceChildren(chosen ? nameOf(chosen.name) : "a part of the list");
    byId("centers-line").textContent = centers.line;
    byId("pins-line").textContent = centers.pins;
    byId("pins").hidden = centers.pins === "";
    const { missing, unspeakable } = centers;
    const problem = byId("centers-problem");
    problem.hidden = missing.length + unspeakable.length === 0;
    problem.textContent = unspeakable.length > 0
      ? "A name with a comma, an equals sign or a new line cannot be said in --centers: " +
        unspeakable.join("; ")
      : `Still without a centre: ${missing.join(", ")}. The option needs one for every label.`;
    const marks = [...centers.places].map(([part, at]) => ({ part, at, chosen: part === state.chosen }));
    stage.mark(state.placing ? marks : steps?.marks ?? []);
  }

  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", () => copy(byId(button.dataset.copy), button));
  }

  // -- pointer ----------------------------------------------------------------------------------

  const canvas = byId("canvas");
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  let down = null;
  let latest = null; // where the pointer is, until the frame in which that is looked up
  canvas.addEventListener("pointerdown", (event) => {
    down = [event.clientX, event.clientY];
    hover(null);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons || event.pointerType === "touch") return;
    const asked = latest !== null;
    latest = at(event);
    if (asked) return;
    requestAnimationFrame(() => {
      const place = latest;
      latest = null;
      if (place) hover(stage.partAt(...place), ...place);
    });
  });
  canvas.addEventListener("pointerleave", () => {
    latest = null;
    hover(null);
  });
  canvas.addEventListener("click", (event) => {
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) > CLICK) return;
    const place = at(event);
    if (page.steerable && (state.placing || event.shiftKey)) {
      placeCenter(...place);
      return;
    }
    const k = stage.partAt(...place);
    if (k !== null && k !== state.isolated) choose(k);
    else everything();
  });

  // -- keyboard and controls --------------------------------------------------------------------

  const KEYS = {
    ArrowLeft: () => stage.viewpoint.turn(-TURN, 0),
    ArrowRight: () => stage.viewpoint.turn(TURN, 0),
    ArrowUp: () => stage.viewpoint.turn(0, -TURN),
    ArrowDown: () => stage.viewpoint.turn(0, TURN),
    "+": () => stage.viewpoint.zoom(ZOOM),
    "=": () => stage.viewpoint.zoom(ZOOM),
    "-": () => stage.viewpoint.zoom(1 / ZOOM),
    0: () => reset(),
    Home: () => reset(),
    ",": () => steps?.go(-1),
    ".": () => steps?.go(1),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape") {
      if (state.placing) setPlacing(false);
      else everything();
      return;
    }
    const elsewhere = document.activeElement;
    if (elsewhere !== canvas && elsewhere !== document.body) return;
    if (event.key in KEYS) {
      KEYS[event.key]();
      event.preventDefault();
    }
  });

  function reset() {
    byId("explode").value = 0;
    stage.explosion = 0;
    steps?.end();
    for (const box of document.querySelectorAll("#parts input")) box.checked = true;
    stage.hidden.clear();
    everything();
    stage.resetView();
  }

  const toggle = (id, kind) => {
    const button = byId(id);
    button.addEventListener("click", () => {
      const on = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(on));
      stage.show(kind, on);
    });
  };
  toggle("boundaries", "boundaries");
  toggle("wires", "wires");
  byId("reset").addEventListener("click", reset);
  byId("alone").addEventListener("click", everything);
  byId("place").addEventListener("click", () => setPlacing(!state.placing));
  byId("explode").addEventListener("input", (event) => stage.explode(Number(event.target.value) / 100));
  byId("place").hidden = !page.steerable;
  if (!page.geometry.triangles) byId("boundaries").hidden = byId("wires").hidden = true;

  let seen = false;
  new ResizeObserver(() => {
    const { clientWidth, clientHeight } = canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    stage.resize(clientWidth, clientHeight);
    if (!seen) {
      stage.resetView();
      tuning?.resumeView();
    }
    seen = true;
  }).observe(canvas);
  if (page.steps) {
    steps = startSteps(page.steps, {
      labels: stage.labels,
      show: (labels) => {
        hover(null);
        stage.setLabels(labels);
        showCenters();
        show();
      },
    });
  }
  if (page.tune) tuning = startTuning(page, { centers, stage });
  show();
  return { page, state, centers, stage };
}

function described(page) {
  const names = page.parts.slice(0, 12).map((part) => part.name.slice(0, 60)).join(", ");
  const more = page.parts.length > 12 ? ` and ${page.parts.length - 12} more` : "";
  return `${page.name} in 3D, cut into ${names}${more}; the parts are listed in the table`;
}

function say(text) {
  byId("said").textContent = text.slice(0, 200);
}

/** Dark or light as the system is, until the button says otherwise; returns which it is. */
function followTheme(changed) {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  let asked = null;
  const dark = () => asked ?? system.matches;
  const apply = () => {
    document.documentElement.dataset.theme = dark() ? "dark" : "light";
    byId("theme").setAttribute("aria-pressed", String(dark()));
    changed(dark());
  };
  system.addEventListener("change", apply);
  byId("theme").addEventListener("click", () => {
    asked = !dark();
    apply();
  });
  apply();
  return dark;
}

/** Put a text into the clipboard; where a browser forbids that, it is selected to be copied. */
async function copy(node, button) {
  const label = button.textContent;
  try {
    await navigator.clipboard.writeText(node.textContent);
    button.textContent = "Copied";
  } catch {
    window.getSelection().selectAllChildren(node);
    button.textContent = "Selected";
  }
  setTimeout(() => (button.textContent = label), 1500);
}

export const viewer = start();
