// Triggers: where in the samples, or with which event, the picture is to be held.

/** `kind`: edge, level, event, error. `direction`: rising, falling, both; of a level above, below. `text`: of an event. */
export class Trigger {
  constructor({ kind = "edge", direction = "rising", level = 0, text = "" } = {}) {
    Object.assign(this, { kind, direction, level, text: text.toLowerCase() });
    this.arm();
  }

  arm() {
    this.cycle = null;
    this._before = NaN;
  }

  /** Looks at samples that begin at a cycle; whether it has fired. */
  takeSamples(cycle, values) {
    if (this.cycle !== null || (this.kind !== "edge" && this.kind !== "level")) return false;
    for (let i = 0; i < values.length; i++) {
      const [before, now] = [this._before, values[i]];
      this._before = now;
      if (this.kind === "edge" ? this._isEdge(before, now) : this._isBeyond(now)) {
        this.cycle = cycle + i;
        return true;
      }
    }
    return false;
  }

  takeEvent(event) {
    if (this.cycle !== null) return false;
    const fires = this.kind === "error" ? event.severity === "error" : this.kind === "event" && this._isNamed(event);
    if (fires) this.cycle = event.cycle;
    return fires;
  }

  _isNamed({ source = "", text = "", number = 0 }) {
    return `${source} ${number} ${text}`.toLowerCase().includes(this.text);
  }

  _isEdge(before, now) {
    const rising = before < this.level && now >= this.level;
    const falling = before > this.level && now <= this.level;
    return { rising, falling, both: rising || falling }[this.direction];
  }

  _isBeyond(now) {
    return this.direction === "below" || this.direction === "falling" ? now < this.level : now > this.level;
  }
}
