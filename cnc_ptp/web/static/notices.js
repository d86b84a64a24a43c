// Short notices at the edge of the page: refusals with cause and remedy, and what was done.
import { button, h } from "./dom.js";

const SHOWN = { error: 12000, warning: 8000, info: 4000 }; // ms
const MOST = 4;

export class Notices {
  constructor() {
    this.element = h("div", { class: "notices", role: "log", "aria-live": "assertive", "aria-label": "Notices" });
  }

  show(kind, text, more = "") {
    const remove = () => notice.remove();
    const notice = h(
      "div", { class: `notice ${kind}` },
      h("p", {}, text), more && h("p", { class: "more" }, more),
      button("×", remove, { "aria-label": "Close notice", class: "plain" }),
    );
    this.element.append(notice);
    while (this.element.children.length > MOST) this.element.firstChild.remove();
    setTimeout(remove, SHOWN[kind]);
  }

  refused(error) {
    this.show("error", error.message, error.remedy);
  }
}
