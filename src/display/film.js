// film.js -- plays a run: FILM has its frames and its moments.

(function () {
  "use strict";
  function element(id) { return document.getElementById(id); }

  // FILM.lines are the lines of SVG that frames are made of. A frame is a list of their numbers, or
  // of changes: place, number, place, number ... in the frame before it.
  var frames = [];
  FILM.frames.forEach(function (frame, index) {
    var lines;
    if (frame.all) lines = frame.all;
    else {
      lines = frames[index - 1].slice();
      for (var i = 0; i < frame.changes.length; i += 2) lines[frame.changes[i]] = frame.changes[i + 1];
    }
    frames.push(lines);
  });

  var movers = element("movers"), slider = element("slider"), tick = element("tick"),
      play = element("play"), speed = element("speed"), list = element("moments"),
      now = 0, playing = false, last = 0, due = 0;

  function show(index) {
    now = Math.max(0, Math.min(frames.length - 1, index));
    movers.innerHTML = frames[now].map(function (line) { return FILM.lines[line]; }).join("");
    slider.value = now;
    tick.textContent = "tick " + FILM.ticks[now];
    var passed = -1;
    FILM.moments.forEach(function (moment, index) { if (moment.frame <= now) passed = index; });
    Array.prototype.forEach.call(list.children, function (item, index) {
      item.className = index === passed ? "now" : "";
    });
    // Scroll only the list, not the page.
    if (passed >= 0)
      list.scrollTop = list.children[passed].offsetTop - list.offsetTop - list.clientHeight / 2;
  }

  function step(time) {
    if (!playing) return;
    due += (time - last) / 1000 * FILM.rate * Number(speed.value);
    last = time;
    if (due >= 1) {
      show(now + Math.floor(due));
      due -= Math.floor(due);
    }
    if (now === frames.length - 1) setPlaying(false);
    else requestAnimationFrame(step);
  }

  function setPlaying(wanted) {
    playing = wanted;
    play.textContent = playing ? "Pause" : "Play";
    if (playing) {
      if (now === frames.length - 1) show(0);
      due = 0;
      last = performance.now();
      requestAnimationFrame(step);
    }
  }

  function goTo(index) { setPlaying(false); show(index); }

  function jumper(moment) {
    return function () { goTo(moment.frame); };
  }

  // Moments whose marks would overlap share one mark, with their number.
  var groups = [], apart = 2, told = 12;
  FILM.moments.forEach(function (moment, index) {
    var place = frames.length > 1 ? 100 * moment.frame / (frames.length - 1) : 0,
        group = groups[groups.length - 1];
    if (group && place - group.place < apart) group.moments.push(moment);
    else groups.push({ place: place, moments: [moment] });
    list.children[index].firstElementChild.onclick = jumper(moment);
  });

  function title(moments) {
    var lines = moments.slice(0, told).map(function (moment) {
      return "tick " + moment.tick + ": " + moment.text;
    });
    if (moments.length > told) lines.push("and " + (moments.length - told) + " more");
    return lines.join("\n");
  }

  // A click goes to the first moment of a group, further clicks to the frame of the next one.
  function nextOf(moments) {
    return function () {
      var later = moments.filter(function (moment) { return moment.frame > now; }),
          within = now >= moments[0].frame && later.length > 0;
      goTo((within ? later[0] : moments[0]).frame);
    };
  }

  groups.forEach(function (group) {
    var mark = document.createElement("button"), first = group.moments[0],
        alike = group.moments.every(function (moment) { return moment.kind === first.kind; });
    mark.className = alike ? first.kind : "note";
    mark.style.left = group.place + "%";
    mark.textContent = group.moments.length > 1 ? group.moments.length : "";
    mark.title = title(group.moments);
    mark.setAttribute("aria-label", mark.title);
    mark.onclick = nextOf(group.moments);
    element("marks").appendChild(mark);
  });

  slider.max = frames.length - 1;
  slider.oninput = function () { goTo(Number(slider.value)); };
  play.onclick = function () { setPlaying(!playing); };
  element("back").onclick = function () { goTo(now - 1); };
  element("on").onclick = function () { goTo(now + 1); };

  var keys = {
    " ": function () { setPlaying(!playing); },
    "ArrowLeft": function () { goTo(now - 1); },
    "ArrowRight": function () { goTo(now + 1); },
    "Home": function () { goTo(0); },
    "End": function () { goTo(frames.length - 1); },
    "+": function () { speed.selectedIndex = Math.min(speed.options.length - 1, speed.selectedIndex + 1); },
    "-": function () { speed.selectedIndex = Math.max(0, speed.selectedIndex - 1); }
  };
  document.addEventListener("keydown", function (event) {
    if (event.ctrlKey || event.altKey || event.metaKey || !keys[event.key]) return;
    if (event.target === speed && event.key !== " ") return;
    event.preventDefault();
    if (event.target.blur) event.target.blur();
    keys[event.key]();
  });

  // In a small window the picture comes first.
  if (window.innerWidth < 1000)
    Array.prototype.forEach.call(document.querySelectorAll("aside details"),
                                 function (part) { part.open = false; });

  var start = /^#tick=(\d+)$/.exec(location.hash), first = 0;
  if (start) FILM.ticks.forEach(function (tick, index) { if (tick <= Number(start[1])) first = index; });
  show(first);
})();
