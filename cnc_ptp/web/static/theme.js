"use strict";
// Light or dark: as the system has it, or as it was chosen here. Before the first paint, so it is no module.
(function () {
  const root = document.documentElement;
  const dark = window.matchMedia("(prefers-color-scheme: dark)");

  function read() {
    try {
      return localStorage.getItem("theme") || "system";
    } catch {
      return "system"; // storage is blocked
    }
  }

  function show() {
    const choice = read();
    root.dataset.theme = choice === "system" ? (dark.matches ? "dark" : "light") : choice;
    window.dispatchEvent(new Event("theme"));
  }

  dark.addEventListener("change", show);
  window.theme = {
    read,
    choose(choice) {
      try {
        localStorage.setItem("theme", choice);
      } catch {
        root.dataset.theme = choice;
      }
      show();
    },
  };
  show();
})();
