// search.js -- finds entries, headings and sections. The pages can be read without it.

// The lower, the better; -1 is no match. Rows are [name, kind, address, sentence, words below].
function rankRow(row, words) {
  "use strict";
  var name = row[0].toLowerCase(), all = (row[0] + " " + row[3]).toLowerCase(), whole = words.join(" ");
  var below = all + " " + row[4];
  if (name === whole) return 0;
  if (name.indexOf(whole) === 0) return 1;
  if (words.every(function (word) { return name.indexOf(word) >= 0; })) return 2;
  if (words.every(function (word) { return all.indexOf(word) >= 0; })) return 3;
  if (words.every(function (word) { return below.indexOf(word) >= 0; })) return 4;
  return -1;
}

// The words of TEXT, without those that say nothing: "how do I define a kicker" is "define kicker".
function searchWords(text) {
  "use strict";
  var words = text.toLowerCase().replace(/[?]+\s*$/, "").split(/\s+/).filter(Boolean);
  var telling = words.join(" ").replace(/^(how (do i|can i|to)|what is|where is) /, "").split(" ")
    .filter(function (word) { return word && ["a", "an", "the", "my"].indexOf(word) < 0; });
  return telling.length ? telling : words;
}

// The rows that match TEXT, one for each address, the best first: shorter names before longer ones.
function findRows(text) {
  "use strict";
  var words = searchWords(text), found = [], addresses = {};
  if (!words.length) return found;
  SEARCH_INDEX.forEach(function (row, index) {
    var value = rankRow(row, words);
    if (value >= 0) found.push([value, row[0].length, index, row]);
  });
  found.sort(function (a, b) { return a[0] - b[0] || a[1] - b[1] || a[2] - b[2]; });
  return found.map(function (item) { return item[3]; }).filter(function (row) {
    if (addresses[row[2]]) return false;
    return (addresses[row[2]] = true);
  }).slice(0, 20);
}

(function () {
  "use strict";
  var place = document.getElementById("search");
  var input = document.createElement("input");
  var results = document.createElement("ol");
  input.type = "search";
  input.placeholder = "Search names, headings, text (press /)";
  input.setAttribute("aria-label", "Search");
  place.appendChild(input);
  place.appendChild(results);

  function show(row) {
    var item = document.createElement("li"), link = document.createElement("a");
    var kind = document.createElement("span");
    link.href = row[2];
    link.textContent = row[0];
    kind.className = "kind";
    kind.textContent = " " + row[1] + (row[3] ? ": " + row[3] : "");
    item.appendChild(link);
    item.appendChild(kind);
    results.appendChild(item);
  }

  function showNothing() {
    var item = document.createElement("li");
    item.textContent = "No name, heading or section has these words.";
    results.appendChild(item);
  }

  input.addEventListener("input", function () {
    var found = findRows(input.value);
    results.textContent = "";
    found.forEach(show);
    if (!found.length && input.value.trim()) showNothing();
  });
  input.addEventListener("keydown", function (event) {
    var first = results.querySelector("a");
    if (event.key === "Enter" && first) location.href = first.href;
    if (event.key === "Escape") { input.value = ""; results.textContent = ""; }
  });
  document.addEventListener("keydown", function (event) {
    if (event.key === "/" && document.activeElement !== input) {
      event.preventDefault();
      input.focus();
    }
  });
})();
