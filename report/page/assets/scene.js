// The 3D view: SextantScene(data, select) returns {show(index)}, or null without WebGL.
window.SextantScene = function (data, select) {
  'use strict';
  var host = document.getElementById('stage');
  var note = document.getElementById('stage-note');
  var renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  } catch (error) {
    return null;
  }
  THREE.Object3D.DefaultUp.set(0, 0, 1);
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
  renderer.setClearColor(0x12181f);
  host.appendChild(renderer.domElement);
  var scene = new THREE.Scene();
  var eye = new THREE.PerspectiveCamera(50, 1, 0.02, 1000);
  var controls = new THREE.OrbitControls(eye, renderer.domElement);
  controls.enableKeys = false;
  controls.enableZoom = false;
  var CAMERA = 0x56b4e9;
  var LIDAR = 0xff9d3b;
  var parts = {};
  ['scan', 'camera', 'lidar', 'othersCamera', 'othersLidar', 'frusta', 'axes', 'ground', 'measure']
    .forEach(function (name) {
      parts[name] = new THREE.Group();
      scene.add(parts[name]);
    });
  var current = 0;
  var pickable = [];
  var usual = '';

  function draw() {
    renderer.render(scene, eye);
  }
  controls.addEventListener('change', draw);

  function vectors(numbers) {
    var list = [];
    for (var i = 0; i + 2 < numbers.length; i += 3) {
      list.push(new THREE.Vector3(numbers[i], numbers[i + 1], numbers[i + 2]));
    }
    return list;
  }

  function clear(group) {
    while (group.children.length > 0) {
      var child = group.children[0];
      group.remove(child);
      if (child.geometry) child.geometry.dispose();
      if (child.material) {
        if (child.material.map) child.material.map.dispose();
        child.material.dispose();
      }
    }
  }

  function line(points, colour, opacity) {
    var geometry = new THREE.BufferGeometry().setFromPoints(points);
    return new THREE.Line(geometry, new THREE.LineBasicMaterial(
      { color: colour, transparent: opacity < 1, opacity: opacity }));
  }

  // A line that is wider than a pixel, which WebGL does not have.
  function rod(from, to, colour) {
    var radius = 0.0022 * Math.max(1, from.length());
    var tube = new THREE.TubeGeometry(new THREE.LineCurve3(from, to), 1, radius, 6, false);
    return new THREE.Mesh(tube, new THREE.MeshBasicMaterial({ color: colour }));
  }

  function label(text, place, colour, size) {
    var canvas = document.createElement('canvas');
    var pen = canvas.getContext('2d');
    var font = '600 44px system-ui, sans-serif';
    pen.font = font;
    canvas.width = Math.ceil(pen.measureText(text).width) + 16;
    canvas.height = 60;
    pen.font = font;
    pen.fillStyle = colour;
    pen.textBaseline = 'middle';
    pen.fillText(text, 8, 31);
    var texture = new THREE.CanvasTexture(canvas);
    texture.minFilter = THREE.LinearFilter;
    var sprite = new THREE.Sprite(new THREE.SpriteMaterial(
      { map: texture, transparent: true, depthTest: false, sizeAttenuation: false }));
    sprite.scale.set(size * canvas.width / canvas.height, size, 1);
    sprite.position.copy(place);
    return sprite;
  }

  function addBoard(group, corners, colour, isStrong) {
    if (corners.length < 4) return;
    var c = corners.slice(0, 4);
    var face = new THREE.BufferGeometry().setFromPoints([c[0], c[1], c[2], c[0], c[2], c[3]]);
    group.add(new THREE.Mesh(face, new THREE.MeshBasicMaterial({
      color: colour, transparent: true, opacity: isStrong ? 0.22 : 0.05, side: THREE.DoubleSide,
      depthWrite: false })));
    if (!isStrong) {
      group.add(line(c.concat([c[0]]), colour, 0.55));
      return;
    }
    c.forEach(function (corner, k) {
      pickable.push(corner);
      group.add(rod(corner, c[(k + 1) % 4], colour));
    });
  }

  function showBoards() {
    ['camera', 'lidar', 'othersCamera', 'othersLidar'].forEach(function (name) { clear(parts[name]); });
    data.views.forEach(function (view, index) {
      var isStrong = index === current;
      view.boards.forEach(function (board) {
        addBoard(isStrong ? parts.camera : parts.othersCamera, vectors(board.camera), CAMERA, isStrong);
        addBoard(isStrong ? parts.lidar : parts.othersLidar, vectors(board.lidar), LIDAR, isStrong);
      });
    });
  }

  function bytes(text) {
    var binary = atob(text);
    var array = new Uint8Array(binary.length);
    for (var i = 0; i < binary.length; ++i) array[i] = binary.charCodeAt(i);
    return array;
  }

  var palette = data.palette.map(function (text) { return new THREE.Color(text); });
  function ramp(share, out) {
    var at = Math.max(0, Math.min(1, share)) * (palette.length - 1);
    var low = Math.min(palette.length - 2, Math.floor(at));
    out.copy(palette[low]).lerp(palette[low + 1], at - low);
  }

  function coordinates(scan) {
    var raw = bytes(scan.xyz);
    var view = new DataView(raw.buffer);
    var xyz = new Float32Array(3 * scan.count);
    for (var i = 0; i < xyz.length; ++i) xyz[i] = scan.unit_m * view.getInt16(2 * i, true);
    return xyz;
  }

  function byRange(xyz, colours) {
    var ranges = [];
    var i;
    for (i = 0; i < xyz.length; i += 3) ranges.push(Math.hypot(xyz[i], xyz[i + 1], xyz[i + 2]));
    var sorted = ranges.slice().sort(function (a, b) { return a - b; });
    var near = Math.max(0.1, sorted[Math.floor(0.02 * (sorted.length - 1))]);
    var far = Math.max(1.001 * near, sorted[Math.floor(0.98 * (sorted.length - 1))]);
    var colour = new THREE.Color();
    ranges.forEach(function (range, k) {
      ramp(1 - Math.log(Math.max(near, range) / near) / Math.log(far / near), colour);
      colour.toArray(colours, 3 * k);
    });
    return 'Yellow is near (' + near.toFixed(1) + ' m), dark blue is far (' + far.toFixed(1) + ' m).';
  }

  function colourize(scan, xyz, colours) {
    var kind = document.getElementById('colour').value;
    var i;
    if (kind === 'photo' && scan.rgb) {
      var rgb = bytes(scan.rgb);
      for (i = 0; i < rgb.length; ++i) colours[i] = rgb[i] / 255;
      return 'Returns outside the photo are grey.';
    }
    if (kind === 'intensity' && scan.intensity) {
      var strength = bytes(scan.intensity);
      var colour = new THREE.Color();
      for (i = 0; i < strength.length; ++i) {
        ramp(strength[i] / 255, colour);
        colour.toArray(colours, 3 * i);
      }
      return 'Yellow is the strongest return, dark blue the weakest.';
    }
    var text = byRange(xyz, colours);
    if (kind === 'range') return text;
    return 'This view has no ' + kind + ' for the scan, so it is coloured by range. ' + text;
  }

  function showScan() {
    clear(parts.scan);
    var scan = data.views[current].scan;
    if (!scan) return 'This view has no scan in the page.';
    var xyz = coordinates(scan);
    var colours = new Float32Array(xyz.length);
    var legend = colourize(scan, xyz, colours);
    var geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(xyz, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
    parts.scan.add(new THREE.Points(geometry, new THREE.PointsMaterial(
      { size: 2.4, sizeAttenuation: false, vertexColors: THREE.VertexColors })));
    vectors(xyz).forEach(function (point) { pickable.push(point); });
    return legend;
  }

  function showSensors() {
    data.sensors.forEach(function (sensor) {
      var origin = vectors(sensor.origin)[0];
      vectors(sensor.axes).forEach(function (axis, k) {
        var tip = origin.clone().addScaledVector(axis, 0.2);
        var colour = ['#ff8a70', '#5fd0a5', '#7ab8ff'][k];
        parts.axes.add(line([origin, tip], colour, 1));
        parts.axes.add(label('xyz'[k], origin.clone().addScaledVector(axis, 0.24), colour, 0.028));
      });
      parts.axes.add(label(sensor.name, origin.clone().add(
        new THREE.Vector3(0, 0, sensor.camera ? -0.14 : 0.34)),
        sensor.camera ? '#8fd0f5' : '#ffb56b', 0.034));
      var corners = vectors(sensor.frustum);
      if (corners.length === 0) return;
      corners.forEach(function (corner, k) {
        if (k % Math.max(1, corners.length / 4) === 0) parts.frusta.add(line([origin, corner], CAMERA, 0.7));
      });
      parts.frusta.add(line(corners.concat([corners[0]]), CAMERA, 0.7));
    });
    for (var radius = 1; radius <= 10; ++radius) {
      var circle = [];
      for (var k = 0; k <= 96; ++k) {
        circle.push(new THREE.Vector3(radius * Math.cos(k * Math.PI / 48), radius * Math.sin(k * Math.PI / 48), 0));
      }
      parts.ground.add(line(circle, 0x8fa3b5, radius % 5 === 0 ? 0.4 : 0.16));
    }
  }

  function middle() {
    var sum = new THREE.Vector3();
    var count = 0;
    data.views.forEach(function (view, index) {
      view.boards.forEach(function (board) {
        vectors(board.camera.length ? board.camera : board.lidar).forEach(function (corner) {
          sum.add(corner);
          ++count;
        });
      });
    });
    return count > 0 ? sum.divideScalar(count) : new THREE.Vector3(2, 0, 0);
  }

  function look(kind) {
    var target = middle();
    var distance = Math.max(1.5, target.length());
    var forward = new THREE.Vector3(target.x, target.y, 0);
    if (forward.lengthSq() < 1e-6) forward.set(1, 0, 0);
    forward.normalize();
    var aside = new THREE.Vector3(-forward.y, forward.x, 0);
    var up = new THREE.Vector3(0, 0, 1);
    var sensor = data.sensors.find(function (one) { return one.camera === (kind === 'camera'); });
    var between = target.clone().multiplyScalar(0.6);
    if ((kind === 'camera' || kind === 'lidar') && sensor) {
      eye.position.copy(vectors(sensor.origin)[0]);
    } else if (kind === 'top') {
      target = between;
      eye.position.copy(between).addScaledVector(up, 1.7 * distance).addScaledVector(forward, -0.01);
    } else if (kind === 'side') {
      target = between;
      eye.position.copy(between).addScaledVector(aside, -1.7 * distance);
    } else {
      target = between;
      eye.position.copy(between).addScaledVector(forward, -0.95 * distance)
        .addScaledVector(aside, -0.55 * distance).addScaledVector(up, 0.5 * distance);
    }
    controls.target.copy(target);
    controls.update();
    draw();
  }

  function zoom(factor) {
    eye.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    draw();
  }

  function show(index) {
    current = index;
    pickable = [];
    clear(parts.measure);
    marks = [];
    showBoards();
    usual = showScan() + ' Drag to turn, drag with the right button to move; the wheel zooms after a click.';
    note.textContent = usual;
    document.getElementById('moment').value = String(index);
    draw();
  }

  var marks = [];
  function nearest(x, y) {
    var best = null;
    var bestDistance = 14 * 14;
    var place = new THREE.Vector3();
    pickable.forEach(function (point) {
      place.copy(point).project(eye);
      if (place.z > 1 || place.z < -1) return;
      var dx = (0.5 + 0.5 * place.x) * host.clientWidth - x;
      var dy = (0.5 - 0.5 * place.y) * host.clientHeight - y;
      var distance = dx * dx + dy * dy;
      if (distance < bestDistance) {
        best = point;
        bestDistance = distance;
      }
    });
    return best;
  }

  function mark(x, y) {
    var point = nearest(x, y);
    if (!point) {
      note.textContent = 'No return or corner there: click on one.';
      return;
    }
    if (marks.length === 2) {
      marks = [];
      clear(parts.measure);
    }
    marks.push(point);
    parts.measure.add(label('×', point, '#ffffff', 0.045));
    if (marks.length === 1) {
      note.textContent = 'From (' + [point.x, point.y, point.z].map(function (v) { return v.toFixed(3); })
        .join(', ') + ') m, ' + point.length().toFixed(3) + ' m from the LiDAR. Click on the second point.';
    } else {
      parts.measure.add(line(marks, 0xffffff, 1));
      note.textContent = 'Distance ' + marks[0].distanceTo(marks[1]).toFixed(3) + ' m.';
    }
    draw();
  }

  var isMeasuring = false;
  var measure = document.getElementById('measure');
  measure.addEventListener('click', function () {
    isMeasuring = !isMeasuring;
    measure.setAttribute('aria-pressed', String(isMeasuring));
    marks = [];
    clear(parts.measure);
    note.textContent = isMeasuring ? 'Click on two returns or corners of boards.' : usual;
    draw();
  });
  var pressed = null;
  host.addEventListener('pointerdown', function (event) {
    pressed = [event.clientX, event.clientY];
    controls.enableZoom = true;
  });
  host.addEventListener('pointerleave', function () { controls.enableZoom = false; });
  host.addEventListener('pointerup', function (event) {
    var isClick = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4;
    if (!isMeasuring || !isClick) return;
    var box = host.getBoundingClientRect();
    mark(event.clientX - box.left, event.clientY - box.top);
  });

  document.querySelectorAll('[data-part]').forEach(function (box) {
    box.addEventListener('change', function () {
      function isOn(name) { return document.querySelector('[data-part="' + name + '"]').checked; }
      ['scan', 'camera', 'lidar', 'frusta', 'axes'].forEach(function (name) {
        parts[name].visible = isOn(name);
      });
      parts.othersCamera.visible = isOn('others') && isOn('camera');
      parts.othersLidar.visible = isOn('others') && isOn('lidar');
      draw();
    });
  });
  document.getElementById('colour').addEventListener('change', function () { show(current); });
  document.getElementById('look').addEventListener('change', function (event) { look(event.target.value); });
  document.getElementById('nearer').addEventListener('click', function () { zoom(0.8); });
  document.getElementById('farther').addEventListener('click', function () { zoom(1.25); });
  var moment = document.getElementById('moment');
  data.views.forEach(function (view, index) {
    var option = document.createElement('option');
    option.value = String(index);
    option.textContent = view.name + (view.kept ? '' : ' (left out)');
    moment.appendChild(option);
  });
  moment.addEventListener('change', function () { select(Number(moment.value)); });

  function resize() {
    var width = Math.max(1, host.clientWidth);
    var height = Math.max(1, host.clientHeight);
    renderer.setSize(width, height);
    eye.aspect = width / height;
    eye.updateProjectionMatrix();
    draw();
  }
  window.addEventListener('resize', resize);
  resize();
  showSensors();
  look('overview');
  return { show: show };
};
