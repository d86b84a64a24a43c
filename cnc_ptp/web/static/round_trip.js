// How long a message to the server and its answer take: measured every second, since a jog ends as late as its messages come.

const [PERIOD, FIRST_PERIOD, KEPT] = [1000, 200, 3]; // ms between two pings, and the first ones; the last times that count
/** ms; a jog is refused above it, by the server too. */
export const LONGEST_FOR_JOGS = 150;

export class RoundTrip {
  constructor(store, connection) {
    this._store = store;
    this._connection = connection;
    this._timer = 0;
    this._last = [];
    this._sent = 0; // of the ping that has no answer yet
    store.on("pong", (message) => this._heard(message));
    store.on("link", (link) => (link === "open" ? this._begin() : this._end()));
  }

  /** ms: the smallest of the last times, so that one slow picture of this page does not count; Infinity while none is known. */
  get time() {
    const waited = this._sent ? performance.now() - this._sent : 0;
    return Math.max(Math.min(Infinity, ...this._last), waited > PERIOD ? waited : 0);
  }

  _begin() {
    this._end();
    this._ping();
  }

  _end() {
    clearTimeout(this._timer);
    [this._last, this._sent] = [[], 0];
    this._store.tell("round_trip", this.time);
  }

  _ping() {
    if (this._sent) this._store.tell("round_trip", this.time);
    this._sent ||= performance.now();
    const known = this._last.length ? { round_trip: this.time } : {};
    this._connection.send({ type: "ping", time: performance.now(), ...known });
    this._timer = setTimeout(() => this._ping(), this._last.length < KEPT ? FIRST_PERIOD : PERIOD);
  }

  _heard({ time }) {
    this._last = [...this._last, performance.now() - time].slice(-KEPT);
    this._sent = 0;
    this._store.tell("round_trip", this.time);
  }
}
