// The frames of a sequence: files in the order of their numbers, moments of the animation of one file, or a cloud that grows with a key
// that varies.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/file/read_settings.h"
#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/options/options.h"
#include "pipeline/sources/grown.h"

namespace cloudbake {

/// Of a sequence, if neither an option nor an animation says it.
inline constexpr double kFramesPerSecond = 24;
/// Of a grown cloud, if no option says it.
inline constexpr int kGrownFrames = 60;

/// A frame's place in time and what it is made of.
struct FrameInput {
  double frame = 0;                            ///< counted from the first one
  std::string name;                            ///< for messages
  std::filesystem::path file;                  ///< empty for a grown cloud
  std::vector<Given> varied = {};              ///< options of a grown cloud that this frame sets
  std::optional<AnimationMoment> moment = {};  ///< of the file's animation
};

/// The files that an input names, by number: of a folder, those that can be baked; of a pattern, `#` stands for a digit and `####` for at
/// least four, `%d` and `%04d` likewise, or it is one of io/file/find_files.h. The last number in a name counts; missing numbers are gaps
/// in time. Throws InputError for fewer than two files, for files without a number, for two of one number, and for a folder with several
/// kinds of files.
std::vector<FrameInput> frameFiles(const std::filesystem::path& input);

/// Whether an input is one file of a format whose animations can become frames: glTF, GLB or FBX.
bool mayBeAnimated(const std::filesystem::path& input);

struct AnimationFrames {
  std::vector<FrameInput> frames;
  double frames_per_second = kFramesPerSecond;
};
/// The frames of settings.sequence.animation of the file settings.source.input: one for each frame from its start to its end, or
/// settings.sequence.frames, spread evenly, which are shown in the time of the animation if no frames per second are set. Throws InputError
/// if the file cannot be read or has no such animation, and UsageError for fewer than two or too many frames.
AnimationFrames animationFrames(const Settings& settings);

/// settings.frames of a grown cloud, or kGrownFrames, whose options, or variables of its recipe, change evenly from the first value of each
/// of settings.varied to the second. In a loop they reach it after one period, and go on during the fade, so that what repeats is closed.
/// Throws UsageError if nothing varies, and for a name that is neither an option of `grow` nor a variable of the recipe.
std::vector<FrameInput> grownFrames(const SequenceSettings& settings, const GrownSource& source);

/// The frames of a grown cloud, or of an animation, whose frames per second go to the settings if they have none.
std::vector<FrameInput> madeFrames(Settings& settings, const std::optional<GrownSource>& source);

/// Frames until a sequence is at its beginning again: of a loop, without those over which its end fades into its beginning.
double periodOf(const std::vector<FrameInput>& frames, const SequenceSettings& settings);

/// The options of a grown sequence: those of its recipe, which `line`, those of the command line or of a manifest, override. What `line`
/// varies takes the place of all that the recipe varies.
std::vector<Given> withRecipe(const GrownSource& source, std::span<const Given> line);

/// A frame's cloud, and the settings of its fields: options that vary may be among them.
struct FrameCloud {
  Cloud cloud;
  FieldSettings field;
};
/// Reads or grows a frame, without a budget of vertices. `given` includes the options of a recipe.
FrameCloud readFrame(const FrameInput& frame, const Settings& settings, std::span<const Given> given, BakeReport& report);

}  // namespace cloudbake
