// The frames of a picture in motion: when each is taken, under which sun and from which side.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/report/figures.h"
#include "pipeline/options/settings.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

/// The state that differs from frame to frame. Everything else follows from it, as in a still.
struct Moment {
  double time_seconds = 0;
  std::optional<SunAngles> sun;   ///< in place of the scene's own
  float turn_degrees = 0;         ///< of the camera about the vertical axis through its target
  float turn_before_degrees = 0;  ///< the same when the shutter opened, for motion blur
};

/// The view at a moment.
PictureSettings viewAt(PictureSettings view, const Moment& moment);

/// The frames of scene.view.motion.
struct Film {
  std::vector<Moment> moments;
  std::vector<std::string> moving;  ///< the things that move with the time, such as "swirls"
  bool loops = false;               ///< the last frame leads back to the first
};

/// A turn or an animation in which only swirls move takes one period of them, so that it loops. Otherwise frame i is taken i/fps after the
/// view's time, and the animation loops if in its seconds fields drift through whole boxes, swirls go through whole periods and nothing
/// else moves. A sun sweep stays at that time. `has_mesh_clouds`: there is something to swirl.
/// `changes`: some of them are sequences.
Film filmOf(const SceneFile& scene, bool has_mesh_clouds, bool changes = false);

/// "loops" and "frames": the seconds of each, the turn of its camera, and the sun of a sweep as --sun takes it.
Json filmJson(const Film& film);
/// One line for people: frames, seconds, what moves, and whether it loops.
std::string filmText(const Film& film, double frames_per_second);

}  // namespace cloudbake
