// Programs of the server's folder: list, text, upload, load.

const EXISTS = 26257; // the number of a name that is taken

/** `programs` with name and size, and the `endings` of names that are taken. */
export async function listPrograms(app) {
  const answer = await app.attempt(app.connection.http("/api/programs"));
  return { programs: answer?.programs || [], endings: answer?.endings || [] };
}

/** The text of a program as the channel has loaded it; null after a refusal, which is shown. */
export function readProgram(app, name) {
  const channel = encodeURIComponent(app.store.channel);
  return app.attempt(app.connection.http(`/api/programs/${encodeURIComponent(name)}?channel=${channel}&page=${app.store.page}`, { as: "text" }));
}

export async function loadProgram(app, name, channel = app.store.channel) {
  return app.request("load", { channel, name });
}

/** Uploads a file and loads it. */
export async function upload(app, file) {
  const { channel } = app.store; // also when another one is chosen meanwhile
  const path = `/api/programs?name=${encodeURIComponent(file.name)}`;
  const send = (how) => app.connection.http(path + how, { method: "POST", body: file, headers: { "Content-Type": "text/plain" } });
  let answer;
  try {
    answer = await send("");
  } catch (error) {
    const replaces = error.number === EXISTS && window.confirm(`${file.name} is in the program folder already. Replace it?`);
    answer = replaces ? await app.attempt(send("&replace=1")) : error.number === EXISTS ? null : app.notices.refused(error);
  }
  if (!answer) return false;
  app.notices.show("info", `${answer.name ?? file.name} is uploaded.`);
  return Boolean(await loadProgram(app, answer.name ?? file.name, channel));
}

/** Files may be dropped on an element. */
export function takeDrops(element, take) {
  const over = (on) => (event) => {
    event.preventDefault();
    element.classList.toggle("drop", on);
  };
  element.addEventListener("dragover", over(true));
  element.addEventListener("dragleave", over(false));
  element.addEventListener("drop", (event) => {
    over(false)(event);
    const file = event.dataTransfer?.files[0];
    if (file) take(file);
  });
}

/** Follows the program of the channel: `show(text)` for each that is loaded; returns what ends that. */
export function followProgram(app, show) {
  const { store } = app;
  let shown = null;
  let turn = 0; // an earlier answer does not overwrite a later one
  const look = async () => {
    const name = programName(store);
    if (!name || name === shown) return;
    shown = name;
    const mine = ++turn;
    const text = await readProgram(app, name);
    if (mine === turn) show(text ?? "");
  };
  const again = ({ channel }) => {
    if (channel !== store.channel) return;
    shown = null;
    look();
  };
  const ends = [store.on("program", again), store.on("state", look)];
  look();
  return () => {
    turn += 1;
    ends.forEach((end) => end());
  };
}

export function programName(store) {
  const path = store.state(store.channel).program || "";
  return store.programs[store.channel]?.name ?? path.split("/").pop();
}
