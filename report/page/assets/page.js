// Selection of a view, the opacity of the scan, and the 3D view where there is one.
(function () {
  'use strict';
  var root = document.documentElement;
  var rows = Array.prototype.slice.call(document.querySelectorAll('tr[data-view]'));
  var cards = Array.prototype.slice.call(document.querySelectorAll('.card'));
  var data = JSON.parse(document.getElementById('scene').textContent);
  var stage = null;
  root.classList.add('js');

  function select(index) {
    rows.forEach(function (row) {
      var isSelected = Number(row.dataset.view) === index;
      row.classList.toggle('selected', isSelected);
      row.setAttribute('aria-current', String(isSelected));
    });
    cards.forEach(function (card) {
      card.classList.toggle('selected', Number(card.dataset.view) === index);
    });
    if (stage) stage.show(index);
  }

  rows.forEach(function (row) {
    row.addEventListener('click', function (event) {
      event.preventDefault();
      select(Number(row.dataset.view));
    });
  });

  var sliders = Array.prototype.slice.call(document.querySelectorAll('.opacity input'));
  sliders.forEach(function (slider) {
    slider.addEventListener('input', function () {
      root.style.setProperty('--scan', String(slider.value / 100));
      sliders.forEach(function (other) {
        other.value = slider.value;
        other.parentNode.querySelector('output').textContent = slider.value + ' %';
      });
    });
  });

  if (window.SextantScene && data.views.length > 0) {
    // Before the canvas is made, so that the stage has its size.
    root.classList.add('gl');
    stage = window.SextantScene(data, select);
    if (!stage) root.classList.remove('gl');
  }
  var first = 'selected' in data
    ? data.selected
    : data.views.findIndex(function (view) { return view.kept; });
  if (rows.length > 0) select(Math.max(0, first));
})();
