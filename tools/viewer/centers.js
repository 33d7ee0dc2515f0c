// Centres placed by hand, and the options of `moseg segment` that say where they are.

import { coordinate, quoted } from "./numbers.js";

export class Centers {
  /**
   * @param parts the parts of the page, of which some may have a `center` in model units
   * @param size the diagonal of the shape, model units
   */
  constructor(parts, size) {
    this.parts = parts;
    this.size = size;
    this.places = new Map();
    this.elements = new Map(); // of those that were clicked
    parts.forEach((part, k) => {
      if (part.center) this.places.set(k, part.center);
    });
  }

  place(k, { at, element }) {
    this.places.set(k, at);
    this.elements.set(k, element);
  }

  /** Names of parts that have no centre yet; without one for each the line is none. */
  get missing() {
    return this.#named.filter(({ k }) => !this.places.has(k)).map(({ name }) => name);
  }

  /** Names that the option cannot say. */
  get unspeakable() {
    return this.#named.map(({ name }) => name).filter((name) => /[,=\n]/.test(name));
  }

  get #named() {
    return this.parts.map(({ name, unlabelled }, k) => ({ k, name, unlabelled }))
      .filter(({ unlabelled }) => !unlabelled);
  }

  /** `--centers 'handle=x,y,z,head=x,y,z'`, in the order of the labels. */
  get line() {
    const said = this.#named.filter(({ k }) => this.places.has(k)).map(({ k, name }) => {
      const numbers = this.places.get(k).map((x) => coordinate(x, this.size));
      return `${name}=${numbers.join(",")}`;
    });
    return `--centers ${quoted(said.join(","))}`;
  }

  /** `--pin head=120` for each part whose centre was clicked; empty before. */
  get pins() {
    const said = [...this.elements].sort(([a], [b]) => a - b);
    return said.map(([k, element]) => `--pin ${quoted(`${this.parts[k].name}=${element}`)}`).join(" ");
  }
}
