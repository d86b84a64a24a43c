// The login, where the server demands one.
import { field, h, say } from "./dom.js";

export function loginForm(app) {
  const user = h("input", { name: "user", autocomplete: "username", required: true });
  const password = h("input", { name: "password", type: "password", autocomplete: "current-password", required: true });
  const refusal = h("p", { class: "refusal", role: "alert" });
  const form = h("form", { class: "panel login" }, h("h2", {}, "Login"), field("User", user), field("Password", password), h("button", { type: "submit" }, "Log in"), refusal);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await app.connection.http("/api/login", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ user: user.value, password: password.value }) });
      app.connection.open();
    } catch (error) {
      password.value = "";
      say(refusal, error.message);
    }
  });
  return form;
}
