// The sun's way through the sky: pipeline/scene/day.h.
'use strict';

const degreesOfDay = ({ hour, seconds }, time) => {
  const days = hour / 24 + (seconds > 0 ? time / seconds : 0) - 0.25;
  return 360 * (days - Math.floor(days));
};

// The sun's circle: through its highest place, and through the horizon 90 degrees of azimuth before.
function onSunCircle({ noon: [azimuth, elevation] }, degrees) {
  const angle = degrees * Math.PI / 180, rise = directionFromAngles(azimuth - 90, 0);
  return normalize(add(rise.map(x => x * Math.cos(angle)), directionFromAngles(azimuth, elevation), Math.sin(angle)));
}

function sunOfDay(day, time) {
  const [x, y, z] = onSunCircle(day, degreesOfDay(day, time)), rounded = radians => Math.round(radians * 180e3 / Math.PI) / 1e3;
  return [rounded(Math.atan2(x, z)), rounded(Math.asin(clamp(y, -1, 1)))];
}

// The azimuth of noon of a day that has the sun here in its morning, and at noon 50 degrees high, or as high as here.
function noonAzimuthAfter([azimuth, elevation]) {
  if (elevation >= 50) return azimuth;
  const [here, noon] = [elevation, 50].map(degrees => degrees * Math.PI / 180), since_rise = Math.asin(clamp(Math.sin(here) / Math.sin(noon), -1, 1));
  return azimuth + 90 - Math.atan2(Math.sin(since_rise) * Math.cos(noon), Math.cos(since_rise)) * 180 / Math.PI;
}

// The circle of a day through a place of the sun, with its highest place at this azimuth, and the hour there.
function circleThrough(to_sun, noon_azimuth) {
  const rise = directionFromAngles(noon_azimuth - 90, 0), along = dot(to_sun, rise), across = add(to_sun, rise, -along), size = Math.hypot(...across);
  const up = across[1] < 0 ? -1 : 1, noon = size > 1e-6 ? across.map(x => up * x / size) : directionFromAngles(noon_azimuth, 45);
  const degrees = Math.atan2(dot(to_sun, noon), along) * 180 / Math.PI;
  return { noon: [Math.atan2(noon[0], noon[2]) * 180 / Math.PI, Math.asin(clamp(noon[1], -1, 1)) * 180 / Math.PI], hour: (degrees / 15 + 30) % 24 };
}
