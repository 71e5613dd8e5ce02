// What moves by itself: time, which moves swirls, wind, a camera on a path and through the hours the sun; and the sun alone.

import { element, showPlaying } from './dom.js';
import { circleThrough, noonAzimuthAfter, sunOfDay } from './hours.js';
import { directionFromAngles } from './vectors.js';

export class Clock {
  /** @param {Viewer} viewer */
  constructor(viewer) {
    this.viewer = viewer;
    this.plays = false;
  }

  useScene({ time }) {
    this.time = time;
    this.showButton();
  }

  showButton() { showPlaying('play', this.plays, this.viewer.scene.layers || this.viewer.scene.scattered ? 'time' : 'swirls'); }

  play(is_on) {
    this.plays = is_on;
    this.showButton();
    this.viewer.shownState = null;  // the address says it
    this.viewer.request();
  }

  move(seconds) {
    this.time = Math.max(0, this.time + seconds);
    const { day } = this.viewer.scene.layers ?? {};
    if (day?.seconds > 0) this.viewer.change({ sun: sunOfDay(day, this.time) });
    element('time').value = this.time;
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
