// The sliders of `moseg tune`: weights and moved centres go to the server that the page came from.
//
// The server (moseg_core/tune/server.py) searches; the page asks how far it is, and loads itself
// anew when it is done. What a person would miss then, from where the shape is looked at, is kept in
// the session storage of the browser tab.

import { make, nameOf } from "./panel.js";
import { short } from "./numbers.js";

const ASKED_EVERY = 400; // milliseconds
const DOUBLINGS = 4; // of a weight, up and down from the one that the recipe had
const VIEW = "moseg-view";

const byId = (id) => document.getElementById(id);

/**
 * Fill the section of the panel, and wire it.
 *
 * Returns `moved()`, to be called when a centre was placed, and `resumeView()`, which looks at the
 * shape as before the page was loaded anew.
 */
export function startTuning(page, { centers, stage }) {
  const { terms, earlier, recipe, example } = page.tune;
  const weights = terms.map((term) => term.weight);
  let busy = false;
  terms.forEach((term, k) => byId("tune-terms").append(termRow(term, (weight, row) => {
    weights[k] = weight;
    row.classList.toggle("changed", weight !== term.weight);
  })));
  byId("tune-section").hidden = false;

  function show() {
    for (const id of ["tune-on", "tune-anew"]) byId(id).disabled = busy;
    byId("tune-stop").hidden = !busy;
    byId("tune-back").disabled = busy || earlier === 0;
    byId("tune-recipe").disabled = busy || recipe === null;
    byId("tune-example").disabled = busy || example === null;
    byId("tune-recipe").title = recipe ?? "moseg tune was given no place for it: -o recipe.toml";
    byId("tune-example").title = example ?? "moseg tune was given no place for it: --example result.json";
    const names = [...centers.elements.keys()].map((k) => page.parts[k].name);
    byId("tune-moved").hidden = byId("tune-hold-label").hidden = names.length === 0;
    byId("tune-moved").replaceChildren("Moved: ", nameOf(names.join(", ")));
  }

  function refuse(problem) {
    byId("tune-problem").hidden = problem === "";
    byId("tune-problem").textContent = problem;
  }

  /** Send a request; the answer, or null where there is none and the page says why. */
  async function ask(route, document) {
    refuse("");
    try {
      const response = await fetch(route, {
        method: document === undefined ? "GET" : "POST",
        headers: document === undefined ? {} : { "Content-Type": "application/json" },
        body: document === undefined ? undefined : JSON.stringify(document),
      });
      const answer = await response.json();
      if (response.ok) return answer;
      refuse(answer.problem);
    } catch {
      refuse("moseg tune has ended; start it again");
    }
    return null;
  }

  function loadAnew() {
    sessionStorage.setItem(VIEW, JSON.stringify(stage.lookingFrom()));
    location.reload();
  }

  async function search(anew) {
    const moved = Object.fromEntries(
      [...centers.elements].map(([k, element]) => [page.parts[k].name, element]),
    );
    const wish = { weights, moved: anew ? {} : moved, anew, hold: byId("tune-hold").checked };
    if (await ask("search", wish)) await wait();
  }

  /** Ask how far the search is until it is done. */
  async function wait() {
    busy = true;
    show();
    for (;;) {
      const state = await ask("state");
      if (state === null) break;
      byId("tune-state").textContent = state.text;
      if (!state.busy) {
        if (state.problem === "") return loadAnew();
        refuse(state.problem);
        break;
      }
      await new Promise((resolve) => setTimeout(resolve, ASKED_EVERY));
    }
    busy = false;
    byId("tune-state").textContent = "";
    show();
  }

  async function save(route) {
    const answer = await ask(route, {});
    if (answer) byId("tune-state").textContent = `wrote ${answer.wrote}`;
  }

  byId("tune-on").addEventListener("click", () => search(false));
  byId("tune-anew").addEventListener("click", () => search(true));
  byId("tune-stop").addEventListener("click", () => ask("stop", {}));
  byId("tune-back").addEventListener("click", async () => {
    if (await ask("back", {})) loadAnew();
  });
  byId("tune-recipe").addEventListener("click", () => save("recipe"));
  byId("tune-example").addEventListener("click", () => save("example"));
  show();
  ask("state").then((state) => state?.busy && wait()); // the page was loaded anew by hand
  return {
    moved: show,
    resumeView: () => {
      const kept = sessionStorage.getItem(VIEW);
      sessionStorage.removeItem(VIEW);
      if (kept) stage.lookFrom(JSON.parse(kept));
    },
  };
}

/** A term with its slider: from left out, by doublings, to 2 ** DOUBLINGS times the recipe's weight. */
function termRow({ text, weight, given }, changed) {
  const slider = make("input", {
    type: "range", min: -DOUBLINGS - 0.25, max: DOUBLINGS, step: 0.25, "aria-label": `weight of ${text}`,
  });
  const shown = make("output", {});
  const row = make(
    "tr",
    {},
    make("th", { scope: "row" }, make("bdi", {}, text)),
    make("td", {}, make("span", { className: "weight" }, slider, shown)),
  );
  const say = (value) => {
    shown.textContent = value === 0 ? "off" : short(value);
    slider.setAttribute("aria-valuetext", value === 0 ? "left out" : short(value));
  };
  slider.value = weight === 0 ? slider.min : Math.log2(weight / given);
  say(weight);
  slider.addEventListener("input", () => {
    const step = Number(slider.value);
    const off = step < -DOUBLINGS;
    const value = off ? 0 : Number((given * 2 ** step).toPrecision(3));
    const chosen = step === 0 ? given : value;
    say(chosen);
    changed(chosen, row);
  });
  return row;
}
