"use strict";
// The machine that the address names, or the first one.
const links = [...document.querySelectorAll("nav a")];
const chosen = links.find((link) => link.search === location.search) ?? links[0];
chosen.setAttribute("aria-current", "page");
document.querySelector("h1").textContent = document.title = chosen.textContent;
document.getElementById(chosen.search.slice(1)).id = "live-data";
