// The shell: connection, status bar, pages by the hash of the address.
import { Connection } from "./connection.js";
import { button, h } from "./dom.js";
import { showHelp } from "./help.js";
import { Jogger } from "./jog.js";
import { loginForm } from "./login.js";
import { Notices } from "./notices.js";
import { recordingBar } from "./recording_bar.js";
import { RoundTrip } from "./round_trip.js";
import { statusBar } from "./status_bar.js";
import { Store } from "./store.js";

const PAGES = { operate: "Operate", watch: "Watch", scope: "Scope", commission: "Commission", alarms: "Alarms", program: "Program" };
const OF_LIVE = new Set(["operate", "commission", "program"]); // a recording has nothing to operate

class App {
  constructor() {
    this.store = new Store();
    this.connection = new Connection(this.store);
    this.notices = new Notices();
    this.roundTrip = new RoundTrip(this.store, this.connection);
    this.jogger = new Jogger(this);
    this._mounted = null;
    this._turn = 0;
    this.main = h("main", { id: "main", tabIndex: -1 });
    this.nav = h("nav", { class: "pages", "aria-label": "Pages" });
    document.body.append(
      h("a", { href: "#main", class: "skip", onclick: (event) => this._skip(event) }, "Skip to the page"),
      h("header", { class: "bar" }, h("h1", {}, "cnc_ptp"), statusBar(this), this.nav),
      this.main, recordingBar(this), this.notices.element,
    );
    this._listen();
    this._fillNav();
    this.connection.open();
    this._route();
  }

  _skip(event) {
    event.preventDefault();
    this.main.focus();
  }

  _listen() {
    const { store } = this;
    window.addEventListener("hashchange", () => this._route());
    document.addEventListener("keydown", (event) => this._key(event));
    store.on("link", () => this._route());
    store.on("hello", () => this._machineCame());
    store.on("gone", (message) => this._gone(message));
    store.on("error", (message) => this.notices.show("error", message.text, message.remedy));
    store.on("operator", () => this._showRight());
    store.on("link", () => this._showRight());
    new MutationObserver(() => this._showRight()).observe(this.main, { childList: true, subtree: true });
  }

  _machineCame() {
    document.title = this.store.machine ? `${this.store.machine.name || "cnc_ptp"} – cnc_ptp` : "cnc_ptp";
    this._fillNav();
    this._route();
  }

  _gone(message) {
    this.notices.show("error", message.text || "the machine is gone", message.remedy);
    this._route();
  }

  /** Groups of commands act only for who holds the command, and may give them. */
  _showRight() {
    const { store } = this;
    const may = store.link === "open" && store.holds && store.role !== "viewer" && !store.machine?.recording;
    for (const group of this.main.querySelectorAll("fieldset.commands")) {
      const permitted = may && (group.dataset.role !== "commissioner" || store.role === "commissioner");
      if (group.disabled === permitted) group.disabled = !permitted;
    }
    document.body.classList.toggle("watching", !may);
  }

  _fillNav() {
    const recording = this.store.machine?.recording;
    const links = Object.entries(PAGES).filter(([name]) => !(recording && OF_LIVE.has(name)));
    this.nav.replaceChildren(...links.map(([name, title]) => h("a", { href: `#${name}`, dataset: { page: name } }, title)));
  }

  // pages

  get page() {
    const wanted = location.hash.slice(1).split("/")[0];
    const recording = this.store.machine?.recording;
    const first = recording ? "watch" : "operate";
    return wanted in PAGES && !(recording && OF_LIVE.has(wanted)) ? wanted : first;
  }

  async _route() {
    const turn = ++this._turn;
    this.jogger.stopAll();
    for (const link of this.nav.children) {
      if (link.dataset.page === this.page) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    this.nav.querySelector("[aria-current]")?.scrollIntoView({ block: "nearest", inline: "nearest" }); // on a phone
    const instead = this._instead();
    const module = instead ? null : await import(`./pages/${this.page}.js`);
    if (turn !== this._turn) return;
    this._mounted?.unmount();
    this._mounted = null;
    this.main.replaceChildren();
    this.main.className = `page ${this.page}`;
    if (instead) this.main.append(instead);
    else this._mounted = module.mount(this.main, this) || null;
    this._showRight();
  }

  /** What is shown while there is no machine to show. */
  _instead() {
    const { store } = this;
    if (store.link === "login") return loginForm(this);
    if (store.link !== "open") return h("p", { class: "instead", role: "status" }, store.link === "connecting" ? "Connecting …" : "The server does not answer. This page tries again.");
    if (store.machine) return null;
    return h("div", { class: "instead", role: "status" }, h("p", {}, store.why?.text || "No machine runs yet."), h("p", {}, "This page is filled as soon as there is one."));
  }

  // what pages call

  /** Gives a command, and shows a refusal or warning; the answer, or null. */
  command(unit, command, args = {}) {
    return this.attempt(this.connection.command(unit, command, args));
  }

  request(type, fields = {}) {
    return this.attempt(this.connection.request(type, fields));
  }

  async attempt(promise) {
    try {
      const answer = await promise;
      if (answer?.warning) this.notices.show("warning", answer.warning);
      return answer;
    } catch (error) {
      this.notices.refused(error);
      return null;
    }
  }

  _key(event) {
    const digit = event.altKey && /^Digit([1-6])$/.exec(event.code);
    if (digit) {
      location.hash = Object.keys(PAGES)[Number(digit[1]) - 1];
      event.preventDefault();
    } else if (event.key === "F1") {
      this.jogger.stopAll();
      showHelp();
      event.preventDefault();
    } else if (event.key === "Escape") {
      this.jogger.stopAll();
    }
  }
}

window.app = new App();
