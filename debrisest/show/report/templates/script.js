(function () {
  "use strict";
  var rows = Array.from(document.querySelectorAll(".sortable tbody tr"));
  var words = document.getElementById("words");
  var verdict = document.getElementById("verdict");
  var shown = document.getElementById("shown");

  function filter() {
    var wanted = words.value.toLowerCase().split(/\s+/);
    var said = verdict.value;
    var count = 0;
    rows.forEach(function (row) {
      var text = row.textContent.toLowerCase();
      var fits = wanted.every(function (word) { return text.includes(word); });
      var hidden = fits ? (said ? row.dataset.verdict !== said : false) : true;
      row.hidden = hidden;
      count += hidden ? 0 : 1;
    });
    shown.textContent = count + " of " + rows.length + " cells";
    if (words.value || said) {
      document.querySelectorAll("details.cells").forEach(function (each) { each.open = true; });
    }
  }

  function sort(head) {
    var table = head.closest("table");
    var column = Array.from(head.parentNode.children).indexOf(head);
    var down = head.classList.contains("up");
    table.querySelectorAll("th").forEach(function (each) { each.className = ""; });
    head.className = down ? "down" : "up";
    function text(row) { return row.children[column].textContent; }
    var body = table.tBodies[0];
    Array.from(body.rows).sort(function (one, other) {
      var a = parseFloat(text(one)), b = parseFloat(text(other));
      if (isNaN(a) !== isNaN(b)) { return isNaN(a) ? 1 : -1; }
      var order = isNaN(a) ? text(one).localeCompare(text(other)) : a - b;
      return down ? -order : order;
    }).forEach(function (row) { body.appendChild(row); });
  }

  words.addEventListener("input", filter);
  verdict.addEventListener("change", filter);
  document.querySelectorAll(".sortable th").forEach(function (head) {
    head.addEventListener("click", function () { sort(head); });
  });
  filter();
})();
