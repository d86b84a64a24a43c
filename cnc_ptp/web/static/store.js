// What the pages know of the machine; views are notified by topic.

const [KEPT_EVENTS, KEPT_ALARMS] = [500, 1000];
const CHOSEN = "channel"; // key of the chosen channel, which each tab of the browser keeps

export class Store {
  constructor() {
    this.link = "connecting"; // connecting, open, closed, login
    this.user = "";
    this.role = "viewer";
    this.hasLogin = false; // users log in and out
    this.page = 0;
    this.machine = null;
    this.why = null;
    this.time = 0;
    this.units = {};
    this.operator = { holder: null, asking: null };
    this.alarms = [];
    this.events = [];
    this.handshakes = new Map();
    this.programs = {};
    this.offsets = {};
    this.nodes = new Map();
    this.byHand = false; // the last command of this page: functions are acknowledged by hand
    this._chosen = readChosen();
    this._listeners = new Map();
  }

  /** Calls `listener` at each message of a topic; returns what ends that. */
  on(topic, listener) {
    if (!this._listeners.has(topic)) this._listeners.set(topic, new Set());
    this._listeners.get(topic).add(listener);
    return () => this._listeners.get(topic).delete(listener);
  }

  tell(topic, detail) {
    for (const listener of [...(this._listeners.get(topic) || [])]) listener(detail);
  }

  setLink(link) {
    this.link = link;
    this.tell("link", link);
  }

  /** A message of the server. */
  take(message) {
    const handler = HANDLERS[message.type];
    if (handler) handler(this, message);
    this.tell(message.type, message);
  }

  of(kind) {
    return (this.machine?.units || []).filter((unit) => unit.kind === kind);
  }

  unit(name) {
    return (this.machine?.units || []).find((unit) => unit.name === name) || null;
  }

  state(name) {
    return this.units[name] || {};
  }

  /** The channel that the pages show and operate: the chosen one, or the first. */
  get channel() {
    const channels = this.of("channel");
    return (channels.find(({ name }) => name === this._chosen) || channels[0])?.name || "";
  }

  /** Another channel is shown and operated from now on. */
  choose(channel) {
    this._chosen = channel;
    writeChosen(channel);
    this.tell("channel", channel);
  }

  get hasSeveralChannels() {
    return this.of("channel").length > 1;
  }

  /** A text about the channel, with its name where there are several. */
  ofChannel(text) {
    return this.hasSeveralChannels ? `${text} ${this.channel}` : text;
  }

  /** Whether functions of programs wait for somebody: as the machine says it, or as this page has commanded it. */
  get acknowledgesByHand() {
    const automatic = this.state("plc").auto_acknowledge;
    return automatic === undefined ? this.byHand : !automatic;
  }

  /** Whether this page holds the command. */
  get holds() {
    const holder = this.operator.holder;
    return Boolean(holder) && holder.page === this.page;
  }

  get inEmergency() {
    return Boolean(this.units.plc?.emergency_stop);
  }
}

const HANDLERS = {
  hello(store, message) {
    Object.assign(store, { user: message.user, role: message.role, page: message.page || 0 });
    Object.assign(store, { machine: message.machine || null, why: message.why || null, units: {}, events: [] });
    if (message.operator) store.operator = message.operator;
    store.alarms = message.alarms || [];
    store.handshakes = new Map((message.handshakes || []).map((request) => [request.id, request]));
    store.programs = Object.fromEntries((message.programs || []).map((program) => [program.channel, program]));
    store.offsets = message.offsets || {};
    store.nodes.clear();
    store.tell("alarms");
    store.tell("operator");
  },
  state(store, message) {
    store.time = message.time;
    for (const [name, fields] of Object.entries(message.units)) store.units[name] = { ...store.units[name], ...fields };
  },
  event(store, message) {
    store.events.push(message);
    if (store.events.length > KEPT_EVENTS) store.events.shift();
    if (message.alarm === undefined) return;
    store.alarms.push(message);
    while (store.alarms.length > KEPT_ALARMS) store.alarms.splice(Math.max(0, store.alarms.findIndex((alarm) => alarm.acknowledged)), 1);
    store.tell("alarms");
  },
  acknowledged(store, message) {
    const numbers = new Set(message.alarms);
    for (const alarm of store.alarms) if (numbers.has(alarm.alarm)) Object.assign(alarm, { acknowledged: true, acknowledged_by: message.user });
    store.tell("alarms");
  },
  operator(store, message) {
    store.operator = { holder: message.holder, asking: message.asking };
  },
  handshake(store, message) {
    store.handshakes.set(message.id, message);
    store.tell("handshakes");
  },
  handshake_done(store, message) {
    store.handshakes.delete(message.id);
    store.tell("handshakes");
  },
  program(store, message) {
    store.programs[message.channel || store.channel] = message;
  },
  offsets(store, message) {
    store.offsets[message.channel] = message;
  },
  parameters(store, message) {
    Object.assign(store.unit(message.unit) || {}, message.described);
  },
  diagnostics(store, message) {
    for (const node of message.nodes || []) store.nodes.set(node.name, { ...store.nodes.get(node.name), ...node });
  },
  gone(store, message) {
    store.why = message;
    store.machine = null;
    store.byHand = false; // the next machine acknowledges automatically
  },
};

function readChosen() {
  try {
    return sessionStorage.getItem(CHOSEN) || "";
  } catch {
    return ""; // storage is blocked
  }
}

function writeChosen(channel) {
  try {
    sessionStorage.setItem(CHOSEN, channel);
  } catch {
    // storage is blocked: the choice lasts as long as the page
  }
}
