// The slider over the search: how it came from its start to the result, which is the last step.

import { make } from "./panel.js";
import { short, whole } from "./numbers.js";

const PACE = 260; // milliseconds that a step is seen while they are played

const byId = (id) => document.getElementById(id);

/** Labels with what is different elsewhere; moseg_core/view/page/steps.py (`runs`) has the form. */
export function changed(labels, packed) {
  const found = labels.slice();
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  let place = 0;
  const number = () => {
    for (let value = 0, factor = 1; ; factor *= 128) {
      const byte = bytes[place++];
      value += (byte & 127) * factor;
      if (byte < 128) return value;
    }
  };
  for (let i = 0; place < bytes.length; ) {
    i += number();
    const end = i + number();
    found.fill(number(), i, end);
    i = end;
  }
  return found;
}

/**
 * Fill the section of the panel, and wire it.
 *
 * `labels` are those of the result; `show(labels)` is called with those of a step. Returns `marks`,
 * the centres of the step that is seen, none at the end; `atEnd`; `go(by)` and `end()`.
 */
export function startSteps(steps, { labels, show }) {
  const last = steps.length - 1;
  const known = []; // the labels of each step, from the last one back, once somebody has asked
  known[last] = labels;
  const slider = byId("steps");
  let at = last; // the step that is seen
  let asked = null; // the frame in which the slider's is to be
  let playing = null;

  function labelsOf(k) {
    let from = k;
    while (!known[from]) from++;
    for (; from > k; from--) known[from - 1] = changed(known[from], steps[from - 1].changes);
    return known[k];
  }

  function say(k) {
    const { stage, evaluations, cost, empty, refined } = steps[k];
    const facts = [
      k === last ? "result" : stage,
      `${whole(evaluations)} evaluation${evaluations === 1 ? "" : "s"}`,
      `cost ${short(cost)}`,
      refined ? "boundaries refined" : null,
      empty > 0 ? `${empty} part${empty === 1 ? "" : "s"} empty` : null,
    ].filter((fact) => fact !== null);
    byId("steps-said").replaceChildren(...facts.map((fact) => make("span", {}, fact)));
    slider.setAttribute("aria-valuetext", `${k + 1} of ${steps.length}: ${facts.join(", ")}`);
  }

  /** See the slider's step from the next frame on; of several requests before it the last counts. */
  function follow() {
    say(Number(slider.value));
    asked ??= requestAnimationFrame(() => {
      asked = null;
      const k = Number(slider.value);
      if (k === at) return;
      at = k;
      show(labelsOf(k));
    });
  }

  function stop() {
    clearInterval(playing);
    playing = null;
    byId("steps-play").setAttribute("aria-pressed", "false");
  }

  function go(by) {
    slider.value = Number(slider.value) + by;
    follow();
  }

  slider.max = last;
  slider.value = last;
  slider.addEventListener("input", () => {
    stop();
    follow();
  });
  byId("steps-play").addEventListener("click", () => {
    if (playing !== null) return stop();
    if (Number(slider.value) === last) go(-last);
    byId("steps-play").setAttribute("aria-pressed", "true");
    playing = setInterval(() => {
      go(1);
      if (Number(slider.value) === last) stop();
    }, PACE);
  });
  for (const id of ["steps-section", "steps-key", "steps-deed"]) byId(id).hidden = false;
  say(last);
  return {
    get atEnd() {
      return at === last;
    },
    get marks() {
      return steps[at].centers.map(({ part, at: place }) => ({ part, at: place, chosen: false }));
    },
    go: (by) => {
      stop();
      go(by);
    },
    end: () => {
      stop();
      go(last);
    },
  };
}
