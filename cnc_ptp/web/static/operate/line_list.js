// The lines of a program as a list that holds only what is seen: programs have 150,000 lines and more.
import { h } from "../dom.js";

const [HEIGHT, AROUND] = [22, 12]; // px of a line; lines above and below what is seen

export class LineList {
  /** `onSelect` is called with the number of a line that is clicked or chosen by keys. */
  constructor(onSelect = () => {}) {
    this.lines = [];
    this.active = 0;
    this.selected = 0;
    this.follows = true;
    this._onSelect = onSelect;
    this._space = h("div", { class: "line-space" });
    this.element = h("div", { class: "lines scroll", role: "listbox", "aria-label": "Lines of the program", tabIndex: 0, onscroll: () => this._draw(), onkeydown: (event) => this._key(event), onclick: (event) => this._click(event) }, this._space);
    new ResizeObserver(() => this._draw()).observe(this.element);
  }

  setText(text) {
    this.lines = text.split(/\r?\n/);
    if (this.lines.at(-1) === "") this.lines.pop();
    Object.assign(this, { active: 0, selected: 0 });
    this._space.style.height = `${this.lines.length * HEIGHT}px`;
    this.element.scrollTop = 0;
    this._draw();
  }

  setActive(line) {
    if (line === this.active) return;
    this.active = line;
    if (this.follows && line > 0) this._show(line);
    this._draw();
  }

  select(line) {
    this.selected = Math.min(Math.max(line, 1), this.lines.length);
    this._show(this.selected);
    this._draw();
    this._onSelect(this.selected);
  }

  /** The next line that has a text, from the selected one on; 0 if none has. */
  find(text) {
    const wanted = text.toUpperCase();
    const { lines } = this;
    for (let i = 0; i < lines.length; i++) {
      const index = (this.selected + i) % lines.length;
      if (lines[index].toUpperCase().includes(wanted)) return index + 1;
    }
    return 0;
  }

  _show(line) {
    const top = (line - 1) * HEIGHT;
    const { scrollTop, clientHeight } = this.element;
    if (top < scrollTop + HEIGHT || top > scrollTop + clientHeight - 2 * HEIGHT) this.element.scrollTop = top - clientHeight / 3;
  }

  _draw() {
    const { scrollTop, clientHeight } = this.element;
    const first = Math.max(0, Math.floor(scrollTop / HEIGHT) - AROUND);
    const behind = Math.min(this.lines.length, Math.ceil((scrollTop + clientHeight) / HEIGHT) + AROUND);
    const rows = [];
    for (let i = first; i < behind; i++) rows.push(this._row(i));
    this._space.replaceChildren(...rows);
    if (this.selected > first && this.selected <= behind) this.element.setAttribute("aria-activedescendant", `line-${this.selected}`);
    else this.element.removeAttribute("aria-activedescendant");
  }

  _row(index) {
    const line = index + 1;
    const row = h("div", { class: "line", role: "option", id: `line-${line}`, "aria-selected": String(line === this.selected), dataset: { line } }, h("span", { class: "line-number" }, line), h("code", {}, this.lines[index]));
    row.style.top = `${index * HEIGHT}px`;
    if (line === this.active) {
      row.classList.add("active");
      row.setAttribute("aria-current", "step");
    }
    return row;
  }

  _click(event) {
    const row = event.target.closest("[data-line]");
    if (row) this.select(Number(row.dataset.line));
  }

  _key(event) {
    const page = Math.floor(this.element.clientHeight / HEIGHT) - 1;
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -Infinity, End: Infinity }[event.key];
    if (!step || event.ctrlKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.select((this.selected || this.active) + step);
  }
}
