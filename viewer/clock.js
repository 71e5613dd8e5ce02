// What moves by itself: time, which moves swirls, wind, a camera on a path and through the hours the sun; and the sun alone.

import { element, showPlaying } from './dom.js';
import { circleThrough, noonAzimuthAfter, sunOfDay } from './hours.js';
import { durationOf } from './sequences.js';
import { clamp, directionFromAngles } from './vectors.js';

export class Clock {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.plays = false;
  }

  useScene({ time }) {
    this.time = time;
    this.showButton();
    const { sequence } = this;
    element('transport').hidden = !sequence;
    element('play').hidden = !!sequence;
    if (sequence) element('frame').max = Math.floor(sequence.period);
  }

  /** What an asset plays that changes. In a scene the clock goes on. */
  get sequence() {
    const { scene } = this.viewer;
    return scene.keys ? undefined : scene.arrays.sequences?.[0];
  }

  // The second at which what is played is over; a loop goes on.
  get end() { return this.sequence && !this.sequence.loops ? durationOf(this.sequence) : Infinity; }

  showButton() {
    const { scene } = this.viewer, is_time = scene.layers || scene.scattered || scene.arrays.sequences?.length;
    showPlaying('play', this.plays, is_time ? 'time' : 'swirls');
    element('play-frames').textContent = this.plays ? 'Pause' : 'Play';
  }

  // A sequence that is over begins again.
  play(is_on) {
    if (is_on && this.time >= this.end) this.time = 0;
    this.plays = is_on;
    this.showButton();
    this.viewer.shownState = null;  // the address says it
    this.viewer.request();
  }

  move(seconds) {
    this.time = clamp(this.time + seconds, 0, Math.max(this.time, this.end));
    if (this.plays && this.time >= this.end) this.play(false);
    const { day } = this.viewer.scene.layers ?? {};
    if (day?.seconds > 0) this.viewer.change({ sun: sunOfDay(day, this.time) });
    element('time').value = this.time;
  }

  // Stops at a frame of the sequence.
  show(frame) {
    this.play(false);
    this.time = frame / this.sequence.framesPerSecond;
    this.viewer.request();
  }

  // The frame that is shown, and where it is.
  showFrame() {
    const { sequence, time } = this;
    if (!sequence) return;
    const { framesPerSecond, loops, period } = sequence, duration = durationOf(sequence), slider = element('frame');
    const seconds = loops && duration > 0 ? time % duration : Math.min(time, duration);
    slider.value = Math.round(seconds * framesPerSecond);
    slider.ariaValueText = `Frame ${slider.value} of ${Math.round(period)}, ${seconds.toFixed(2)} seconds`;
    element('frame-time').textContent = `${seconds.toFixed(2)} s`;
  }
}

export class SunClock {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.plays = false;
  }

  useScene() { this.sunOfHour = undefined; }

  // The circle on which the sun goes around in a day, and its hour there. It is that of the scene's day, or one that begins with the first
  // sun. A sun that setHour() moved stays on its circle, also below the horizon, where the state keeps it at 20 degrees.
  get circle() {
    const { state: { sun }, scene: { layers }, home } = this.viewer;
    if (String(sun) !== this.sunOfHour) {
      this.sunOfHour = String(sun);
      this.knownCircle = circleThrough(directionFromAngles(sun[0], sun[1]), layers?.day ? layers.day.noon[0] : noonAzimuthAfter(home.sun));
    }
    return this.knownCircle;
  }

  get hour() { return this.circle.hour; }

  setHour(hour) {
    const { noon } = this.circle;
    this.viewer.change({ sun: sunOfDay({ noon, hour, seconds: 0 }, 0) });
    this.knownCircle = { noon, hour: hour % 24 };
    this.sunOfHour = String(this.viewer.state.sun);
  }

  // An hour per second.
  move(seconds) { this.setHour(this.hour + seconds); }

  play(is_on) {
    this.plays = is_on;
    showPlaying('play-sun', is_on, 'sun');
    this.viewer.request();
  }
}
