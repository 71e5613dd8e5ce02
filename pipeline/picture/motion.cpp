#include "pipeline/picture/motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace cloudbake {

namespace {

using Motion = PictureSettings::Motion;

bool swirls(const SceneFile& scene, bool has_mesh_clouds) {
  return has_mesh_clouds && !scene.view.plain && scene.post.distort.swirl_speed > 0 && scene.post.distort.swirl_strength > 0;
}

std::vector<std::string> movingThings(const SceneFile& scene, bool has_mesh_clouds, bool changes) {
  std::vector<std::string> moving;
  const auto add = [&](bool moves, const char* what) {
    if (moves) moving.emplace_back(what);
  };
  add(swirls(scene, has_mesh_clouds), "swirls");
  add(changes, "clouds that change");
  add(std::any_of(scene.slabs.begin(), scene.slabs.end(),
                  [](const SlabSettings& slab) { return slab.high_drift != Vec2{} || slab.low_drift != Vec2{}; }),
      "slabs");
  const auto hasWind = [](const auto& clouds) { return clouds.wind != Vec3{}; };
  add(std::any_of(scene.distance_clouds.begin(), scene.distance_clouds.end(), hasWind) ||
          std::any_of(scene.density_clouds.begin(), scene.density_clouds.end(), hasWind),
      "marched clouds");
  add(std::any_of(scene.fields.begin(), scene.fields.end(), [](const SceneField& field) { return field.scatter.drift != Vec3{}; }),
      "fields of clouds");
  add(scene.camera_path, "the camera on its path");
  add(scene.day && scene.day->seconds > 0, "sun and moon");
  const auto& aurora = scene.light.sky.aurora;
  add(!scene.lightning.empty(), "lightning");
  add(aurora && aurora->speed > 0 && aurora->strength > 0, "the aurora");
  return moving;
}

// Whether everything that moves is, after so many seconds, what it was: swirls after whole cycles, fields after whole boxes. The noise at
// rims goes with the wind, and does not come back.
bool repeats(const SceneFile& scene, const std::vector<std::string>& moving, double seconds) {
  constexpr double kRounding = 1e-6;
  const DistortSettings& distort = scene.post.distort;
  const bool can_repeat =
      std::all_of(moving.begin(), moving.end(), [](const std::string& what) { return what == "swirls" || what == "fields of clouds"; });
  const bool drifts = std::find(moving.begin(), moving.end(), "fields of clouds") != moving.end();
  const ErodeSettings& erode = scene.post.painted.erode;
  const bool has_noise = !scene.post.published && (erode.shrink > 0 || erode.darkening > 0);
  if (!can_repeat || (drifts && has_noise && scene.clouds.empty())) return false;
  if (std::find(moving.begin(), moving.end(), "swirls") != moving.end()) {
    const std::optional<double> cycles = cyclesOfLoop(distort);
    const double times = cycles ? seconds * double(distort.swirl_speed) / *cycles : 0.5;
    if (std::abs(times - std::round(times)) > kRounding) return false;
  }
  return std::all_of(scene.fields.begin(), scene.fields.end(),
                     [&](const SceneField& field) { return repeatsAfter(field.scatter, seconds); });
}

}  // namespace

PictureSettings viewAt(PictureSettings view, const Moment& moment) {
  view.time_seconds = moment.time_seconds;
  if (moment.sun) view.sun_azimuth_degrees = moment.sun->azimuth_degrees, view.sun_elevation_degrees = moment.sun->elevation_degrees;
  return view;
}

Film filmOf(const SceneFile& scene, bool has_mesh_clouds, bool changes) {
  constexpr double kBelow =
      6;  // degrees: a sweep begins and ends with the sun so far before and past a quarter turn from its highest place
  const PictureSettings& view = scene.view;
  Film film{{}, movingThings(scene, has_mesh_clouds, changes), false};
  const bool only_swirls = film.moving == std::vector<std::string>{"swirls"};
  const std::optional<double> cycles = only_swirls ? cyclesOfLoop(scene.post.distort) : std::nullopt;
  const bool is_whole = !film.moving.empty() && repeats(scene, film.moving, double(view.frame_count) / view.frames_per_second);
  film.loops = view.motion != Motion::kSunSweep && (cycles || is_whole || (view.motion == Motion::kTurntable && film.moving.empty()));
  const double period = cycles ? *cycles / double(scene.post.distort.swirl_speed) : 0;
  for (int i = 0; i < view.frame_count; ++i) {
    const double share = double(i) / view.frame_count;
    Moment moment;
    moment.time_seconds = view.time_seconds;
    if (view.motion == Motion::kSunSweep)
      moment.sun = SunCircle({view.sun_azimuth_degrees, view.sun_elevation_degrees})
                       .anglesAt(-kBelow + (180 + 2 * kBelow) * i / std::max(1, view.frame_count - 1));
    else
      moment.time_seconds += cycles ? share * period : double(i) / view.frames_per_second;
    if (view.motion == Motion::kTurntable) {
      moment.turn_degrees = float(360 * share);
      moment.turn_before_degrees = float(360 * (share - 1.0 / view.frame_count));
    }
    film.moments.push_back(moment);
  }
  return film;
}

Json filmJson(const Film& film) {
  Json frames = Json::array();
  for (const Moment& moment : film.moments) {
    Json frame = {{"time", moment.time_seconds}, {"turn", moment.turn_degrees}};
    if (moment.sun) frame["sun"] = fmt::format("{},{}", moment.sun->azimuth_degrees, moment.sun->elevation_degrees);
    frames.push_back(std::move(frame));
  }
  return {{"loops", film.loops}, {"frames", std::move(frames)}};
}

std::string filmText(const Film& film, double frames_per_second) {
  const size_t count = film.moments.size();
  const std::string moving = film.moving.empty() ? "nothing moves with the time" : fmt::format("{} move", fmt::join(film.moving, ", "));
  return figureLine("frames", "{} at {:g} per second, {:.4g} s; {}; {}", count, frames_per_second, double(count) / frames_per_second,
                    moving, film.loops ? "it loops" : "no loop: the last frame does not lead back to the first");
}

}  // namespace cloudbake
