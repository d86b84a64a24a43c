// Math channels: a small language of its own, parsed and evaluated here; nothing of it is run as JavaScript.
//   expression  term (+|- term)*      term  factor (*|/ factor)*      factor  [-] power      power  atom [^ factor]
//   atom        number, signal (x.set_position), constant (pi), function(expression, …), (expression)

const CONSTANTS = new Map([["pi", Math.PI], ["e", Math.E]]);
const FUNCTIONS = new Map([
  ["sin", [1, Math.sin]], ["cos", [1, Math.cos]], ["tan", [1, Math.tan]], ["atan2", [2, Math.atan2]], ["sqrt", [1, Math.sqrt]], ["abs", [1, Math.abs]],
  ["exp", [1, Math.exp]], ["log", [1, Math.log]], ["sign", [1, Math.sign]], ["round", [1, Math.round]], ["floor", [1, Math.floor]],
  ["min", [2, Math.min]], ["max", [2, Math.max]], ["hypot", [2, Math.hypot]],
]);
/** Functions that remember what was before; time in s. */
const OVER_TIME = new Set(["diff", "integral", "delay"]);
const LONGEST = 500;
const DEEPEST = 40;

const TOKEN = /\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_][\w]*(?:\.[\w]+(?:\[\d+\])?)*)|([-+*/^(),]))/y;

/** A formula: `names` of its signals and `evaluate(columns, count, cycleTime)` of a block of samples. Throws Error. */
export function formula(text) {
  const parser = new Parser(text);
  const root = parser.parse();
  return {
    names: [...parser.names],
    /** `columns`: signal name -> samples. What is over time continues from block to block. */
    evaluate: (columns, count, cycleTime) => root(columns, count, cycleTime),
  };
}

class Parser {
  constructor(text) {
    if (text.length > LONGEST) throw new Error(`a formula has at most ${LONGEST} characters`);
    this._tokens = tokensOf(text);
    this._place = 0;
    this._depth = 0;
    this.names = new Set();
  }

  parse() {
    const root = this._sum();
    if (this._next) throw new Error(`'${this._next.text}' is not expected here`);
    return root;
  }

  get _next() {
    return this._tokens[this._place];
  }

  _take(text) {
    if (this._next?.text !== text || this._next.kind !== "sign") return false;
    this._place += 1;
    return true;
  }

  _demand(text) {
    if (!this._take(text)) throw new Error(`'${text}' is missing${this._next ? ` before '${this._next.text}'` : " at the end"}`);
  }

  _deeper(part) {
    this._depth += 1;
    if (this._depth > DEEPEST) throw new Error(`more than ${DEEPEST} levels of brackets`);
    const found = part();
    this._depth -= 1;
    return found;
  }

  _sum() {
    return this._deeper(() => {
      let left = this._product();
      for (;;) {
        if (this._take("+")) left = both(left, this._product(), (a, b) => a + b);
        else if (this._take("-")) left = both(left, this._product(), (a, b) => a - b);
        else return left;
      }
    });
  }

  _product() {
    let left = this._factor();
    for (;;) {
      if (this._take("*")) left = both(left, this._factor(), (a, b) => a * b);
      else if (this._take("/")) left = both(left, this._factor(), (a, b) => a / b);
      else return left;
    }
  }

  _factor() {
    return this._deeper(() => (this._take("-") ? each(this._factor(), (value) => -value) : this._power()));
  }

  _power() {
    const base = this._atom();
    return this._take("^") ? both(base, this._factor(), (a, b) => a ** b) : base;
  }

  _atom() {
    const token = this._next;
    if (!token) throw new Error("the formula ends too early");
    this._place += 1;
    if (token.kind === "number") return constant(Number(token.text));
    if (token.kind === "sign") return this._bracket(token);
    if (this._take("(")) return this._call(token.text);
    if (CONSTANTS.has(token.text)) return constant(CONSTANTS.get(token.text));
    this.names.add(token.text);
    return (columns, count) => columns.get(token.text) || new Float64Array(count).fill(NaN);
  }

  _bracket(token) {
    if (token.text !== "(") throw new Error(`'${token.text}' is not expected here`);
    const inner = this._sum();
    this._demand(")");
    return inner;
  }

  _call(name) {
    const given = [this._sum()];
    while (this._take(",")) given.push(this._sum());
    this._demand(")");
    if (OVER_TIME.has(name)) return overTime(name, given);
    const known = FUNCTIONS.get(name);
    if (!known) throw new Error(`'${name}' is no function; known: ${[...FUNCTIONS.keys(), ...OVER_TIME].join(", ")}`);
    const [needed, act] = known;
    if (given.length !== needed) throw new Error(`${name} takes ${needed} value${needed > 1 ? "s" : ""}, not ${given.length}`);
    return needed === 1 ? each(given[0], act) : both(given[0], given[1], act);
  }
}

function tokensOf(text) {
  const tokens = [];
  TOKEN.lastIndex = 0;
  while (text.slice(TOKEN.lastIndex).trim()) {
    const at = TOKEN.lastIndex;
    const found = TOKEN.exec(text);
    if (!found) throw new Error(`'${text.slice(at).trim()[0]}' is not expected here`);
    const [, number, name, sign] = found;
    tokens.push({ kind: number ? "number" : name ? "name" : "sign", text: number || name || sign });
  }
  return tokens;
}

const constant = (value) => (_columns, count) => new Float64Array(count).fill(value);

const each = (part, act) => (columns, count, cycle) => Float64Array.from(part(columns, count, cycle), (value) => act(value));

const both = (left, right, act) => (columns, count, cycle) => {
  const [a, b] = [left(columns, count, cycle), right(columns, count, cycle)];
  return Float64Array.from({ length: count }, (_, i) => act(a[i], b[i]));
};

/** diff(v): per second; integral(v): from where it began; delay(v): a cycle. */
function overTime(name, given) {
  if (given.length !== 1) throw new Error(`${name} takes 1 value, not ${given.length}`);
  let [before, sum] = [NaN, 0];
  return (columns, count, cycle) => {
    const values = given[0](columns, count, cycle);
    return Float64Array.from({ length: count }, (_, i) => {
      const last = before;
      before = values[i];
      if (name === "diff") return (before - last) / cycle;
      if (name === "delay") return last;
      if (!Number.isNaN(before)) sum += before * cycle;
      return sum;
    });
  };
}
