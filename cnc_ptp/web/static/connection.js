// The socket to the server: login, first message, answers by number, and again when it breaks.

const [FIRST_PAUSE, LONGEST_PAUSE] = [300, 5000]; // ms until the next try
const PATIENCE = 30000; // ms for an answer

/** A refusal: number, text, cause and remedy. */
export class Refusal extends Error {
  constructor(fields) {
    super(fields.text || "no answer");
    Object.assign(this, { number: fields.number || 0, cause: fields.cause || "", remedy: fields.remedy || "" });
  }
}

export class Connection {
  constructor(store) {
    this.store = store;
    this.token = "";
    this.onBinary = () => {};
    this._socket = null;
    this._pause = FIRST_PAUSE;
    this._waiting = new Map();
    this._last = 0;
  }

  async open() {
    this.store.setLink("connecting");
    let [status, session] = [0, null];
    try {
      const response = await fetch("/api/session", { headers: { Accept: "application/json" } });
      status = response.status;
      if (response.ok) session = await response.json();
    } catch {
      // no answer, or one that broke off
    }
    if (status === 401) {
      await this._needsLogin();
      return;
    }
    if (!session) {
      this._again();
      return;
    }
    this.token = session.token;
    this.store.hasLogin = session.login;
    this._connect();
  }

  /** A server without users gives a new cookie with its page: a form that can never succeed is not shown. */
  async _needsLogin() {
    try {
      await fetch("/", { cache: "reload" });
      const again = await fetch("/api/session");
      if (again.status !== 401) return this._again();
    } catch {
      return this._again();
    }
    return this.store.setLink("login");
  }

  _connect() {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}/ws`);
    this._socket = socket;
    socket.binaryType = "arraybuffer";
    socket.addEventListener("open", () => {
      socket.send(JSON.stringify({ type: "hello", token: this.token }));
      this._pause = FIRST_PAUSE;
    });
    socket.addEventListener("message", (event) => this._take(event.data));
    socket.addEventListener("close", () => this._closed());
  }

  _take(data) {
    if (typeof data !== "string") {
      this.onBinary(data);
      return;
    }
    const message = JSON.parse(data);
    if (message.type === "hello") this.store.link = "open";
    if (message.type === "answer") this._answer(message);
    else this.store.take(message);
    if (message.type === "hello") this.store.setLink("open");
  }

  _answer(message) {
    const waiting = this._waiting.get(message.id);
    if (!waiting) return;
    this._waiting.delete(message.id);
    clearTimeout(waiting.timer);
    if (message.ok) waiting.resolve(message);
    else waiting.reject(new Refusal(message));
  }

  _closed() {
    this._socket = null;
    for (const { reject, timer } of this._waiting.values()) {
      clearTimeout(timer);
      reject(new Refusal({ text: "the connection to the server broke before the answer" }));
    }
    this._waiting.clear();
    this.store.setLink("closed");
    this._again();
  }

  _again() {
    if (this.store.link !== "closed") this.store.setLink("closed");
    setTimeout(() => this.open(), this._pause);
    this._pause = Math.min(2 * this._pause, LONGEST_PAUSE);
  }

  /** Sends a message that has no answer; false when there is no connection. */
  send(message) {
    if (this._socket?.readyState !== WebSocket.OPEN) return false;
    this._socket.send(JSON.stringify(message));
    return true;
  }

  /** The answer to a message. Rejects with a Refusal. */
  request(type, fields = {}) {
    return new Promise((resolve, reject) => {
      const id = ++this._last;
      if (!this.send({ type, id, ...fields })) {
        reject(new Refusal({ text: "there is no connection to the server" }));
        return;
      }
      const late = () => {
        this._waiting.delete(id);
        reject(new Refusal({ text: `no answer to ${type} within ${PATIENCE / 1000} s` }));
      };
      this._waiting.set(id, { resolve, reject, timer: setTimeout(late, PATIENCE) });
    });
  }

  command(unit, command, args = {}) {
    return this.request("command", { unit, command, arguments: args });
  }

  /** A request of HTTP: JSON, text, bytes, or the response itself. Rejects with a Refusal. */
  async http(path, { as = "json", ...options } = {}) {
    let response;
    try {
      response = await fetch(path, { ...options, headers: { "X-Token": this.token, ...options.headers } });
    } catch {
      throw new Refusal({ text: "there is no connection to the server" });
    }
    if (!response.ok) throw new Refusal(await refusalOf(response));
    return { json: () => response.json(), text: () => response.text(), bytes: () => response.arrayBuffer(), response: () => response }[as]();
  }
}

async function refusalOf(response) {
  try {
    return await response.json();
  } catch {
    return { text: `the server refuses it: ${response.status} ${response.statusText}` };
  }
}
