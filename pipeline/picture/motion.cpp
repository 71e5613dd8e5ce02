#include "pipeline/picture/motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace cloudbake {

namespace {

using Motion = PictureSettings::Motion;

bool swirls(const SceneFile& scene, bool has_mesh_clouds) {
  return has_mesh_clouds && !scene.view.plain && scene.post.distort.swirl_speed > 0 && scene.post.distort.swirl_strength > 0;
}

std::vector<std::string> movingThings(const SceneFile& scene, bool has_mesh_clouds) {
  std::vector<std::string> moving;
  const auto add = [&](bool moves, const char* what) {
    if (moves) moving.emplace_back(what);
  };
  add(swirls(scene, has_mesh_clouds), "swirls");
  add(std::any_of(scene.slabs.begin(), scene.slabs.end(),
                  [](const SlabSettings& slab) { return slab.high_drift != Vec2{} || slab.low_drift != Vec2{}; }),
      "slabs");
  const auto hasWind = [](const auto& clouds) { return clouds.wind != Vec3{}; };
  add(std::any_of(scene.distance_clouds.begin(), scene.distance_clouds.end(), hasWind) ||
          std::any_of(scene.density_clouds.begin(), scene.density_clouds.end(), hasWind),
      "marched clouds");
  add(scene.camera_path, "the camera on its path");
  add(scene.day && scene.day->seconds > 0, "sun and moon");
  const auto& aurora = scene.light.sky.aurora;
  add(aurora && aurora->speed > 0 && aurora->strength > 0, "the aurora");
  return moving;
}

}  // namespace

PictureSettings viewAt(PictureSettings view, const Moment& moment) {
  view.time_seconds = moment.time_seconds;
  if (moment.sun) view.sun_azimuth_degrees = moment.sun->azimuth_degrees, view.sun_elevation_degrees = moment.sun->elevation_degrees;
  return view;
}

Film filmOf(const SceneFile& scene, bool has_mesh_clouds) {
  constexpr double kBelow =
      6;  // degrees: a sweep begins and ends with the sun so far before and past a quarter turn from its highest place
  const PictureSettings& view = scene.view;
  Film film{{}, movingThings(scene, has_mesh_clouds), false};
  const bool only_swirls = film.moving == std::vector<std::string>{"swirls"};
  const std::optional<double> cycles = only_swirls ? cyclesOfLoop(scene.post.distort) : std::nullopt;
  film.loops = view.motion != Motion::kSunSweep && (cycles || (view.motion == Motion::kTurntable && film.moving.empty()));
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
