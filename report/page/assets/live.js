// The page of a capture that runs: loads itself again when there is something new.
(function () {
  'use strict';
  var note = document.getElementById('live-state');
  var revision = document.body.dataset.revision;

  function ask() {
    fetch('state', {cache: 'no-store'}).then(function (answer) {
      return answer.json();
    }).then(function (state) {
      if (state.revision !== revision) {
        location.reload();
      } else {
        note.textContent = state.state;
        note.classList.remove('ended');
        setTimeout(ask, 1000);
      }
    }).catch(function () {
      note.textContent = 'The capture cannot be reached: it has ended. This page shows what was known last.';
      note.classList.add('ended');
      setTimeout(ask, 5000);
    });
  }
  setTimeout(ask, 1000);
})();
